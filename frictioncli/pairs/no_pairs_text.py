"""What is said of segments of which no two make a pair."""

import numpy as np

from frictioncli.pairs.partitioned_store import Columns
from frictioncli.pairs.segments import SegmentTables


def dropped_text(dropped: dict[str, int]) -> str:
    """Return the samples dropped by reason, as text."""
    return ", ".join(f"{reason}: {count}" for reason, count in dropped.items() if count)


def directions_text(segments: SegmentTables) -> str:
    """Return numbers and speeds of the segments of each joint by direction, as text."""
    speeds: dict[int, list[Columns]] = {}
    for joint in sorted(segments.counts):
        of_joint = speeds.setdefault(joint[1], [])
        of_joint += [columns for (columns,) in segments.store.read(joint, "segments")]
    texts = []
    for number, tables in sorted(speeds.items()):
        parts = []
        for name, sign in (("forward", 1), ("reverse", -1)):
            found = np.concatenate([one["speed"][one["direction"] == sign] for one in tables])
            at = f" at {found.min():.3g} to {found.max():.3g} deg/s" if len(found) else ""
            parts.append(f"{len(found)} constant-velocity parts {name}{at}")
        texts.append(f"joint {number}: {', '.join(parts)}")
    return "; ".join(texts)
