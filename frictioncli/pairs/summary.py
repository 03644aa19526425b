"""What ``pair`` and ``separate`` have to say, in a few lines."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pyarrow as pa

_SPEEDS = 12


@dataclass(slots=True)
class PairTally:
    """Counts pairs by joint and speed, and their samples, while they go by."""

    speeds: dict[int, Counter[float]] = field(default_factory=dict)
    samples: int = 0

    def counted(self, tables: Iterable[pa.Table]) -> Iterator[pa.Table]:
        """Yield rows of :data:`frictioncli.schemas.PAIRS` as they are; those of a pair together.

        A table holds whole pairs of one run and joint.
        """
        for rows in tables:
            joint = int(rows["joint"][0].as_py())
            _, first = np.unique(rows["pair"].to_numpy(), return_index=True)
            speed = np.round(rows["speed"].to_numpy()[first], 1)
            self.speeds.setdefault(joint, Counter()).update(speed.tolist())
            for name in ("n_forward", "n_reverse"):
                self.samples += int(rows[name].to_numpy().sum())
            yield rows


def pairing_text(tally: PairTally, facts: Mapping[str, Any], asked_width: float) -> str:
    """Return pairs per speed, and the samples dropped per reason.

    Parameters
    ----------
    tally : PairTally
        What was counted.
    facts : mapping
        ``samples``, ``dropped`` and ``bin_width`` of the pairing.
    asked_width : float
        Width of the angle bins that was asked for. [deg]
    """
    lines = []
    if facts["bin_width"] > asked_width:
        lines.append(
            f"angle bins widened from {asked_width:g} to {facts['bin_width']:g} deg: the joint"
            " moves that far between samples"
        )
    for joint, speeds in sorted(tally.speeds.items()):
        told = ", ".join(f"{speeds[speed]} at {speed:g}" for speed in sorted(speeds)[:_SPEEDS])
        more = f" and {len(speeds) - _SPEEDS} other speeds" if len(speeds) > _SPEEDS else ""
        lines.append(f"joint {joint}: {speeds.total()} pairs: {told}{more} deg/s")
    dropped = "; ".join(f"{reason} {count}" for reason, count in facts["dropped"].items() if count)
    lines.append(
        f"samples: {facts['samples']} read, {tally.samples} in pairs; dropped: {dropped or 0}"
    )
    return "\n".join(lines)


@dataclass(slots=True)
class TorqueRanges:
    """Least and greatest friction and load torque by joint, while they go by."""

    friction: dict[int, tuple[float, float]] = field(default_factory=dict)
    load: dict[int, tuple[float, float]] = field(default_factory=dict)
    own_load: bool = False

    def seen(self, batches: Iterable[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        """Yield rows of :data:`frictioncli.schemas.TORQUES` as they are."""
        for rows in batches:
            joints = rows.column("joint").to_numpy()
            for joint in np.unique(joints).tolist():
                for ranges, name in ((self.friction, "friction"), (self.load, "load")):
                    own = rows.column(f"{name}_torque").to_numpy()[joints == joint]
                    low, high = ranges.get(joint, (np.inf, -np.inf))
                    ranges[joint] = min(low, float(own.min())), max(high, float(own.max()))
            if "load" in rows.schema.names:
                self.own_load |= rows.column("load").null_count < rows.num_rows
            yield rows


def separation_text(
    ranges: TorqueRanges, signs: Mapping[int, int], facts: Mapping[str, Any], *, told: bool
) -> str:
    """Return the sign convention and the range of both torques, per joint.

    Parameters
    ----------
    ranges : TorqueRanges
        What was seen.
    signs : mapping of int to int
        Sign convention of each joint.
    facts : mapping
        ``torque_unit`` and ``load_unit``.
    told : bool
        Whether the user gave the sign.
    """
    unit = facts.get("torque_unit", "N·m")
    lines = []
    for joint, sign in signs.items():
        convention = "load + friction" if sign > 0 else "load - friction"
        friction, load = (
            f"{low:.3g} to {high:.3g}" for low, high in (ranges.friction[joint], ranges.load[joint])
        )
        lines.append(
            f"joint {joint}: forward torque is {convention} (sign {sign:+d},"
            f" {'as told' if told else 'inferred'}), friction {friction}"
            f" {unit}, load {load} {facts.get('load_unit', unit)}"
        )
    return "\n".join(lines)
