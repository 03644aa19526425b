"""Changes of friction that a form of structure without a name makes needless.

What comes and goes at some moments may be a part of anything that varies slowly. Friction that
falls where a fan switches on, at a temperature, looks like a step from that moment on, and the rest
of it like structure along the temperature. Where that structure has a form, and the step may be
zero beside it, the form alone says as much.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.effects.base import Effect
from frictioncli.effects.step_change import EFFECT as STEP_CHANGE

_NEEDLESS = "beside the form of the structure that has no name it may be zero"


def without_needless_steps(
    diagnose: Callable[[Sequence[Effect]], Diagnosis], effects: Sequence[Effect]
) -> Diagnosis:
    """Return a diagnosis in which no step of friction is named that may be zero beside a form.

    It stays where the structure has no form without it.

    Parameters
    ----------
    diagnose : callable
        Diagnosis with some effects as the catalogue.
    effects : sequence of Effect
        The catalogue.
    """
    found = diagnose(effects)
    step = next((one for one in found.causes if _is_needless(found, one.fit.effect)), None)
    if step is None:
        return found
    without = diagnose([one for one in effects if one is not STEP_CHANGE])
    if not _has_form(without):
        return found
    needless = replace(step, standing="undetermined", reason=_NEEDLESS)
    return replace(without, visible=(*without.visible, needless), tried=found.tried)


def _is_needless(found: Diagnosis, effect: Effect) -> bool:
    """Return whether a step of friction may be zero beside the forms of a diagnosis."""
    if effect is not STEP_CHANGE or found.empirical is None or not _has_form(found):
        return False
    beside = found.empirical.beside
    return any(
        one.effect is effect and beside.may_be_zero(number)
        for number, one in enumerate(beside.effects)
    )


def _has_form(found: Diagnosis) -> bool:
    """Return whether structure of friction without a name has a form."""
    parts = found.empirical.parts if found.empirical is not None else ()
    return any(one.form is not None and one.channel == "friction" for one in parts)
