"""Tables of pairs and angle bins for the tests of effects."""

from dataclasses import fields

import numpy as np

from frictioncli.diagnosis.data.motion_history import pauses_of, unrecorded_motion
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import EffectTable
from frictioncli.model.friction import PUBLISHED, friction_torque

COLUMNS = tuple(one.name for one in fields(EffectTable) if one.init)


def small(**columns) -> EffectTable:
    """Return a table of the given columns; others are ones; a pair per row, none unrecorded."""
    rows = max(np.size(values) for values in columns.values())
    filled = {name: np.ones(rows) for name in COLUMNS}
    filled |= {"run": np.zeros(rows, int), "pair": np.arange(rows), "moved": np.zeros(rows)}
    filled |= {name: np.broadcast_to(values, rows) for name, values in columns.items()}
    filled["angle"] = np.broadcast_to(columns.get("angle", filled["position"]), rows)
    return EffectTable(**filled)


def two_days(*, bins: int = 13, series: int = 12) -> EffectTable:
    """Return two runs of heating and cooling: series of four speeds in changing order."""
    random = np.random.default_rng(7)
    per_pair = []
    for run in range(2):
        time, travel = 60.0, 0.0
        for number in range(series):
            heating = number < series // 2
            rest = 0.0 if number == 0 else (30.0 if heating else 600.0)
            moved = 300.0 if heating and number else 0.0
            time += moved + rest
            travel += moved * 150.0
            for order, speed in enumerate(random.permutation([5.0, 20.0, 60.0, 150.0])):
                warm = number if heating else series - number
                motor = 25.0 + 5.0 * warm + 0.2 * order + run
                per_pair.append(
                    {
                        "run": run,
                        "time": time,
                        "clock": time + 86_400.0 * run,
                        "speed": speed,
                        "temperature": motor,
                        "measured_temperature": motor,
                        "motor_temperature": motor,
                        "housing_temperature": 23.0 + 0.6 * (motor - 23.0),
                        "moved": {0: moved, 2: moved / 30.0}.get(order, 0.0),
                        "warmed_to": motor + 1.0,
                        "travel": travel,
                        "rest": rest if number else np.inf,
                        "order": float(order),
                    }
                )
                time += 360.0 / speed + 20.0
                travel += 360.0
    pairs = {name: np.array([row[name] for row in per_pair]) for name in per_pair[0]}
    rows = {name: np.repeat(values, bins) for name, values in pairs.items()}
    position = np.tile(5.0 + 5.0 * np.arange(bins), len(per_pair))
    load = 60.0 * np.cos(np.radians(position))
    viscous = PUBLISHED.beta + PUBLISHED.gamma * np.exp(-PUBLISHED.delta * rows["temperature"])
    slope = -PUBLISHED.delta * (viscous - PUBLISHED.beta) * np.sqrt(rows["speed"])
    friction = friction_torque(
        PUBLISHED, load=load, speed=rows["speed"], temperature=rows["temperature"]
    )
    return EffectTable(
        **rows,
        pair=np.repeat(np.arange(len(per_pair)), bins),
        position=position,
        angle=position,
        load=load,
        load_gradient=-60.0 * np.radians(1.0) * np.sin(np.radians(position)),
        load_curvature=-np.square(np.radians(1.0)) * load,
        friction=friction,
        viscous=viscous,
        temperature_slope=slope,
        load_slope=2 * PUBLISHED.alpha * load,
        friction_power=friction * rows["speed"] / (100.0 * np.mean(friction)),
    )


def moved_before(time, speed, stroke, motor) -> np.ndarray:
    """Return the time of unrecorded motion before each pair of a run, as its motor tells. [s]"""
    count = len(time)
    layout = PairLayout.of(
        row_pair=np.arange(count),
        run=np.zeros(count, int),
        time=time,
        speed=speed,
        position=np.zeros(count),
    )
    pause = pauses_of(layout, 2 * np.broadcast_to(stroke, count))
    moved, _ = unrecorded_motion(layout, pause, motor)
    return np.append(0.0, moved * pause)


def selected(table: EffectTable, rows) -> EffectTable:
    """Return some rows of a table."""
    return EffectTable(**{name: getattr(table, name)[rows] for name in COLUMNS})


def friction(name: str, table: EffectTable, **shape: float) -> list[list[float]]:
    """Return the friction columns of an effect, one list per row."""
    return BY_NAME[name].evaluate(table, shape).friction.tolist()


def load(name: str, table: EffectTable, **shape: float) -> list[list[float]]:
    """Return the load columns of an effect, one list per row."""
    return BY_NAME[name].evaluate(table, shape).load.tolist()
