"""Separation of friction and load: ``separate``."""

import statistics
from collections.abc import Collection, Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import pyarrow as pa
import pyarrow.compute as pc

from frictioncli import schemas, tables
from frictioncli.errors import NotEnoughData
from frictioncli.model.settings import LEAST_PAIRS
from frictioncli.pairs.pair_tables import read_phase_and_payload
from frictioncli.pairs.separation import (
    HalfDifferences,
    TorqueRanges,
    half_differences,
    separation_text,
    signs_of,
)
from frictioncli.pairs.separation import separate as separate_pairs
from frictioncli.pairs.settings import PairingSettings, SeparationSettings
from frictioncli.pairs.two_loads import loads_in_turns
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.stages.prefetch import prefetch
from frictioncli.stages.stage import StageResult, existing, stage
from frictioncli.wording import count_text
from frictioncli.workfiles import PAIRS, RECORDINGS, SAMPLES, TORQUES

if TYPE_CHECKING:
    from frictioncli.regression.separation import RegressedTorques

PAIRED, REGRESSED = "pairs", "regression"

_MANY_PAIRS = 30
"""Pairs from which they are taken, whatever share of the motion they hold."""

_LEAST_SHARE = 0.1
"""Share of the samples in motion that fewer pairs hold at least; else a regression is tried. It
uses most of them, and is refused where it does not tell friction from the rest."""


_OTHER_SCALE = 4.0
"""Mean friction of a run relative to that of the other runs from which on it is told: speeds and
temperatures rarely make as much of a difference."""

_FEW_PAIRS = 6
"""Pairs of a run from which its mean friction is compared."""


@stage
def separate(
    work: Path, settings: SeparationSettings | None = None, *, bin_width: float | None = None
) -> StageResult:
    """Separate friction torque from load torque: ``torques.parquet``.

    By equation (8) where a joint has pairs of moves, else by regression of all its motion; the fact
    ``separated_by`` of the table says which.

    Parameters
    ----------
    work : Path
        Work folder with ``pairs.parquet``, or ``samples.parquet``, or both.
    settings : SeparationSettings, optional
        Way of the separation, and sign of friction.
    bin_width : float, optional
        Width of the regression's angle bins; that of the pairs where not given. [deg]

    Raises
    ------
    NotEnoughData
        If runs of a joint contradict each other in the sign of friction, or motion does not
        suffice for a regression.
    TableError
        If a table is missing or damaged.
    """
    settings = settings or SeparationSettings()
    pairs = work / PAIRS
    alone = settings.by == REGRESSED or (
        settings.by == "auto" and not pairs.exists() and (work / SAMPLES).exists()
    )
    if alone:
        return _write(work, settings, {}, _regressed(work, settings, bin_width), [])
    found = half_differences(tables.batches(pairs, schemas.PAIRS))
    few = {} if settings.by == PAIRED else _with_few_pairs(work, found)
    regressed, texts = None, []
    if few:
        told = "; ".join(few.values())
        try:
            regressed = _regressed(work, settings, bin_width, joints=few)
            texts.append(f"{told}: by regression")
        except NotEnoughData as fault:
            texts.append(f"{told}, and no regression: {fault}")
    others = {
        joint: values
        for joint, values in found.items()
        if regressed is None or joint not in regressed.signs
    }
    return _write(work, settings, others, regressed, [*texts, *_of_other_scale(others)])


def _of_other_scale(found: Mapping[int, Mapping[str, HalfDifferences]]) -> Iterator[str]:
    """Yield which runs have many times the usual friction, of two runs that of the first."""
    for joint, runs in found.items():
        means = {run: abs(one.mean) for run, one in runs.items() if one.count >= _FEW_PAIRS}
        if len(means) < 2:
            continue
        first, *_ = means.values()
        usual = first if len(means) == 2 else statistics.median(means.values())
        for run, mean in means.items():
            times = max(mean, usual) / max(min(mean, usual), 1e-12)
            if times >= _OTHER_SCALE:
                yield (
                    f"joint {joint}: warning: friction of run {run} is {times:.2g} times"
                    f" {'higher' if mean > usual else 'lower'} than that of other runs; see whether"
                    " its torque has another unit or scale before it is used with them"
                )


def _with_few_pairs(
    work: Path, found: Mapping[int, Mapping[str, HalfDifferences]]
) -> dict[int, str]:
    """Return the joints that a regression may tell more of, and why, if there are samples.

    They have too few pairs for a fit, or not many, which hold next to nothing of their motion.
    """
    if not (work / SAMPLES).exists():
        return {}
    shares = tables.facts(work / PAIRS).get("in_pairs", {})
    told = {}
    for joint, runs in found.items():
        count, share = sum(one.count for one in runs.values()), shares.get(str(joint), 1.0)
        if count < LEAST_PAIRS:
            told[joint] = f"too few pairs ({count_text(count, 'pair')} of joint {joint})"
        elif count < _MANY_PAIRS and share < _LEAST_SHARE:
            told[joint] = (
                f"{count_text(count, 'pair')} of joint {joint} hold {100 * share:.0f} %"
                " of its motion"
            )
    return told


def _regressed(
    work: Path,
    settings: SeparationSettings,
    bin_width: float | None,
    joints: Collection[int] | None = None,
) -> "RegressedTorques":
    """Return the torques of joints by regression of all samples of the work folder."""
    # it imports scipy, which a separation of pairs does not need
    from frictioncli.pairs.segments import without_angle
    from frictioncli.regression.separation import torques_by_regression

    source, pairs = work / SAMPLES, work / PAIRS
    if bin_width is None:
        known = tables.facts(pairs).get("bin_width") if pairs.exists() else None
        bin_width = float(known or PairingSettings().bin_width)
    facts = tables.facts(source)

    def read() -> Iterator[pa.RecordBatch]:
        samples = prefetch(tables.batches(source, schemas.SAMPLES))
        return map(without_angle, samples) if facts.get("position") == "integrated" else samples

    return torques_by_regression(
        read,
        bin_width=bin_width,
        sign=settings.sign,
        joints=joints,
        manifest=read_phase_and_payload(work / RECORDINGS),
        units=(str(facts.get("torque_unit", "N·m")), "N·m"),
        doubtful=settings.by == REGRESSED,
        urdf=settings.urdf,
    )


def _write(
    work: Path,
    settings: SeparationSettings,
    paired: Mapping[int, Mapping[str, HalfDifferences]],
    regressed: "RegressedTorques | None",
    texts: list[str],
) -> StageResult:
    """Write the table of torques from pairs of some joints and regressions of others."""
    source = work / PAIRS
    signs = signs_of(paired, settings.sign)
    by_pairs = dict(signs)
    facts = tables.facts(source if paired else work / SAMPLES)
    inputs = existing(*([source] if paired else []))
    if regressed is not None:
        signs |= regressed.signs
        inputs += existing(work / SAMPLES, work / RECORDINGS)
        facts["regression"] = {str(joint): one for joint, one in regressed.facts.items()}
        facts |= {"arm": dict(regressed.arm)} if regressed.arm is not None else {}
        if not paired:
            facts |= {"samples": regressed.samples, "dropped": regressed.dropped}
        texts += regressed.texts
    facts["sign"] = {str(joint): value for joint, value in signs.items()}
    facts["separated_by"] = {
        str(joint): PAIRED if joint in by_pairs else REGRESSED for joint in signs
    }
    unit = str(facts.get("torque_unit", "N·m"))
    pairs = tables.batches(source, schemas.PAIRS) if by_pairs else ()
    in_turns = loads_in_turns(pairs, by_pairs, unit)
    if in_turns:
        facts["two_loads"] = {str(joint): text for joint, text in in_turns.items()}
    provenance = Provenance("separate", _told(settings), input_hashes(inputs))
    ranges = TorqueRanges()
    with tables.TableWriter(work / TORQUES, schemas.TORQUES, provenance) as torques:
        for rows in ranges.update(_rows(source, by_pairs, regressed)):
            torques.write(rows)
        facts |= {"load_unit": "N·m"} if ranges.load_is_measured else {}
        torques.facts = facts
    text = separation_text(ranges, by_pairs, facts, given=settings.sign is not None)
    texts += [f"joint {joint}: warning: {text}" for joint, text in in_turns.items()]
    return StageResult(work / TORQUES, "\n".join([*([text] if text else []), *texts]))


def _told(settings: SeparationSettings) -> dict[str, object]:
    """Return the settings for the provenance; a path as text."""
    urdf = None if settings.urdf is None else str(settings.urdf)
    return asdict(settings) | {"urdf": urdf}


def _rows(
    source: Path, by_pairs: Mapping[int, int], regressed: "RegressedTorques | None"
) -> Iterator[pa.RecordBatch]:
    """Yield the rows of pairs, then those of regressions."""
    if by_pairs:
        for batch in prefetch(tables.batches(source, schemas.PAIRS)):
            own = batch
            if regressed is not None:
                numbers = pa.array(list(by_pairs), type=pa.int16())
                own = batch.filter(pc.is_in(batch.column("joint"), numbers))
            if own.num_rows:
                yield separate_pairs(own, by_pairs)
    if regressed is not None:
        yield from pa.Table.from_pandas(regressed.table, preserve_index=False).to_batches()
