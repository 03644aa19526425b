"""Data that a figure lacks: each function returns why it cannot be drawn and what is needed.

An empty string means that nothing is missing.
"""

from frictioncli.report.evaluation_figure import compared_criterion
from frictioncli.report.labels import TEMPERATURE_WORDS
from frictioncli.report.residual_figure import residuals
from frictioncli.report.results import JointResults
from frictioncli.report.style import PHASE_WORDS
from frictioncli.report.thermal_figures import has_means, thermal_runs


def nothing_missing(results: JointResults) -> str:
    """Return an empty string, for figures that can always be drawn.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    return ""


def _temperature_missing(results: JointResults, column: str, name: str) -> str:
    if not results.has(column):
        return (
            f"The log has no {name}. This needs a channel with the {name},"
            " recorded while the joint heats up and cools down."
        )
    if not thermal_runs(results, column):
        return (
            f"The {name} was recorded, but no heating or cooling phase was found in it."
            " This needs pairs of moves while the joint heats up and cools down."
        )
    return ""


def motor_temperature_missing(results: JointResults) -> str:
    """Return why there is no thermal cycle with motor temperature.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    return _temperature_missing(results, "motor_temperature", "motor temperature")


def housing_temperature_missing(results: JointResults) -> str:
    """Return why there is no thermal cycle with housing temperature.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    return _temperature_missing(results, "housing_temperature", "housing temperature")


def any_temperature_missing(results: JointResults) -> str:
    """Return why there is no thermal cycle with any temperature.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    if results.has("motor_temperature"):
        return motor_temperature_missing(results)
    if results.has("housing_temperature"):
        return housing_temperature_missing(results)
    return _temperature_missing(results, "motor_temperature", "motor or housing temperature")


def means_missing(results: JointResults) -> str:
    """Return why there are no means (11) of the heating and the cooling branch.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    if missing := any_temperature_missing(results):
        return missing
    if not has_means(results):
        return (
            f"No speed was measured both in heating and in cooling over the same range of the"
            f" {TEMPERATURE_WORDS[results.model.temperature]}. This needs both branches."
        )
    return ""


def speeds_missing(results: JointResults) -> str:
    """Return why there are not several speeds.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    if len(results.styles) < 2:
        return "All pairs have the same speed. This needs pairs at several speeds."
    return ""


def schedule_missing(results: JointResults, phase: str) -> str:
    """Return why there is no simulated schedule of a phase.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    phase : {"heat-up", "cool-down"}
        The phase.
    """
    if results.schedule.empty:
        if missing := motor_temperature_missing(results):
            return f"No corrections can be simulated. {missing}"
        return "No corrections were simulated: run 'frictioncli simulate'."
    if not (results.schedule["phase"] == phase).any():
        return (
            f"The simulated schedule has no {PHASE_WORDS[phase]} phase."
            f" This needs pairs of moves in {PHASE_WORDS[phase]}."
        )
    return ""


def evaluation_missing(results: JointResults) -> str:
    """Return why there is no evaluation of corrections.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    if results.evaluation.empty:
        if missing := motor_temperature_missing(results):
            return f"No corrections can be compared. {missing}"
        return "No corrections were compared: run 'frictioncli evaluate'."
    if not compared_criterion(results):
        return (
            "The evaluation compares no criterion of corrections:"
            " run 'frictioncli evaluate' with at least one."
        )
    return ""


def residuals_missing(results: JointResults) -> str:
    """Return why there are no residuals.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    if residuals(results).empty:
        return (
            f"The model needs the {TEMPERATURE_WORDS[results.model.temperature]}, which no pair"
            " has: run 'frictioncli fit' on these data."
        )
    return ""
