"""Figures and page: ``report``."""

import re
from pathlib import Path

from frictioncli.files import check_own
from frictioncli.stages.stage import StageResult, stage
from frictioncli.workfiles import REPORT

_OWN = re.compile(r"index\.html|[^/]+\.(svg|png)|data/[^/]+\.(csv|parquet|json|src|dat|script)")


@stage
def report(work: Path, *, png: bool = False) -> StageResult:
    """Draw the figures and write the page: ``report/index.html``.

    Parameters
    ----------
    work : Path
        Work folder with ``torques.parquet`` and ``model.json``; other tables are shown if they
        exist.
    png : bool
        Whether each figure is also written as PNG.

    Raises
    ------
    TableError
        If a table or the model is missing or damaged.
    FrictionError
        If the folder ``report`` holds a file that no report is made of.
    """
    from frictioncli.report.page import write_report

    check_own(work / REPORT, lambda name: _OWN.fullmatch(name) is not None)
    page = write_report(work, png=png)
    return StageResult(page, str(page))
