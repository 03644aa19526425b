"""Check a suggested mapping file: logs are read with it, and their moves paired."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from frictioncli import schemas, tables
from frictioncli.errors import FrictionError
from frictioncli.inspection.pair_check import segments_and_pairs
from frictioncli.logs.ingest import ingest
from frictioncli.logs.runs.discovery import discover
from frictioncli.logs.settings import IngestSettings
from frictioncli.pairs.pair_tables import read_phase_and_payload
from frictioncli.pairs.segments import without_angle
from frictioncli.pairs.settings import PairingSettings
from frictioncli.wording import count_text
from frictioncli.workfiles import RECORDINGS, SAMPLES

_MOST_BYTES = 1 << 26
"""Size of the logs that are read, at most; the first of many. [byte]"""

_ONE_SIGN = 0.9
"""Least share of half differences of one sign in a torque that bears friction."""


@dataclass(frozen=True, slots=True)
class Check:
    """What came of reading and pairing with a suggested map.

    Attributes
    ----------
    text : str
        A sentence for the user, and one in a line of its own for each joint beside whose motion
        others move.
    is_doubtful : bool
        Whether it speaks against the map.
    """

    text: str
    is_doubtful: bool


def check_by_pairing(text: str, logs: Sequence[Path], settings: IngestSettings) -> Check:
    """Read logs with a mapping file and pair their moves.

    Parameters
    ----------
    text : str
        The mapping file.
    logs : sequence of Path
        Log files, or folders of them.
    settings : IngestSettings
        Settings of the user, whose mapping file is replaced.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        map_file = folder / "channels.toml"
        map_file.write_text(text, encoding="utf-8")
        try:
            ingest(_first_files(logs), folder, replace(settings, joints=None, map_file=map_file))
            manifest = read_phase_and_payload(folder / RECORDINGS)
            samples = tables.batches(folder / SAMPLES, schemas.SAMPLES)
            if tables.facts(folder / SAMPLES).get("position") == "integrated":
                samples = map(without_angle, samples)
            _, pairs, motion = segments_and_pairs(
                samples, lambda: manifest, PairingSettings(), folder
            )
        except FrictionError as error:
            return Check(f"Checked: logs cannot be used with it: {error}", is_doubtful=True)
    others = "".join(f"\n{text}" for text in motion.texts(sorted(motion.shared)))
    if pairs.empty:
        return Check(
            "Checked: with it no move at constant speed has a counterpart in the other direction"
            f"{others}",
            is_doubtful=True,
        )
    half = pairs["half_difference"].to_numpy(float)
    same = float(np.mean(np.sign(half) == np.sign(np.median(half))))
    paired = (
        f"Checked: with it {count_text(len(half), 'pair')} of moves in both directions are found"
    )
    if same < _ONE_SIGN:
        return Check(
            f"{paired}, but half differences of torque of both signs{others}", is_doubtful=True
        )
    return Check(f"{paired}; half the difference of torque is {np.median(half):.3g}{others}", False)


def _first_files(logs: Sequence[Path]) -> list[Path]:
    """Return the first log files, as many as are read in a moment, one run at least in part."""
    chosen: list[Path] = []
    size = 0
    for run in discover(logs):
        for file in run.files:
            if chosen and size > _MOST_BYTES:
                return chosen
            chosen.append(file.path)
            size += file.path.stat().st_size
    return chosen
