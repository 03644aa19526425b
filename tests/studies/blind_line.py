"""One line of text for a joint of the blind study: what is true, and what is said."""

from typing import Any

from tests.studies.blind_judged import right
from tests.studies.blind_rows import Joint


def line(joint: Joint) -> str:
    """Return what is true of a joint, and what is said of it, in one line."""
    world = joint.world
    head = f"{world.kind:8} {world.protocol[:5]} {world.noise[:7]:7} {world.path} {world.seed:3}"
    if not joint.judged:
        return f"{'-':7}{head} {world.hidden}: {joint.verdict}: {joint.note}"
    parts = [*(_named(cause) for cause in joint.causes)]
    parts += [f"({_named(cause)})" for cause in joint.visible]
    if joint.structure is not None:
        parts.append(_structure(joint.structure))
    return (
        f"{right(joint):7}{head} | {_truth(joint)} -> {joint.verdict}:"
        f" {', '.join(parts) or 'nothing'} | day/floor {joint.over_floor:.2f}"
        f" | {joint.numbers['diagnosed']:.1f} s"
    )


def _truth(joint: Joint) -> str:
    if not joint.hidden:
        return joint.world.hidden or "nothing"
    texts = [f"{one['name']} {one['raw']:.2f} left {one['left']:.2f}" for one in joint.hidden]
    history = f" {joint.world.history}" if joint.world.history else ""
    return f"{' + '.join(texts)}{history} (margin {joint.margin:.2f})"


def _named(cause: dict[str, Any]) -> str:
    text = f"{'|'.join(cause['effects'])}"
    if cause.get("standing", "named") != "named":
        text += f" {cause['standing']}"
    left = cause.get("visible_size")
    text += f" {cause['size']:.2f}" if left is None else f" {left:.2f}"
    if cause.get("visible_ci95"):
        low, high = cause["visible_ci95"]
        text += f" [{low:.2f}, {high:.2f}]"
    holds = cause.get("holds_on_new_run")
    if holds is not None:
        text += " holds" if holds else " gone"
    return f"{text} p {cause['p_value']:.0e}"


def _structure(structure: dict[str, Any]) -> str:
    axis = " × ".join(structure["axis"])
    return f"structure {structure['channel']} {axis} {structure['size']:.2f}"
