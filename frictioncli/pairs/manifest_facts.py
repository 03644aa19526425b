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
