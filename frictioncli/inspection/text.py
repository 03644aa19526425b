"""Text of an inspection for the terminal: a block per file or group of files, then the joints."""

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from pathlib import Path

from frictioncli.inspection.findings import ChannelInspection, FileInspection, JointInspection
from frictioncli.inspection.inspect import Inspection
from frictioncli.inspection.remarks import Remark, is_coarse, is_stationary, remarks, unit_of
from frictioncli.inspection.sufficiency import JointSummary
from frictioncli.plain_text import printable
from frictioncli.wording import list_text

WIDTH = 100
_EXAMPLES = 3
_NAME_WIDTH = 36
_LONG_PREFIX = 12


def text(found: Inspection, *, verbose: bool = False) -> str:
    """Return the text of an inspection in lines of at most 100 characters, where names allow.

    What the logs suffice for comes first, then what is wrong with them, then their channels.

    Parameters
    ----------
    found : Inspection
        The inspection.
    verbose : bool
        Whether every file of a group of like files is listed.
    """
    usable = [file for file in found.files if not file.refusal]
    refused = [file for file in found.files if file.refusal]
    groups = _groups(usable)
    blocks = [
        *(_joint_summary(joint) for joint in found.joints if joint.forward or joint.reverse),
        *_motionless(found.joints),
        *(_wrapped(printable(remark, 8 * WIDTH), "  ", first="") for remark in found.remarks),
        *(_refused(group) for group in _refused_groups(refused)),
        *(_block(group, verbose=verbose) for group in groups),
    ]
    if not verbose and any(len(group) > 1 for group in groups):
        blocks.append(["--verbose lists the rows, sampling and faults of every file."])
    return "\n\n".join("\n".join(block) for block in blocks)


def _groups(files: Iterable[FileInspection]) -> list[list[FileInspection]]:
    """Group files of one format whose channels are read in the same way."""
    groups: dict[object, list[FileInspection]] = {}
    for file in files:
        channels = tuple(
            (joint.joint, c.quantity, c.column, c.unit_found, c.unit_believed)
            for joint in file.joints
            for c in joint.channels
        )
        groups.setdefault((file.run, file.form, file.columns, channels), []).append(file)
    return list(groups.values())


def _refused_groups(files: Iterable[FileInspection]) -> list[list[FileInspection]]:
    """Group files of one format that are refused for one reason."""
    groups: dict[object, list[FileInspection]] = {}
    for file in files:
        groups.setdefault((file.run, file.reason, file.form), []).append(file)
    return list(groups.values())


def _block(files: list[FileInspection], *, verbose: bool) -> list[str]:
    first = files[0]
    form = f"{printable(first.form)}; {first.columns} columns"
    if len(files) == 1:
        head = [printable(str(first.path), WIDTH), f"  {form}", f"  {_sampling_text(first)}"]
    else:
        head = [
            f"{printable(str(first.path.parent), WIDTH)}: {len(files)} files alike",
            f"  {form}",
        ]
    joints = [_joint([file.joints[i] for file in files]) for i in range(len(first.joints))]
    joints.append(_stationary(files))
    table = _table(files) if verbose and len(files) > 1 else []
    return [*head, *(line for lines in joints for line in lines), *table, *_remarks(files)]


def _refused(files: list[FileInspection]) -> list[str]:
    first = files[0]
    if len(files) == 1:
        lines = [printable(str(first.path), WIDTH)]
        if first.form:
            lines.append(f"  {printable(first.form)}; {first.columns} columns")
        lines += [f"  {_sampling_text(first)}"] if first.sampling else []
        lines += _wrapped(f"not usable: {printable(first.refusal, 6 * WIDTH)}", "    ", first="  ")
        return [*lines, *_remarks(files)]
    lines = [f"{printable(str(first.path.parent), WIDTH)}: {len(files)} files not read"]
    texts: dict[str, list[str]] = {}
    for file in files:
        texts.setdefault(file.refusal, []).append(file.path.name)
    for refusal, names in list(texts.items())[:_EXAMPLES]:
        shown = ", ".join(_short(names)[:_EXAMPLES])
        more = f" and {len(names) - _EXAMPLES} more" if len(names) > _EXAMPLES else ""
        lines += _bullet(f"{shown}{more}: {printable(refusal, 3 * WIDTH)}")
    others = [name for names in list(texts.values())[_EXAMPLES:] for name in names]
    if not others:
        return lines
    return [*lines, *_bullet(f"{list_text(_short(others))}: for similar reasons, see --json")]


def _sampling_text(file: FileInspection) -> str:
    found = file.sampling
    kept = "" if file.refusal else f", {file.rows_kept:,} usable"
    if found is None:
        return f"{file.rows:,} rows{kept}"
    jitter = f"jitter {found.jitter_s:.2g} s" if found.jitter_s else "even"
    return (
        f"{file.rows:,} rows{kept}; {found.duration_s:.3f} s, every"
        f" {found.nominal_period_s:.4g} s ({jitter}), {found.rate_hz:.4g} Hz"
    )


def _joint(joints: Sequence[JointInspection]) -> list[str]:
    """Return the lines of a joint in a group of files; none where it is stationary in all."""
    if all(is_stationary(joint) for joint in joints):
        return []
    first = joints[0]
    ratio = "" if first.gear_ratio is None else f", gear ratio {first.gear_ratio:.4g}"
    segments = "no constant speed"
    counts = {
        direction: sum(joint.moves.get(direction, 0) for joint in joints)
        for direction in first.moves
    }
    if any(counts.values()):
        segments = "constant speed: " + ", ".join(
            f"{count} {direction}" for direction, count in counts.items()
        )
    lines = [
        f"  joint {first.joint}: torque in {first.torque_unit} at the {first.torque_side}{ratio};"
        f" {segments}"
    ]
    for i in range(len(first.channels)):
        lines += _channel([joint.channels[i] for joint in joints], joints)
    return lines


def _stationary(files: Sequence[FileInspection]) -> list[str]:
    numbers = [
        joint.joint
        for i, joint in enumerate(files[0].joints)
        if all(is_stationary(file.joints[i]) for file in files)
    ]
    return _wrapped(f"{_joints(numbers)} standing still", "    ", first="  ") if numbers else []


def _joints(numbers: Sequence[int]) -> str:
    return f"joint{'s' * (len(numbers) > 1)} {', '.join(map(str, numbers))}"


def _channel(channels: Sequence[ChannelInspection], joints: Sequence[JointInspection]) -> list[str]:
    first = channels[0]
    unit = unit_of(first.quantity, joints[0].torque_unit)
    low, high = min(c.lowest for c in channels), max(c.highest for c in channels)
    reach = f"{low:.4g} to {high:.4g} {unit}" if high > low else f"constant {low:.4g} {unit}"
    if high < low:
        reach = "no values"
    values = [reach]
    if any(is_coarse(c) for c in channels):
        values.append(_steps(channels, unit))
    side = f" ({first.side} side)" if first.side == "motor" else ""
    what = first.quantity.replace("_", " ")
    name = printable(first.column, 40)
    line = f"{what:19} {name}{side}: {'; '.join(values)}"
    why = printable(first.evidence, 3 * WIDTH) + _agreement(first, joints)
    if f"as {first.unit_believed}" not in why:
        why = f"read as {first.unit_believed}: {why}"
    return [*_wrapped(line, " " * 24, first="    "), *_wrapped(why, " " * 24, first=" " * 24)]


def _steps(channels: Sequence[ChannelInspection], unit: str) -> str:
    grids = [c.grid for c in channels if c.grid is not None]
    best = max(grids, key=lambda grid: grid.levels)
    sure = "" if best.certainty > 0.9 else f", {100 * best.certainty:.0f} % sure"
    return f"in steps of {best.step:.3g} {unit} ({best.levels} levels{sure})"


def _agreement(channel: ChannelInspection, joints: Sequence[JointInspection]) -> str:
    """Return the agreement of velocity with the change of position."""
    found = [j.velocity_agreement for j in joints if j.velocity_agreement is not None]
    if channel.quantity != "velocity" or not found:
        return ""
    low, high = min(found), max(found)
    ratio = f"{low:.3f}" if high - low < 0.001 else f"{low:.3f} to {high:.3f}"
    return f"; change of position / integral of velocity = {ratio}"


_COLUMNS = ("rows", "usable", "s", "period s", "Hz", "jitter s", "gaps", "held", "spikes", "moves")


def _table(files: Sequence[FileInspection]) -> list[str]:
    """Return a line per file."""
    names = _short([file.path.name for file in files])
    rows = [_COLUMNS, *(_cells(file) for file in files)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(_COLUMNS))]
    wide = max(len("file"), *(len(name) for name in names))
    return [
        f"  {name:{wide}} " + " ".join(f"{cell:>{w}}" for cell, w in zip(row, widths, strict=True))
        for name, row in zip(["file", *names], rows, strict=True)
    ]


def _short(names: Sequence[str]) -> list[str]:
    """Return names without a long common prefix."""
    first, last = min(names), max(names)
    common = next(
        (i for i, pair in enumerate(zip(first, last, strict=False)) if pair[0] != pair[1]), 0
    )
    if common > _LONG_PREFIX and max(map(len, names)) > _NAME_WIDTH:
        names = [f"...{name[common:]}" for name in names]
    return [printable(name, _NAME_WIDTH) for name in names]


def _cells(file: FileInspection) -> tuple[str, ...]:
    found = file.sampling
    timing = (
        ("-",) * 4
        if found is None
        else (
            f"{found.duration_s:.1f}",
            f"{found.nominal_period_s:.4g}",
            f"{found.rate_hz:.4g}",
            f"{found.jitter_s:.1g}",
        )
    )
    segments = [
        sum(joint.moves.get(direction, 0) for joint in file.joints)
        for direction in ("forward", "reverse")
    ]
    return (
        str(file.rows),
        str(file.rows_kept),
        *timing,
        str(0 if found is None else found.gaps),
        str(sum(joint.held_samples for joint in file.joints)),
        str(sum(spikes.count for joint in file.joints for spikes in joint.spikes)),
        "+".join(map(str, segments)),
    )


def _remarks(files: Sequence[FileInspection]) -> list[str]:
    """Return the remarks: those on all files once, the others with their file."""
    seen: dict[Remark, list[Path]] = {}
    for file in files:
        for remark in remarks(file):
            seen.setdefault(remark, []).append(file.path)
    common = [remark.text for remark, where in seen.items() if len(where) == len(files)]
    lines = [line for remark_text in common for line in _bullet(remark_text)]
    kinds: dict[str, list[tuple[str, Path]]] = {}
    for remark, where in seen.items():
        if len(where) < len(files):
            kinds.setdefault(remark.kind, []).extend((remark.text, path) for path in where)
    for kind, found in kinds.items():
        lines += _differing(kind, found, len(files))
    return lines


def _differing(kind: str, found: Sequence[tuple[str, Path]], total: int) -> Iterator[str]:
    """Yield the lines of remarks of one kind that differ between files."""
    for remark, path in found[:_EXAMPLES]:
        yield from _bullet(f"{path.name}: {remark}")
    if len(found) > _EXAMPLES:
        files = len({path for _, path in found})
        yield from _bullet(
            f"{kind}: {len(found) - _EXAMPLES} more of these, in {files} of {total} files"
        )


def _bullet(remark: str) -> list[str]:
    return _wrapped(printable(remark, 8 * WIDTH), "    ", first="  - ")


def _joint_summary(joint: JointSummary) -> list[str]:
    """Return the lines of a joint in all logs."""
    lines = [
        f"joint {joint.joint} in all logs: moves at constant speed: {joint.forward} forward,"
        f" {joint.reverse} in reverse"
    ]
    for reason, group in groupby(joint.stages, key=lambda stage: (stage.suffices, stage.reason)):
        names = ", ".join(stage.name for stage in group)
        lead = f"  {names:9} {reason[0]:8} "
        lines += _wrapped(printable(reason[1], 6 * WIDTH), " " * 20, first=lead)
    return lines


def _motionless(joints: Iterable[JointSummary]) -> list[list[str]]:
    """Return the joints without motion at constant speed, all in one line."""
    numbers = [joint.joint for joint in joints if not joint.forward and not joint.reverse]
    line = f"{_joints(numbers)} in all logs: no motion at constant speed, so nothing to pair"
    return [_wrapped(line, "  ", first="")] if numbers else []


def _wrapped(sentence: str, indent: str, *, first: str) -> list[str]:
    return textwrap.wrap(
        sentence,
        WIDTH,
        initial_indent=first,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
