"""What is looked at: ``report``."""

from pathlib import Path

from frictioncli.stages.stage import Done, stage


@stage
def report(work: Path) -> Done:
    """Draw the figures and write the page: ``report/index.html``."""
    from frictioncli.report.page import write_report

    page = write_report(work)
    return Done(page, str(page))
