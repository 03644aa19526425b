"""What is said of segments of which no two make a pair."""

from frictioncli.pairs.segments import SegmentTables


def dropped_text(dropped: dict[str, int]) -> str:
    """Return the samples dropped by reason, as text."""
    return ", ".join(f"{reason}: {count}" for reason, count in dropped.items() if count)


def directions_text(segments: SegmentTables) -> str:
    """Return how many segments there are in each direction, and their speeds, as text."""
    texts = []
    for name, sign in (("forward", 1), ("reverse", -1)):
        counts = segments.speeds[sign]
        speeds = (
            f" at {counts.speeds[0]:.3g} to {counts.speeds[-1]:.3g} deg/s" if counts.total else ""
        )
        texts.append(f"{counts.total} constant-velocity parts {name}{speeds}")
    return ", ".join(texts)
