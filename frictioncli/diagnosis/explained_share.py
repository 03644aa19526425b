"""Named causes that explain little of what the base misses on a held-out run.

What no catalogue lists looks a little like one of its entries, or like two together. These then
explain a part of it only, and most remains on a new run, without structure that would tell.
"""

from collections.abc import Callable, Mapping

import numpy as np

from frictioncli.diagnosis.joint_diagnosis import Diagnosis

_LEAST = 0.42
"""Least share of the mean square that the base misses beside noise which right causes explain."""

_LITTLE = (
    "on the held-out run the named causes explain only {share:.0f} % of the mean square that the"
    " base model misses beside noise; it may be a part of something else"
)


def without_small_parts(diagnose: Callable[[Mapping[str, str]], Diagnosis]) -> Diagnosis:
    """Return a diagnosis in which no cause is named that may be a part of something else.

    Parameters
    ----------
    diagnose : callable
        Diagnosis in which some effects have no name, for the reasons given.
    """
    found = diagnose({})
    reason = explains_little(found)
    if not reason:
        return found
    named = (one.fit.effect for one in found.causes)
    return diagnose({one.name: reason for one in named if not one.measurement})


def explains_little(found: Diagnosis) -> str:
    """Return why properties of the joint may be a part of something else; empty if not.

    Coulomb and viscous friction differ a little from day to day; beside that a cause may explain
    more, and the greater share counts. A change has its history on the new run and explains it
    always; what did not last explains nothing there.

    Parameters
    ----------
    found : Diagnosis
        The diagnosis.
    """
    gain, floor = found.gain, found.floor
    of_joint = [one for one in found.causes if not one.fit.effect.measurement]
    is_judged = bool(of_joint) and all(
        one.fit.effect.moments is None and one.holds_on_new_run is not False for one in of_joint
    )
    if gain is None or gain.basis != "new_run" or gain.beside_days is None:
        return ""
    if not is_judged or found.structure is not None:
        return ""
    before, after = np.transpose([(gain.before, gain.after), gain.beside_days])
    left, missed = np.square(after) - floor**2, np.square(before) - floor**2
    if left[0] <= found.margin**2 or np.any(missed <= 0.0):
        return ""
    share = float(np.max(1.0 - left / missed))
    return _LITTLE.format(share=100 * max(share, 0.0)) if share < _LEAST else ""
