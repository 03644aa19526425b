"""Detectable sizes of a diagnosis, and the reasons why some effects have none."""

from collections.abc import Mapping

from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.diagnosis.search.cause_selection import BEYOND_DOUBT
from frictioncli.diagnosis.search.confounded import unclaimed
from frictioncli.diagnosis.search.effect_size import LACKING, TAKEN_BY_BASE
from frictioncli.diagnosis.search.understood import structure_beside
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Effect, missing_columns

_MAY_BE_NOISE = "these data show something like it that may be noise"

_UNCERTAIN_CAUSES = "the causes named are not beyond doubt, and may not be found again beside it"


def detectable_sizes(diagnosis: Diagnosis, settings: DiagnosisSettings) -> dict[str, float | None]:
    """Return the smallest RMS size of each effect that would be named in four of five shapes.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    settings : DiagnosisSettings
        Its settings.

    Returns
    -------
    dict of str to (float or None)
        Sizes [N·m]; None of all effects where a cause that is named is not beyond doubt, beside
        which they would be worked out.
    """
    if _is_doubtful(diagnosis):
        return dict.fromkeys(effect.name for effect in diagnosis.tried)
    search, margin = diagnosis.search, diagnosis.margin
    # what the forms of structure without a name explain of it comes after names are given
    structure = structure_beside(search.step, diagnosis.causes, margin, settings.alpha)
    return search.detectable_sizes(diagnosis.tried, settings.alpha, margin, structure)


def undetectable_reasons(
    diagnosis: Diagnosis, settings: DiagnosisSettings, detectable: Mapping[str, float | None]
) -> dict[str, str]:
    """Return why effects have no detectable size, by name.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    settings : DiagnosisSettings
        Its settings.
    detectable : mapping of str to (float or None)
        The detectable sizes.
    """
    doubtful = _is_doubtful(diagnosis)

    def reason(effect: Effect) -> str:
        if missing_columns(effect, diagnosis.base.table):
            return LACKING
        why = unclaimed(effect, diagnosis.base) or (_UNCERTAIN_CAUSES if doubtful else "")
        noise = diagnosis.search.may_be_noise(effect, settings.alpha)
        return why or (_MAY_BE_NOISE if noise else TAKEN_BY_BASE)

    unknown = [name for name, size in detectable.items() if size is None]
    return {name: reason(BY_NAME[name]) for name in unknown}


def _is_doubtful(diagnosis: Diagnosis) -> bool:
    """Return whether a cause that is named is not beyond doubt."""
    return any(
        one.test.p_value >= BEYOND_DOUBT
        for one in diagnosis.causes
        if not one.fit.effect.measurement
    )
