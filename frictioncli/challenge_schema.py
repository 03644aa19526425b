"""Schema of the table of planted effects."""

from typing import Any

import pyarrow as pa

from frictioncli.schemas import Column, Table

_TEXT = pa.string()
_LABEL = pa.dictionary(pa.int32(), pa.string())
_REAL = pa.float64()
_COUNT = pa.int64()
_FLAG = pa.bool_()

_IN_UNIT = "torque unit"


def _nullable(name: str, kind: pa.DataType, unit: str, description: str) -> Column:
    return Column(name, kind, unit, description, nullable=True)


CHALLENGE = Table(
    "challenge",
    "effect planted in a log at one size",
    (
        Column("joint", pa.int16(), "", "joint number, from 1"),
        Column("effect", _LABEL, "", "what was planted; none: the log as it is"),
        Column("seed", _COUNT, "", "seed of the shape of its law"),
        Column("purpose", _LABEL, "", "as_logged, given, share or search: why this size"),
        Column("status", _LABEL, "", "done, or cannot: these data cannot show it, or refuse it"),
        Column("message", _TEXT, "", "why it cannot"),
        Column("unit", _LABEL, "", "unit of its sizes"),
        _nullable("asked", _REAL, "unit", "size that was asked for"),
        _nullable("size", _REAL, "unit", "RMS of what it adds to the pairs of the runs seen"),
        _nullable("share", _REAL, "", "size over the mean friction, or RMS load in a load channel"),
        _nullable("claimed", _REAL, "unit", "size that the diagnosis of the log calls detectable"),
        _nullable("verdict", _LABEL, "", "verdict of the diagnosis with it"),
        Column("names", _TEXT, "", "names given, sets by or, causes by semicolon"),
        Column("structure", _TEXT, "", "axes of structure without a name, and its channel"),
        Column("already", _FLAG, "", "the log as it is has this name, or structure, already"),
        Column("right_in_set", _FLAG, "", "it is named, alone or among others"),
        Column("right_alone", _FLAG, "", "it is named alone"),
        Column("wrong", _TEXT, "", "names that are neither right nor those of the log as it is"),
        _nullable("gain", _REAL, "", "share of the misfit that the extended model removes"),
        _nullable("gain_low", _REAL, "", "gain: lower end of its 95 % interval"),
        _nullable("gain_high", _REAL, "", "gain: upper end of its 95 % interval"),
        _nullable("gain_basis", _LABEL, "", "new_run, or within_run where the gain is optimistic"),
        _nullable("rmse_before", _REAL, _IN_UNIT, "misfit of the base model"),
        _nullable("rmse_after", _REAL, _IN_UNIT, "misfit of the extended model"),
        _nullable(
            "size_found", _REAL, "unit", "smallest size of this effect that the search found"
        ),
        _nullable("size_found_low", _REAL, "unit", "largest size below it that was not found"),
        _nullable("size_found_high", _REAL, "unit", "smallest size from which all were found"),
        _nullable("seconds", _REAL, "s", "processor time"),
    ),
)

AS_LOGGED, GIVEN, SHARE, SEARCH = "as_logged", "given", "share", "search"
"""Why something is planted in this size: nothing is planted; asked for; the usual share of the mean
friction; tried by the search for the least size."""

DONE, CANNOT = "done", "cannot"

NOTHING = "none"
"""Stands for an effect where nothing is planted."""

Row = dict[str, Any]
"""A row of the table: None where a value is missing."""
