"""What becomes of real logs, as a new user would try them?

Usage: python -m tests.studies.real FOLDER [FOLDER...]

Each folder, or the one that the environment variable REAL_LOGS names, holds folders of logs; those
that ``real_cases`` knows are read as its cases, others each as one run. They are not ours and are
read in place. Each goes through ``run`` unaided, with the map that ``inspect --suggest-map``
suggests, and with a map written by hand where there is one. docs/real.md gets what came of it,
beside the figures of ``real_independent``.
"""

import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from textwrap import fill

from frictioncli.errors import FrictionError
from frictioncli.inspection.map_suggestion.suggest_map import suggested_map
from frictioncli.wording import count_text
from tests.studies.real_cases import CASES, MAPS, Case
from tests.studies.real_chain import Attempt, attempt
from tests.studies.real_independent import FIGURES
from tests.studies.real_page import without_path
from tests.studies.real_text import Tried, section, table

PAGE = Path(__file__).parents[2] / "docs" / "real.md"

_HEAD = (
    "Logs written by others, from public repositories; they are not part of this one. `make"
    " real REAL=FOLDER` runs every folder in FOLDER and writes this page: `run` unaided with"
    " default settings, then with the map that `inspect --suggest-map` suggests. For"
    " comparison, an independent script (`tests/studies/real_independent.py`), about thirty"
    " lines per set, computes half differences there and back in 5-degree bins, or least"
    " squares of all samples; it shares no code with the program. Sentences in quotation"
    " marks, on channels and on what is not determined are the program's own. Intervals of"
    " friction from pairs are those of the mean over pairs of one speed, taken as independent;"
    " those of a regression are its own. Deviation is the program's friction divided by the"
    " independent one, minus 1, at the speeds shown. The figures for each diagnosis are in"
    " [real-diagnoses.md](real-diagnoses.md)."
)

_LIMITS = (
    "No log has a known friction. The independent figures come from the same files, by people"
    " who knew the program's results; they share its columns, its half differences and any"
    " fault of the sensors. Agreement shows that nothing was lost on the way, not that the"
    " joint has this friction.",
    "The independent script has no intervals, and it averages over temperature, load and"
    " angle with other weights than the program: where friction changes with these, as in the"
    " xArm6, deviations of a few per cent are expected.",
    "There are few robots, most of them small, and few speeds. Nothing here tests friction"
    " over a wide range of speed, temperature and load at once.",
    "These logs were at hand while the program was written. The page does not show how the"
    " program does on other logs.",
    "The true cause is known of no diagnosis except for the weight in the hand of the xArm6.",
    "The judgements of refusals and results are our own, written by hand into the list of"
    " cases (`tests/studies/real_cases.py`); they may be older than the program.",
)


def cases_in(folder: Path) -> Iterator[tuple[Path, Case]]:
    """Return the cases in a folder: those known, and each other folder of it as one run."""
    known = [case for case in CASES if all((folder / one).is_dir() for one in case.folders)]
    yield from ((folder, case) for case in known)
    covered = {one.split("/")[0] for case in known for one in case.folders}
    subfolders = [one for one in sorted(folder.iterdir()) if one.is_dir()]
    for one in subfolders:
        if one.name not in covered and not one.name.startswith("."):
            yield folder, Case(name=one.name, title=one.name, folders=(one.name,))
    if not subfolders:
        yield folder.parent, Case(name=folder.name, title=folder.name, folders=(folder.name,))


def tried(case: Case, logs: Path) -> Tried:
    """Try a case in all ways."""
    paths = [logs / one for one in case.folders]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        unaided = attempt(paths, folder / "unaided")
        suggested, written = None, None
        map_file = folder / "suggested.toml"
        try:
            suggestion = suggested_map(paths)
        except FrictionError as refusal:
            suggestion = str(refusal)
        else:
            map_file.write_text(suggestion, encoding="utf-8")
            suggested = attempt(paths, folder / "suggested", map_file)
        if case.map is not None:
            written = attempt(paths, folder / "written", MAPS / case.map)
        figures = FIGURES[case.name](logs) if case.name in FIGURES else []
    return Tried(
        case=case,
        unaided=_without_path(unaided, logs),
        suggested=None if suggested is None else _without_path(suggested, logs),
        suggestion=without_path(suggestion, logs),
        written=None if written is None else _without_path(written, logs),
        beside=figures,
    )


def _without_path(one: Attempt, logs: Path) -> Attempt:
    notes = [without_path(note, logs) for note in one.notes]
    return replace(one, refusal=without_path(one.refusal, logs), notes=notes)


def page(results: Sequence[Tried]) -> str:
    """Return the whole page."""
    sections = [section(one) for one in results]
    head = f"# Real logs\n\n{fill(_HEAD, 120, break_on_hyphens=False)}"
    limits = [f"- {fill(one, 118, subsequent_indent='  ')}" for one in _LIMITS]
    end = "\n".join(["## What this page cannot tell", *limits])
    return "\n\n".join([head, table(results), counts(results), *sections, end]) + "\n"


def counts(results: Sequence[Tried]) -> str:
    """Return in how many folders there is a result, unaided and with the suggested map."""
    unaided = sum(not one.unaided.refusal for one in results)
    helped = sum(bool(one.unaided.refusal) and not one.shown.refusal for one in results)
    return (
        f"Of {count_text(len(results), 'folder')} {unaided} end in a result unaided, {helped} more"
        f" with the suggested map, and {len(results) - unaided - helped} in a refusal. A result is"
        " not always right, nor a refusal wrong: see each."
    )


def main(arguments: Sequence[str]) -> None:
    """Make the page from all folders given."""
    given = [one for one in arguments or [os.environ.get("REAL_LOGS", "")] if one]
    folders = [Path(one).resolve() for one in given]
    missing = [one for one, path in zip(given, folders, strict=True) if not path.is_dir()]
    if missing or not folders:
        sys.exit(f"real: {', '.join(missing) or 'no folder given'}: expected folders of logs")
    results = []
    for folder in folders:
        for logs, case in cases_in(folder):
            results.append(tried(case, logs))
            print(case.name, flush=True)
    PAGE.write_text(page(results), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
