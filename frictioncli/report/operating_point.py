"""Friction at one operating point, and the picture of it: the first thing that the page shows."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictioncli.report.figures import FigureSpec
from frictioncli.report.labels import TEMPERATURE_SYMBOLS
from frictioncli.report.load_speed_figures import has_temperature_term
from frictioncli.report.missing_data import nothing_missing
from frictioncli.report.panel import stacked
from frictioncli.report.results import JointResults
from frictioncli.report.style import (
    COOLING,
    FAINT,
    HEATING,
    MODEL,
    PHASES,
    RASTER_FROM,
    WIDTH,
    legend_above,
)
from frictioncli.wording import number_text, speed_text

_SPREAD = 1.96
"""Half-width of an interval that holds 95 % of a normal distribution, in standard deviations."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingPoint:
    """Friction in the middle of the measured conditions, without load.

    Attributes
    ----------
    speed : float
        Median speed of the pairs, of the thermal cycle where there is one. [deg/s]
    temperature : float
        Median of the model's temperature; NaN for a model without temperature. [°C]
    friction : float
        Friction torque by equation (16). [torque unit]
    error : float
        RMS misfit of equation (16). [torque unit]
    extended_error : float or None
        RMS misfit of the extended model, on a new run where there is one; None without one.
        [torque unit]
    """

    speed: float
    temperature: float
    friction: float
    error: float
    extended_error: float | None

    @property
    def motion(self) -> str:
        """Speed and temperature as text."""
        warm = f", {self.temperature:.0f} °C" if np.isfinite(self.temperature) else ""
        return f"{speed_text(self.speed)}{warm}"

    @property
    def conditions(self) -> str:
        """Speed, temperature and load as text."""
        return f"{self.motion}, no load"


def operating_point(results: JointResults) -> OperatingPoint:
    """Return the operating point of one joint.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    pairs = results.thermal_pairs if len(results.thermal_pairs) else results.pairs
    speeds = np.sort(pairs["speed"].to_numpy(float))
    speed = float(speeds[len(speeds) // 2])
    temperature = float("nan")
    if has_temperature_term(results):
        temperature = float(pairs["temperature"].median())
    friction = results.predict(load=0.0, speed=speed, temperature=temperature)
    gain = results.diagnosis.document.gain if results.diagnosis else None
    return OperatingPoint(
        speed=speed,
        temperature=temperature,
        friction=float(friction),
        error=gain.rmse_before if gain else results.model.rmse,
        extended_error=gain.rmse_after if gain else None,
    )


def overview_figure(results: JointResults) -> Figure:
    """Draw friction over speed, cold to hot, with the operating point and its uncertainty.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    point = operating_point(results)
    figure = Figure(figsize=(WIDTH, 3.9), layout="constrained")
    (panel,) = stacked(figure, 1)
    _draw_pairs(panel, results)
    slowest, fastest = (float(f(results.pairs["speed"])) for f in (np.min, np.max))
    speeds = np.linspace(0.0, np.sqrt(1.04 * fastest), 160) ** 2
    for temperature, colour in _temperatures(results, point):
        curve = results.predict(load=0.0, speed=speeds, temperature=temperature)
        known = f"{temperature:.0f} °C" if np.isfinite(temperature) else "equation (16)"
        measured = (speeds >= slowest) & (speeds <= fastest)
        panel.plot(speeds, curve, color=colour, linewidth=1.0, linestyle=":")
        panel.plot(
            speeds, np.where(measured, curve, np.nan), color=colour, linewidth=1.6, label=known
        )
    panel.errorbar(
        [point.speed],
        [point.friction],
        yerr=[_SPREAD * point.error],
        fmt="o",
        color=MODEL,
        markersize=4.5,
        capsize=5,
        elinewidth=1.6,
        zorder=5,
        label="95 % of misfits",
    )
    if point.extended_error is not None:
        panel.errorbar(
            [point.speed],
            [point.friction],
            yerr=[_SPREAD * point.extended_error],
            fmt="none",
            color=MODEL,
            capsize=0,
            elinewidth=9.0,
            alpha=0.55,
            zorder=4,
            label="by extended model",
        )
    panel.set_xlim(0.0, 1.04 * fastest)
    panel.set_ylim(bottom=min(0.0, panel.get_ylim()[0]))
    panel.set_xlabel("speed |φ'| [deg/s]")
    panel.set_ylabel(f"friction torque τ, no load [{results.unit}]")
    legend_above(panel)
    return figure


def _draw_pairs(panel: Axes, results: JointResults) -> None:
    for phase, colour in ((PHASES[0], HEATING), (PHASES[1], COOLING), ("", FAINT)):
        own = results.pairs["phase"]
        pairs = results.pairs[own == phase if phase else ~own.isin(PHASES)]
        panel.plot(
            pairs["speed"],
            pairs["friction_torque"],
            linestyle="none",
            marker="_",
            markersize=9,
            color=colour,
            alpha=0.35,
            rasterized=len(pairs) > RASTER_FROM,
        )


def _temperatures(results: JointResults, point: OperatingPoint) -> list[tuple[float, str]]:
    """Return coldest, middle and hottest temperature with colours; one NaN without temperature."""
    if not np.isfinite(point.temperature):
        return [(float("nan"), MODEL)]
    known = results.pairs["temperature"].dropna()
    return [
        (float(known.min()), COOLING),
        (point.temperature, MODEL),
        (float(known.max()), HEATING),
    ]


def _caption(results: JointResults) -> str:
    point = operating_point(results)
    warm = (
        f" at three temperatures {TEMPERATURE_SYMBOLS[results.model.temperature]}"
        if np.isfinite(point.temperature)
        else ""
    )
    extended = "; the thick bar that of the extended model" if point.extended_error else ""
    return (
        f"Friction by equation (16){warm}, dotted beyond the measured speeds; dashes: measured"
        " pairs, heating red, cooling blue."
        f" Point: {number_text(point.friction)} {results.unit} at {point.conditions}. The thin bar"
        f" spans 95 % of the misfits of equation (16){extended}."
    )


OVERVIEW = FigureSpec(
    name="overview",
    title="Friction at a glance",
    caption=_caption,
    missing=nothing_missing,
    draw=overview_figure,
    printed=True,
)
