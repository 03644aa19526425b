"""Pictures of planted effects as files: one per joint and effect."""

from pathlib import Path

import pandas as pd

from frictioncli import tables
from frictioncli.challenge_schema import CHALLENGE
from frictioncli.files import atomic_write

FOLDER = "challenge"


def write_pictures(table: Path) -> Path:
    """Draw each planted effect as SVG and PNG into the folder ``challenge`` beside the table.

    An earlier folder is replaced.

    Parameters
    ----------
    table : Path
        ``challenge.parquet``.

    Returns
    -------
    Path
        The folder.
    """
    # drawing needs matplotlib, which nothing else here does
    from frictioncli.report.challenge_figure import challenge_figure
    from frictioncli.report.figure_files import png, svg, svg_file
    from frictioncli.report.style import style_context

    rows = tables.read(table, CHALLENGE)
    several = len(rows["joint"].unique()) > 1
    folder = table.with_name(FOLDER)
    with atomic_write(folder) as draft:
        draft.mkdir()
        for (joint, effect), own in rows[rows["purpose"] != "as_logged"].groupby(
            ["joint", "effect"], sort=False
        ):
            if not _drawable(own):
                continue
            name = f"joint{joint}-{effect}" if several else str(effect)
            with style_context(name):
                figure = challenge_figure(own)
                element = svg(figure, name, f"probability that {effect} is named, against its size")
                (draft / f"{name}.svg").write_text(
                    svg_file(element), encoding="utf-8", newline="\n"
                )
                (draft / f"{name}.png").write_bytes(png(figure))
    return folder


def _drawable(rows: pd.DataFrame) -> bool:
    """Return whether a trial was diagnosed, and what was planted was not there already."""
    done = rows[rows["status"] == "done"]
    return len(done) > 0 and not bool(done["already"].any())
