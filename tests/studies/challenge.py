"""Which effects does the diagnosis find that are planted in logs, and which names are wrong?

Usage: python -m tests.studies.challenge FOLDER WORK [NAME...] [--search] [--draws=NUMBER]

FOLDER, or the environment variable REAL_LOGS, holds the real logs that ``real_cases`` lists; those
of ``sample_logs`` come first, as ``kr10``. Each effect that a log can show is planted at 10 % of
the mean friction; with ``--search`` the least size that is found is searched for, too, and with
``--draws`` that of several shapes. WORK keeps the tables, so that a call that was stopped goes on.
docs/challenge.md gets the results of all cases whose tables are in WORK.
"""

import sys
from pathlib import Path

from frictioncli.challenge.challenge import challenge
from frictioncli.challenge.settings import ChallengeSettings
from frictioncli.errors import FrictionError
from frictioncli.logs.settings import IngestSettings
from frictioncli.stages.settings import RunSettings
from tests.studies.challenge_page import write_page
from tests.studies.real_cases import CASES, MAPS

ROOT = Path(__file__).parents[2]
SAMPLES = "kr10"


def logs_of(name: str, real: Path) -> tuple[list[Path], IngestSettings]:
    """Return the logs of a case, and how they are read."""
    if name == SAMPLES:
        return [ROOT / "sample_logs" / "kr10"], IngestSettings()
    case = next(one for one in CASES if one.name == name)
    map_file = None if case.map is None else MAPS / case.map
    settings = IngestSettings(map_file=map_file, joints=case.joints)
    return [real / folder for folder in case.folders], settings


def main(arguments: list[str]) -> None:
    """Challenge the logs named, or all, and write the page."""
    search = "--search" in arguments
    draws = [int(one.removeprefix("--draws=")) for one in arguments if one.startswith("--draws=")]
    folder, store, *wanted = (one for one in arguments if not one.startswith("--"))
    real, work = Path(folder).resolve(), Path(store)
    for name in wanted or [SAMPLES, *(one.name for one in CASES)]:
        logs, reading = logs_of(name, real)
        try:
            result = challenge(
                logs,
                work / name,
                RunSettings(ingest=reading),
                ChallengeSettings(search=search, draws=draws[-1] if draws else 1),
                progress=lambda text, name=name: print(f"{name}: {text}", flush=True),
            )
            print(result, flush=True)
        except FrictionError as refusal:
            print(f"{name}: {refusal}", flush=True)
    write_page(work)


if __name__ == "__main__":
    main(sys.argv[1:])
