"""What ``pair`` and ``separate`` have to say, in a few lines."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

_SPEEDS = 12


def pairing_text(pairs: pd.DataFrame, facts: Mapping[str, Any], asked_width: float) -> str:
    """Return pairs per speed, and the samples dropped per reason.

    Parameters
    ----------
    pairs : DataFrame
        Rows of :data:`frictioncli.schemas.PAIRS`.
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
    heads = pairs.drop_duplicates(["run", "joint", "pair"])
    for joint, group in heads.groupby("joint"):
        speeds = group["speed"].round(1).value_counts().sort_index()
        told = ", ".join(f"{count} at {speed:g}" for speed, count in speeds.head(_SPEEDS).items())
        more = f" and {len(speeds) - _SPEEDS} other speeds" if len(speeds) > _SPEEDS else ""
        lines.append(f"joint {joint}: {len(group)} pairs: {told}{more} deg/s")
    kept = int(pairs["n_forward"].sum() + pairs["n_reverse"].sum())
    dropped = "; ".join(f"{reason} {count}" for reason, count in facts["dropped"].items() if count)
    lines.append(f"samples: {facts['samples']} read, {kept} in pairs; dropped: {dropped or 0}")
    return "\n".join(lines)


def separation_text(
    torques: pd.DataFrame, signs: Mapping[int, int], facts: Mapping[str, Any], *, told: bool
) -> str:
    """Return the sign convention and the range of both torques, per joint.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES`.
    signs : mapping of int to int
        Sign convention of each joint.
    facts : mapping
        ``torque_unit`` and ``load_unit``.
    told : bool
        Whether the user gave the sign.
    """
    unit = facts.get("torque_unit", "N·m")
    lines = []
    for joint, group in torques.groupby("joint"):
        convention = "load + friction" if signs[joint] > 0 else "load - friction"
        lines.append(
            f"joint {joint}: forward torque is {convention} (sign {signs[joint]:+d},"
            f" {'as told' if told else 'inferred'}), friction {_span(group['friction_torque'])}"
            f" {unit}, load {_span(group['load_torque'])} {facts.get('load_unit', unit)}"
        )
    return "\n".join(lines)


def _span(values: pd.Series) -> str:
    return f"{values.min():.3g} to {values.max():.3g}"
