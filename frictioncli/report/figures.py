"""List of the report's figures in their order, with titles and captions."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from matplotlib.figure import Figure

from frictioncli.report.correction_figures import corrected_friction_figure, corrections_text
from frictioncli.report.evaluation_figure import (
    counts_left_out,
    error_figure,
    setting_text,
    uncertainty_text,
)
from frictioncli.report.labels import TEMPERATURE_WORDS
from frictioncli.report.load_speed_figures import (
    REFERENCE_TEMPERATURE,
    has_temperature_term,
    load_figure,
    speed_figure,
)
from frictioncli.report.missing_data import (
    any_temperature_missing,
    evaluation_missing,
    housing_temperature_missing,
    means_missing,
    motor_temperature_missing,
    nothing_missing,
    residuals_missing,
    schedule_missing,
    speeds_missing,
)
from frictioncli.report.residual_figure import residual_figure, residuals
from frictioncli.report.results import MOST_RUNS, JointResults
from frictioncli.report.style import PHASE_WORDS, PHASES
from frictioncli.report.target_error import target_text
from frictioncli.report.thermal_figures import (
    branch_means_figure,
    friction_temperature_figure,
    phase_spans,
    temperature_figure,
    thermal_runs,
)
from frictioncli.wording import count_text, duration_text, list_text, number_text, speed_text


@dataclass(frozen=True, slots=True, kw_only=True)
class FigureSpec:
    """One figure of the report; its functions take the results of one joint.

    Attributes
    ----------
    name : str
        Stem of its files.
    title : str
        Heading.
    caption : callable
        Returns the caption.
    missing : callable
        Returns why it cannot be drawn and what would be needed; empty if it can be drawn.
    draw : callable
        Draws the figure.
    printed : bool
        Whether it belongs to the summary that is printed.
    """

    name: str
    title: str
    caption: Callable[[JointResults], str]
    missing: Callable[[JointResults], str]
    draw: Callable[[JointResults], Figure]
    printed: bool = False


def _load_caption(results: JointResults) -> str:
    noun = results.row_noun
    single = "pairs of moves" if noun == "pair" else "groups of one speed"
    return (
        f"Points: measured friction of single {single}, one per angle bin. Lines: α·L² + G"
        f" with one α for all {noun}s and a shift G of each {noun}, equations (9) and (10)."
        " Below, the same points without their shift: the load term is valid if they follow the"
        " parabola over the whole load range."
    )


def _time_caption(results: JointResults) -> str:
    texts = []
    for run in thermal_runs(results, "motor_temperature"):
        own = results.pairs[results.pairs["run"] == run].sort_values("time")
        phases = []
        for start, end, phase in phase_spans(own):
            rows = own[(own["time"] >= start) & (own["time"] <= end)]["motor_temperature"].dropna()
            if phase in PHASE_WORDS and len(rows):
                phases.append(
                    f"{PHASE_WORDS[phase]} from {rows.iloc[0]:.0f} to {rows.iloc[-1]:.0f} °C in"
                    f" {duration_text(end - start)}"
                )
        texts.append(f"{run}: {list_text(phases)}")
    temperatures = f" Motor temperature, {'; '.join(texts)}." if texts else ""
    return f"Temperatures at the measured {results.row_noun}s; the phases are shaded.{temperatures}"


def _temperature_caption(results: JointResults, kind: str) -> str:
    column, name = f"{kind}_temperature", f"{kind} temperature"
    known = results.thermal_pairs.dropna(subset=[column])
    texts = []
    for run in thermal_runs(results, column):
        own = known[known["run"] == run]
        # the ends of one branch: between heating and cooling friction differs
        branch = next(phase for phase in PHASES if (own["phase"] == phase).any())
        own = own[own["phase"] == branch]
        fastest = own[own["speed"] == own["speed"].max()].sort_values(column, kind="stable")
        cold, hot = fastest.iloc[0], fastest.iloc[-1]
        texts.append(
            f"{run}, {PHASE_WORDS[branch]}: {number_text(cold['friction_torque'])}"
            f" {results.unit} at {cold[column]:.0f} °C, {number_text(hot['friction_torque'])}"
            f" {results.unit} at {hot[column]:.0f} °C"
        )
    return (
        f"Friction torque at zero load against the {name}; heating filled, cooling hollow. At"
        f" {speed_text(known['speed'].max())}, {'; '.join(texts)}. Where filled and hollow points"
        f" differ at one temperature, the {name} alone does not determine friction."
    )


def _means_caption(results: JointResults) -> str:
    curves = (
        "The curves are the fitted function; as it depends on one temperature, it runs between the"
        " branches."
    )
    if results.model.temperature != "mean":
        curves += (
            " The paper has T* = (Tm + Tc)/2 on this axis; this function was fitted over the"
            f" {_model_temperature(results)} and is drawn over that."
        )
    return (
        "Points: mean of the heating and cooling branches at equal temperature, equation (11)."
        f" {curves}"
    )


def _model_temperature(results: JointResults) -> str:
    return TEMPERATURE_WORDS[results.model.temperature]


def _speed_caption(results: JointResults) -> str:
    if not has_temperature_term(results):
        carried = (
            "Friction torque at zero load as measured. It could not be converted to one"
            " temperature, because the model has no temperature term."
        )
    else:
        carried = (
            f"Friction torque at zero load, converted to T0 = {REFERENCE_TEMPERATURE:.0f} °C by"
            f" equation (15) with the {_model_temperature(results)}."
        )
    return (
        f"{carried} Heating is filled and shifted to the left, cooling hollow and shifted to the"
        " right, so that neither hides the other. A Stribeck effect would show as points that rise"
        " above the curve towards zero speed."
    )


def _schedule_caption(results: JointResults, phase: str) -> str:
    return (
        f"Friction at zero load through {PHASE_WORDS[phase]}, {setting_text(results)}: measured"
        " (points), smoothed (thin line), predicted by (16) with T = Tm + ΔT (dashed). Vertical"
        " lines are corrections with the new ΔT, dotted where it could not be computed. Between"
        " two lines the dashed curve should stay on the thin one."
        f"{corrections_text(results, phase)}"
    )


def _evaluation_caption(results: JointResults) -> str:
    sentences = [
        "Corrections of the extended model." if results.evaluated_extended else "",
        "Error ε of equation (21) against the number of corrections in a phase. Where several"
        " settings give the same number, the bar is their median. Diamonds: the same number of"
        " corrections, equally spaced.",
        uncertainty_text(results),
        "Dashed lines: no correction at all.",
        f"Dotted: {target_text(results)}.",
        f"Not drawn, for lack of room: {list_text([str(n) for n in left])} corrections."
        if (left := counts_left_out(results))
        else "",
    ]
    return " ".join(sentence for sentence in sentences if sentence)


def _residual_caption(results: JointResults) -> str:
    noun = results.row_noun
    pairs = count_text(residuals(results).groupby(["run", "pair"]).ngroups, noun)
    if thermal_runs(results, "motor_temperature", "housing_temperature"):
        lag = "; heating and cooling on different sides of zero indicate a temperature lag."
    else:
        lag = "."
    return (
        "Measured minus modelled friction, without temperature correction. Points: mean of each of"
        f" the {pairs}. By angle: mean over all {noun}s of a speed. A trend or a wave is structure"
        f" that the model lacks{lag}"
    )


FIGURES = (
    FigureSpec(
        name="fig3",
        title="Figure 3. Friction against load",
        caption=_load_caption,
        missing=nothing_missing,
        draw=load_figure,
    ),
    FigureSpec(
        name="fig4",
        title="Figure 4. Temperatures over time",
        caption=_time_caption,
        missing=any_temperature_missing,
        draw=temperature_figure,
    ),
    FigureSpec(
        name="fig5",
        title="Figure 5. Friction against motor temperature",
        caption=partial(_temperature_caption, kind="motor"),
        missing=motor_temperature_missing,
        draw=partial(friction_temperature_figure, kind="motor"),
        printed=True,
    ),
    FigureSpec(
        name="fig6",
        title="Figure 6. Friction against housing temperature",
        caption=partial(_temperature_caption, kind="housing"),
        missing=housing_temperature_missing,
        draw=partial(friction_temperature_figure, kind="housing"),
    ),
    FigureSpec(
        name="fig7",
        title="Figure 7. Mean of heating and cooling, with the model",
        caption=_means_caption,
        missing=means_missing,
        draw=branch_means_figure,
    ),
    FigureSpec(
        name="fig8",
        title="Figure 8. Friction against speed",
        caption=_speed_caption,
        missing=speeds_missing,
        draw=speed_figure,
        printed=True,
    ),
    FigureSpec(
        name="fig9",
        title="Figure 9. Corrected estimates through heating",
        caption=partial(_schedule_caption, phase="heat-up"),
        missing=partial(schedule_missing, phase="heat-up"),
        draw=partial(corrected_friction_figure, phase="heat-up"),
    ),
    FigureSpec(
        name="fig10",
        title="Figure 10. Corrected estimates through cooling",
        caption=partial(_schedule_caption, phase="cool-down"),
        missing=partial(schedule_missing, phase="cool-down"),
        draw=partial(corrected_friction_figure, phase="cool-down"),
    ),
    FigureSpec(
        name="fig11",
        title="Figure 11. Error against the number of corrections",
        caption=_evaluation_caption,
        missing=evaluation_missing,
        draw=error_figure,
        printed=True,
    ),
    FigureSpec(
        name="residuals",
        title="Residuals",
        caption=_residual_caption,
        missing=residuals_missing,
        draw=residual_figure,
    ),
)


def runs_drawn_note(results: JointResults) -> str:
    """Return a sentence on runs that the figures leave out; empty if they show all runs.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    if len(results.runs) <= MOST_RUNS:
        return ""
    return (
        f"Figures 3 to 11 and the explorer show the first {MOST_RUNS} of {len(results.runs)} runs"
        " with the data for them; the fit, the tables and the last figure use all runs."
    )
