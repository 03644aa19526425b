"""Effects planted in the logs of a joint, and what the diagnosis says of them: ``challenge``."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from frictioncli import tables
from frictioncli.challenge.pictures import write_pictures
from frictioncli.challenge.rows import (
    ChallengeTable,
    row_as_logged,
    row_of_trial,
    row_refused,
)
from frictioncli.challenge.search_size import search_size
from frictioncli.challenge.settings import ChallengeSettings
from frictioncli.challenge.subject import Subject, read_subjects
from frictioncli.challenge.text import challenge_text
from frictioncli.challenge.trial import Planter
from frictioncli.challenge_schema import GIVEN, SEARCH, SHARE, Row
from frictioncli.diagnosis.documents.document import read_diagnoses
from frictioncli.documents import to_json
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.logs.runs.discovery import Logs
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.simulator.planted.catalogue import EFFECTS, RequestedEffect, requested_effects
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.run import pair_and_separate
from frictioncli.stages.settings import RunSettings
from frictioncli.stages.stage import StageResult, existing
from frictioncli.workfiles import CHALLENGE, DIAGNOSIS, MODEL, RAMPS, SAMPLES, TORQUES
from frictioncli.workfolder import locked

Progress = Callable[[str], None]
"""Called with what is being done."""


def challenge(
    logs: Logs,
    work: Path,
    settings: RunSettings | None = None,
    options: ChallengeSettings | None = None,
    progress: Progress = lambda text: None,
) -> StageResult:
    """Plant effects into logs and diagnose them before and after: ``challenge.parquet``.

    Beside it the folder ``challenge`` gets a picture of each effect. Each row is written when it is
    known. A call that was killed goes on where it stopped, if logs and settings are the same; rows
    of other effects on the same data stay.

    Parameters
    ----------
    logs : Logs
        Log files or folders, each folder one run; or the runs by name.
    work : Path
        Work folder; its tables up to the diagnosis are replaced.
    settings : RunSettings, optional
        Settings of all stages.
    options : ChallengeSettings, optional
        What is planted.
    progress : callable, optional
        Called with what is being done.

    Returns
    -------
    StageResult
        The table, and a summary.

    Raises
    ------
    FrictionError
        If the logs cannot be diagnosed as they are, or an effect is unknown.
    """
    settings, options = settings or RunSettings(), options or ChallengeSettings()
    requests = _requests(options.effects)
    with locked(work):
        progress("the log as it is")
        ingest(logs, work, settings.ingest)
        pair_and_separate(work, settings)
        fit(work, settings.fit)
        diagnose(work, settings.diagnosis)
        table = _table(work, settings)
        table.take_up()
        for subject in read_subjects(work):
            # it may have been taken up
            if not any(row["joint"] == subject.joint for row in table.rows):
                table.add(row_as_logged(subject))
            table.set_claimed(subject.joint, subject.diagnosis.detectable)
            planter = Planter(subject, work, settings)
            _Challenge(subject, planter, table, options, progress).run(requests)
        table.write()
        folder = write_pictures(table.path)
    text = f"{challenge_text(table.rows)}\npictures: {folder}"
    return StageResult(table.path, text)


def _requests(texts: Sequence[str]) -> tuple[RequestedEffect, ...]:
    """Return the effects that are asked for; one may come in several sizes."""
    requests = tuple(dict.fromkeys(one for text in texts for one in requested_effects((text,))))
    for one in requests:
        if one.history:
            raise OptionError(
                f"--effect {one.name}@{one.history}: expected NAME or NAME:SIZE; planted"
                " changes are permanent"
            )
    return requests


def _table(work: Path, settings: RunSettings) -> ChallengeTable:
    """Return the table of a work folder, still without rows."""
    inputs = existing(*(work / name for name in (SAMPLES, RAMPS, TORQUES, MODEL, DIAGNOSIS)))
    facts = tables.facts(work / TORQUES)
    return ChallengeTable(
        path=work / CHALLENGE,
        provenance=Provenance(
            "challenge", {"as_logged": _said_as_logged(work)}, input_hashes(inputs)
        ),
        facts={"torque_unit": facts.get("torque_unit", "N·m")},
    )


def _said_as_logged(work: Path) -> str:
    """Return the SHA-256 of the diagnoses without the sizes that they claim.

    No trial depends on these: where only they change, its rows stay.
    """
    said = [
        to_json(msgspec.structs.replace(one, detectable={}, undetectable={}))
        for one in read_diagnoses(work / DIAGNOSIS).values()
    ]
    return hashlib.sha256("".join(said).encode()).hexdigest()


@dataclass(slots=True)
class _Challenge:
    """All trials of one joint."""

    subject: Subject
    planter: Planter
    table: ChallengeTable
    options: ChallengeSettings
    progress: Progress

    def run(self, requests: Sequence[RequestedEffect]) -> None:
        """Plant what is asked for; without requests all that the log can show."""
        detectable = self.subject.diagnosis.detectable
        asked = requests or [
            RequestedEffect(name, None)
            for name, size in detectable.items()
            if size is not None and name in EFFECTS
        ]
        seeds = range(self.options.seed, self.options.seed + self.options.draws)
        tries = [(request, seed) for request in asked for seed in seeds]
        for number, (request, seed) in enumerate(tries, start=1):
            self._say(request.name, f"{number} of {len(tries)}")
            if request.size is None:
                channel = self.subject.channel_of(request.name)
                size = self.options.share / 100.0 * self.subject.reference(channel)
                self._trial(request.name, seed, SHARE, size)
            else:
                self._trial(request.name, seed, GIVEN, request.size)
        wanted = self.options.search
        if not (not requests if wanted is None else wanted):
            return
        searches = dict.fromkeys((request.name, seed) for request, seed in tries)
        for number, (name, seed) in enumerate(searches, start=1):
            self._search(name, seed, f"smallest size, {number} of {len(searches)}")

    def _say(self, name: str, what: str) -> None:
        self.progress(f"joint {self.subject.joint}: {name}, {what}")

    def _trial(self, name: str, seed: int, purpose: str, size: float) -> Row:
        """Return the row of a trial, made before or now."""
        subject = self.subject
        known = self.table.of(subject.joint, name, seed, size)
        if known is not None:
            return known
        try:
            trial = self.planter.trial(name, seed, size, usual=purpose == SHARE)
        except NotEnoughData as fault:
            return self.table.add(row_refused(subject, name, seed, purpose, size, str(fault)))
        return self.table.add(row_of_trial(subject, name, seed, purpose, size, trial))

    def _search(self, name: str, seed: int, what: str) -> None:
        """Search the least size of an effect that is found, unless it is known or there already."""
        subject = self.subject
        known = {one for cause in subject.diagnosis.named_causes for one in cause.effects}
        if name in known or self.table.is_searched(subject.joint, name, seed):
            return
        whole = subject.reference(subject.channel_of(name))
        claimed = subject.diagnosis.detectable.get(name)
        start = claimed or self.options.share / 100.0 * whole

        def found(size: float) -> bool | None:
            self._say(name, f"{what}: {size:.3g}")
            row = self._trial(name, seed, SEARCH, size)
            if row["status"] != "done":
                return None
            return bool(row["right_in_set"])

        result = search_size(found, start, least=start / 16.0, most=max(whole, start))
        self.table.set_found(subject.joint, name, seed, result)
