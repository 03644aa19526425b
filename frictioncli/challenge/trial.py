"""One trial: an effect of one size in the samples of a log, and the diagnosis of that."""

import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd

from frictioncli import schemas, tables
from frictioncli.arrays import Array
from frictioncli.challenge.planting import planted_samples
from frictioncli.challenge.shapes import drawn_effect
from frictioncli.challenge.subject import ROW, Subject
from frictioncli.diagnosis.documents.document import DiagnosisDocument, read_diagnoses
from frictioncli.errors import NotEnoughData
from frictioncli.files import DRAFT_PREFIX
from frictioncli.provenance import Provenance
from frictioncli.simulator.planted.catalogue import EFFECTS
from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.fit import fit
from frictioncli.stages.run import pair_and_separate
from frictioncli.stages.settings import RunSettings
from frictioncli.workfiles import DIAGNOSIS, RECORDINGS, SAMPLES, TORQUES

_TOLERANCE = 0.02
"""Relative error at which an effect has the size that was asked for."""

_MOST_ATTEMPTS = 8

_NEAR_TURN = 20.0
"""Distance from the end of a stroke within which a size near reversals is taken. [deg]"""

_CLOSE = 10.0
"""Greatest change of the magnitude from one attempt to the next."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """A diagnosed log with a planted effect.

    Attributes
    ----------
    size : float
        RMS of what the effect adds to the pairs and angle bins of the runs seen, in the channel
        where it shows most. [unit of the channel]
    channel : {"friction", "load"}
        That channel.
    diagnosis : DiagnosisDocument
        The diagnosis.
    seconds : float
        Processor time. [s]
    """

    size: float
    channel: str
    diagnosis: DiagnosisDocument
    seconds: float


@dataclass(slots=True)
class Planter:
    """Plants effects into a joint and diagnoses it; remembers magnitudes that gave a size.

    Attributes
    ----------
    subject : Subject
        The joint as it was logged.
    work : Path
        Its work folder; trials are made in a temporary folder inside.
    settings : RunSettings
        Settings of all stages.
    """

    subject: Subject
    work: Path
    settings: RunSettings
    _known: dict[tuple[str, int], tuple[float, float]] = field(default_factory=dict)

    def trial(self, name: str, seed: int, size: float, *, usual: bool = False) -> Trial:
        """Plant an effect and diagnose the log.

        Parameters
        ----------
        name : str
            The effect.
        seed : int
            Seed of its shape.
        size : float
            Size to plant. [unit of its channel]
        usual : bool
            Whether an effect that shows after reversals has its size there instead of everywhere.

        Raises
        ------
        NotEnoughData
            If these data cannot show the effect in this size, or refuse a diagnosis with it.
        """
        begin = time.process_time()
        effect = drawn_effect(name, self.subject.scale, seed)
        near_turn = usual and effect.definition.at_reversal
        with self._folder() as folder:
            found, channel = self._sized(
                folder, effect, seed, size, near_turn=near_turn, at_most=usual
            )
            fit(folder, self.settings.fit)
            diagnose(folder, self.settings.diagnosis, sizes=False)
            diagnosis = read_diagnoses(folder / DIAGNOSIS)[self.subject.joint]
        return Trial(
            size=found,
            channel=channel,
            diagnosis=diagnosis,
            seconds=time.process_time() - begin,
        )

    def added_torque(self, name: str, seed: int, size: float) -> tuple[Array, Array, pd.DataFrame]:
        """Return what an effect of a size adds to the pairs, without a diagnosis.

        Parameters
        ----------
        name : str
            The effect.
        seed : int
            Seed of its shape.
        size : float
            Its size. [unit of its channel]

        Returns
        -------
        friction, load : ndarray, shape (rows,)
            What it adds in each channel. [unit of the channel]
        rows : DataFrame
            Pairs and angle bins of the runs seen.

        Raises
        ------
        NotEnoughData
            If these data cannot show the effect in this size.
        """
        effect = drawn_effect(name, self.subject.scale, seed)
        with self._folder() as folder:
            self._sized(folder, effect, seed, size, near_turn=False, at_most=True)
            return self._added(folder)

    def _sized(
        self,
        folder: Path,
        effect: PlantedEffect,
        seed: int,
        size: float,
        *,
        near_turn: bool,
        at_most: bool,
    ) -> tuple[float, str]:
        """Write the torques with an effect of a size; return its size over all pairs, and where.

        With ``at_most`` one that cannot be that large is as large as it can be.
        """
        most = effect.definition.most
        known = self._known.get((effect.name, seed))
        magnitude = size * known[0] / known[1] if known else self._guess(effect, size)
        for _ in range(_MOST_ATTEMPTS):
            magnitude = min(magnitude, most)
            self._write(folder, effect.scaled(magnitude))
            pair_and_separate(folder, self._with_sign())
            friction, load, rows = self._added(folder)
            channel = self._channel(effect.name, friction, load)
            torque = friction if channel == "friction" else load
            whole = _rms(torque)
            counted = _rms(torque[_near_turns(rows)]) if near_turn else whole
            if not counted > 0.0:
                break
            self._known[effect.name, seed] = (magnitude, whole)
            if abs(counted / size - 1.0) < _TOLERANCE:
                return whole, channel
            if magnitude == most and counted < size:
                if at_most:
                    return whole, channel
                break
            magnitude *= float(np.clip(size / counted, 1.0 / _CLOSE, _CLOSE))
        raise NotEnoughData(
            f"{effect.name}: these data cannot show it at a size of {size:.3g}; it adds"
            f" {counted:.3g} to the pairs"
        )

    def _guess(self, effect: PlantedEffect, size: float) -> float:
        """Return a magnitude that gives about the size, from what samples in motion gain."""
        torques = []
        for state in self.subject.states:
            added = effect.scaled(1e-3).torque(state)
            moving = np.abs(state.direction) == 1.0
            both = np.abs(added.friction) + np.abs(added.load) + np.zeros_like(state.position)
            torques.append(both[moving])
        rms = _rms(np.concatenate(torques))
        if not rms > 0.0:
            raise NotEnoughData(f"{effect.name}: these data cannot show it: it adds no torque")
        return 1e-3 * size / rms

    def _with_sign(self) -> RunSettings:
        """Return the settings with the sign of friction that the log as it is has."""
        return replace(
            self.settings,
            separation=replace(self.settings.separation, sign=self.subject.model.sign),
        )

    def _write(self, folder: Path, effect: PlantedEffect) -> None:
        samples = planted_samples(
            self.subject.samples,
            self.subject.states,
            effect,
            self.subject.model.sign,
            self.subject.timing,
        )
        facts = tables.facts(self.work / SAMPLES)
        provenance = Provenance("challenge", effect.truth(), {})
        tables.write(folder / SAMPLES, samples, schemas.SAMPLES, provenance, facts)

    def _added(self, folder: Path) -> tuple[Array, Array, pd.DataFrame]:
        """Return what pairs and angle bins of the runs seen gained in friction and in load."""
        rows = tables.read(folder / TORQUES, schemas.TORQUES)
        rows = rows[rows["joint"] == self.subject.joint]
        both = self.subject.torques.merge(rows, on=ROW, suffixes=("", "_planted"))
        seen = both[both["run"].isin(self.subject.diagnosis.runs)]
        friction, load = (
            (seen[f"{name}_planted"] - seen[name]).to_numpy(float)
            for name in ("friction_torque", "load_torque")
        )
        return friction, load, seen

    def _channel(self, name: str, friction: Array, load: Array) -> str:
        if EFFECTS[name].listed:
            return self.subject.channel_of(name)
        return "friction" if _rms(friction) >= _rms(load) else "load"

    @contextmanager
    def _folder(self) -> Iterator[Path]:
        """Yield a temporary work folder that holds what is known of the recordings."""
        # the lock of the work folder removes it after a killed call
        folder = Path(tempfile.mkdtemp(prefix=DRAFT_PREFIX, dir=self.work))
        try:
            if (self.work / RECORDINGS).exists():
                shutil.copyfile(self.work / RECORDINGS, folder / RECORDINGS)
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def _near_turns(rows: pd.DataFrame) -> Array:
    """Return which angle bins lie near an end of the stroke of their pair."""
    angles = rows.groupby(["run", "pair"])["position"]
    low, high = angles.transform("min"), angles.transform("max")
    position = rows["position"]
    near = (position - low <= _NEAR_TURN) | (high - position <= _NEAR_TURN)
    return near.to_numpy(bool)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else 0.0
