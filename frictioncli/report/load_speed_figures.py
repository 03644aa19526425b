"""Figures 3 and 8: friction against load, and against speed at 20 °C."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from frictioncli.model.friction import carried_to_temperature
from frictioncli.report.labels import figure_text, friction_label
from frictioncli.report.panel import stacked
from frictioncli.report.results import MOST_RUNS, JointResults, by_speed
from frictioncli.report.style import (
    FAINT,
    MODEL,
    PHASES,
    WIDTH,
    label_right,
    legend_above,
    panels,
    points,
)
from frictioncli.wording import number_text, speed_text

REFERENCE_TEMPERATURE = 20.0
"""Temperature T0 of Figure 8. [°C]"""

_MOST_CURVES = 8
_MOST_HOT = 2
_ASIDE = {"heat-up": -0.012, "": 0.0, "cool-down": 0.012}
"""Shift of the points of each phase in Figure 8, as a share of the highest speed."""

_FEW_PAIRS = 3
"""Number of pairs at a speed up to which their mean would hide them."""

_CURVES_HEIGHT = 3.6
_SHIFTED_HEIGHT = 1.7


def load_figure(results: JointResults) -> Figure:
    """Draw Figure 3: friction of single pairs against load, with alpha L² + G.

    A panel below shows the same without the shift G, which leaves the load term.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    runs = results.runs[:MOST_RUNS]
    height = _CURVES_HEIGHT + _SHIFTED_HEIGHT
    figure = Figure(figsize=(WIDTH, height * len(runs) + 0.5), layout="constrained")
    heights = [_CURVES_HEIGHT, _SHIFTED_HEIGHT] * len(runs)
    grid = stacked(figure, 2 * len(runs), heights, share_x=True)
    alpha = results.model.friction.alpha
    span = results.torques["load_torque"].min(), results.torques["load_torque"].max()
    friction = results.friction()
    for index, run in enumerate(runs):
        panel, shifted = grid[2 * index], grid[2 * index + 1]
        labels = []
        chosen = representative_pairs(results.pairs[results.pairs["run"] == run])
        for pair in chosen.to_dict("records"):
            style = results.style(pair["speed"])
            rows = friction[(friction["run"] == run) & (friction["pair"] == pair["pair"])]
            load = np.linspace(rows["load_torque"].min(), rows["load_torque"].max(), 80)
            for where, shift in ((panel, 0.0), (shifted, pair["friction_torque"])):
                points(
                    where, rows["load_torque"], rows["friction_torque"] - shift, style, opacity=0.6
                )
            fitted = alpha * load**2 + pair["friction_torque"]
            panel.plot(load, fitted, color=style.colour)
            motor = pair["motor_temperature"]
            known = "" if pd.isna(motor) else f", {motor:.0f} °C"
            labels.append((float(fitted[-1]), speed_text(pair["speed"]) + known, style.colour))
        panel.set_title(figure_text(run))
        panel.set_ylabel(friction_label(results.unit))
        panel.margins(y=0.08)
        label_right(panel, labels, height=_CURVES_HEIGHT)
        load = np.linspace(*span, 120)
        shifted.plot(load, alpha * load**2, color=MODEL, label="α L²")
        shifted.set_ylabel(f"τ − G [{results.unit}]")
        legend_above(shifted)
    grid[-1].set_xlabel(f"load torque L [{results.load_unit}]")
    return figure


def representative_pairs(pairs: pd.DataFrame) -> pd.DataFrame:
    """Return at most eight pairs of a run that span its speeds and temperatures.

    From a speed sweep one pair per speed is taken, from a thermal cycle the coldest and the hottest
    pair of each speed. With both, the pairs of the sweep replace the coldest pairs.

    Parameters
    ----------
    pairs : DataFrame
        One row per pair of one run.
    """
    # pairs of few angle bins do not show the parabola
    pairs = pairs[pairs["bins"] >= 0.5 * pairs.groupby("speed")["bins"].transform("max")]
    sweep = pairs[pairs["phase"] == "sweep"].groupby("speed").head(1).sort_values("speed")
    cycle = pairs[pairs["phase"].isin(PHASES)]
    warm = cycle.dropna(subset=["motor_temperature"])
    by_temperature = warm.sort_values("motor_temperature", kind="stable").groupby("speed")
    hottest = by_temperature.tail(1).sort_values("speed")
    coldest = by_temperature.head(1).sort_values("speed")
    if warm.empty:
        return _evenly_spaced(pairs.groupby("speed").head(1).sort_values("speed"), _MOST_CURVES)
    if len(sweep) > 1:
        hot = _evenly_spaced(hottest, _MOST_HOT)
        return pd.concat([_evenly_spaced(sweep, _MOST_CURVES - len(hot)), hot])
    chosen = pd.concat(
        [_evenly_spaced(coldest, _MOST_CURVES // 2), _evenly_spaced(hottest, _MOST_CURVES // 2)]
    )
    return chosen.drop_duplicates("pair")


def _evenly_spaced(pairs: pd.DataFrame, most: int) -> pd.DataFrame:
    if len(pairs) <= most:
        return pairs
    return pairs.iloc[np.linspace(0, len(pairs) - 1, most).round().astype(int)]


def speed_figure(results: JointResults) -> Figure:
    """Draw Figure 8: friction at zero load against speed, at 20 °C by (15), with the model.

    Without a temperature the friction is drawn as measured.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    runs = results.runs[:MOST_RUNS]
    figure, axes = panels(len(runs), height=3.6)
    carried = friction_at_reference_temperature(results)
    fastest = carried["speed"].max()
    # square-root spacing resolves low speeds, where a Stribeck effect would show
    speeds = np.linspace(0.0, np.sqrt(fastest * 1.03), 200) ** 2
    curve = results.predict(load=0.0, speed=speeds, temperature=REFERENCE_TEMPERATURE)
    for run, panel in zip(runs, axes, strict=True):
        own = carried[carried["run"] == run]
        panel.plot(speeds, curve, color=MODEL, label="model (16), L = 0")
        for speed, group in by_speed(own):
            branch = _branch(group)
            measured, friction = group["speed"].to_numpy(), group["carried"].to_numpy()
            for phase, aside in _ASIDE.items():
                chosen = branch == phase
                points(
                    panel,
                    measured[chosen] + aside * fastest,
                    friction[chosen],
                    results.style(speed),
                    filled=phase != "cool-down",
                    size=4.0,
                    tooltips=[
                        f"{speed_text(speed)}: {number_text(value)} {results.unit}"
                        for value in friction[chosen]
                    ],
                )
        by_number = own.groupby("speed")["carried"].agg(["mean", "size"])
        means = by_number.loc[by_number["size"] > _FEW_PAIRS, "mean"]
        panel.plot(
            means.index,
            means,
            linestyle="none",
            marker="_",
            markersize=24,
            markeredgewidth=1.6,
            color=MODEL,
            zorder=1.9,
        )
        panel.plot([], [], "_", color=MODEL, markersize=9, markeredgewidth=1.6, label="mean")
        panel.plot([], [], "o", color=FAINT, markersize=3.5, label="pair")
        panel.plot([], [], "o", color=FAINT, markerfacecolor="white", label="cooling")
        panel.set_title(figure_text(run))
        panel.set_ylabel(friction_label(results.unit))
        panel.set_ylim(bottom=min(0.0, panel.get_ylim()[0]))
        panel.set_xlim(left=0.0)
        legend_above(panel)
    axes[-1].set_xlabel("speed |φ'| [deg/s]")
    return figure


def _branch(pairs: pd.DataFrame) -> np.ndarray:
    """Return the phase of each pair, empty outside heating and cooling."""
    phase = pairs["phase"].to_numpy(object)
    return np.where(np.isin(phase, PHASES), phase, "")


def has_temperature_term(results: JointResults) -> bool:
    """Return whether friction can be converted from one temperature to another.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    return results.model.knows_temperature and results.has("temperature")


def friction_at_reference_temperature(results: JointResults) -> pd.DataFrame:
    """Return the pairs with a column ``carried``: friction torque converted to 20 °C by (15).

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    pairs = results.pairs
    if not has_temperature_term(results):
        return pairs.assign(carried=pairs["friction_torque"])
    known = pairs.dropna(subset=["temperature"])
    return known.assign(
        carried=carried_to_temperature(
            results.model.friction,
            friction=known["friction_torque"],
            speed=known["speed"],
            temperature=known["temperature"],
            target=REFERENCE_TEMPERATURE,
        )
    )
