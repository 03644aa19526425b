"""Dates in the cells of text logs."""

import numpy as np

from frictioncli.arrays import Array


def seconds_since_1970(texts: list[str]) -> Array:
    """Return ISO 8601 dates as time since 1970 [s]; NaN where there is none."""
    import pandas as pd  # takes longer to import than most logs to read

    cleaned = pd.Series([text.strip().replace(",", ".") for text in texts], dtype="str")
    dates = pd.to_datetime(cleaned, format="ISO8601", errors="coerce", utc=True)
    # coarse: a year 1 must not run over in nanoseconds
    epoch = pd.Timestamp("1970-01-01", tz="UTC").as_unit("s")
    seconds = (dates - epoch) / pd.Timedelta(seconds=1)
    return np.asarray(seconds.to_numpy(dtype=float), np.float64)
