"""Error that corrections should reach: small beside the friction of the joint."""

from frictioncli.report.results import JointResults

_PAPER_ERROR = 2.0
"""Error that the source paper reaches on a joint of about 60 N·m of friction. [N·m]"""

_SHARE = 0.04
"""Target as a share of the mean friction of the joint."""


def target_error(results: JointResults) -> float:
    """Return the error (21) that corrections should reach [torque unit].

    It is 4 % of the mean friction of the joint, in N·m at most the 2 N·m of the source paper.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    share = _SHARE * float(results.torques["friction_torque"].abs().mean())
    return min(share, _PAPER_ERROR) if results.unit == "N·m" else share


def target_text(results: JointResults) -> str:
    """Return the target in words, with where it comes from; parameter as of `target_error`."""
    target = target_error(results)
    if results.unit == "N·m" and target == _PAPER_ERROR:
        return "2 N·m, as in the paper"
    return f"{target:.2g} {results.unit}, {100 * _SHARE:g} % of the mean friction"
