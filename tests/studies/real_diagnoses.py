"""What does the program say of real logs that nobody here wrote?

Usage: python -m tests.studies.real_diagnoses FOLDER [NAME...]

FOLDER, or the environment variable REAL_LOGS, holds the logs in the folders that
``real_cases`` lists; they are not ours and are read in place. Each case goes through the chain up
to the diagnosis. docs/real-diagnoses.md gets what the program says, or its refusal in its own
words, and one figure per joint that is diagnosed. With names only these cases are made anew; the
others keep their text.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

from frictioncli import tables
from frictioncli.diagnosis.documents.reload import Reloaded, read_documents, reload
from frictioncli.errors import FrictionError
from frictioncli.logs.settings import IngestSettings
from frictioncli.model.document import read_models
from frictioncli.schemas import TORQUES as TORQUES_TABLE
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from frictioncli.workfiles import MODEL, TORQUES
from tests.studies.real_cases import CASES, MAPS, Case
from tests.studies.real_figure import draw
from tests.studies.real_page import joint_text, refusal_text, without_path, write_section

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "real-diagnoses.md"


def section_of(case: Case, logs: Path) -> str:
    """Return the section on a case; the figures are written beside the page."""
    for old in PAGE.parent.glob(f"real-{case.name}-*.png"):
        old.unlink()
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder) / "work"
        begin = time.process_time()
        fault = analysed(case, logs, work)
        seconds = time.process_time() - begin
        if fault:
            return refusal_text(without_path(fault, logs))
        torques = tables.read(work / TORQUES, TORQUES_TABLE)
        nouns = {model.joint: model.row_noun for model in read_models(work / MODEL)}
        texts = []
        for joint, (document, extended) in sorted(read_documents(work).items()):
            rows = torques[torques["joint"] == joint]
            found = reload(rows, document, extended)
            texts.append(joint_text(case, found, rows, figure_of(case, found), nouns[joint]))
    return "\n\n".join([*texts, f"{seconds:.0f} s of processor for the chain up to the diagnosis."])


def analysed(case: Case, logs: Path, work: Path) -> str:
    """Run the chain up to the diagnosis; return the program's refusal, or nothing."""
    settings = IngestSettings(
        map_file=None if case.map is None else MAPS / case.map, joints=case.joints
    )
    try:
        ingest([logs / one for one in case.folders], work, settings)
        for stage in (pair, separate, fit, diagnose):
            stage(work)
    except FrictionError as refusal:
        return str(refusal)
    return ""


def figure_of(case: Case, found: Reloaded) -> str:
    """Draw the figure that defends a diagnosis; return its file name."""
    name = f"real-{case.name}-{found.document.joint}.png"
    draw(found).savefig(PAGE.parent / name, dpi=90, metadata={"Software": None})
    return name


def main(arguments: list[str]) -> None:
    """Make the sections of all cases, or of those named."""
    given = arguments[:1] or [os.environ.get("REAL_LOGS", "")]
    logs = Path(given[0])
    if not given[0] or not logs.is_dir():
        sys.exit(
            f"real_diagnoses: {given[0] or 'no folder given'}: expected the folder of the logs"
        )
    wanted = arguments[1:]
    for case in CASES:
        if wanted and case.name not in wanted:
            continue
        write_section(PAGE, case, section_of(case, logs.resolve()))
        print(case.name, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
