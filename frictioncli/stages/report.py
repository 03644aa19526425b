"""Figures and page: ``report``."""

from pathlib import Path

from frictioncli.stages.stage import StageResult, stage


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
    """
    from frictioncli.report.page import write_report

    page = write_report(work, png=png)
    return StageResult(page, str(page))
