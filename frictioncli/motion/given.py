"""What the manifest says of recordings: their phase and their payload."""

from pathlib import Path

import pandas as pd

from frictioncli import schemas, tables

_KEY = ["run", "recording"]
_SAID = ["phase", "payload"]


def given(path: Path) -> pd.DataFrame:
    """Return phase and payload [kg] by run and recording; missing where no manifest says so.

    Parameters
    ----------
    path : Path
        The table ``recordings``; without that file nothing is given.
    """
    if not path.exists():
        return pd.DataFrame(columns=[*_KEY, *_SAID]).set_index(_KEY)
    recordings = tables.read(path, schemas.RECORDINGS)
    return recordings.drop_duplicates(_KEY).set_index(_KEY)[_SAID]


def of_recordings(rows: pd.DataFrame, said: pd.Series) -> pd.Series:
    """Return what is said of each row's recording, with the rows' labels.

    Parameters
    ----------
    rows : DataFrame
        Rows with run and recording.
    said : Series
        A column of :func:`given`.
    """
    keys = pd.MultiIndex.from_frame(rows[_KEY])
    return pd.Series(said.reindex(keys).to_numpy(), index=rows.index, dtype=said.dtype)
