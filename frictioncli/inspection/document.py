"""The inspection as one JSON document with stable keys."""

import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

from frictioncli import __version__
from frictioncli.inspection.findings import FileInspection
from frictioncli.inspection.inspect import Inspection
from frictioncli.inspection.remarks import remarks, unit_of
from frictioncli.inspection.sufficiency import JointSummary


def document(found: Inspection) -> dict[str, Any]:
    """Return what was found as plain values; what is not known is null.

    Keys end in their unit (``_s``, ``_hz``) or have it beside them as ``unit``.
    """
    whole = {
        "program": "frictioncli",
        "version": __version__,
        "files": [_file(file) for file in found.files],
        "joints": [_data(joint) for joint in found.joints],
        "remarks": list(found.remarks),
    }
    return {key: _plain(value) for key, value in whole.items()}


def _file(found: FileInspection) -> dict[str, Any]:
    values = asdict(found)
    for joint in values["joints"]:
        for channel in joint["channels"]:
            channel["unit"] = unit_of(channel["quantity"], joint["torque_unit"])
        for spikes in joint["spikes"]:
            spikes["unit"] = unit_of(spikes["quantity"], joint["torque_unit"])
    odd = [{"kind": remark.kind, "text": remark.text} for remark in remarks(found)]
    return values | {"usable": not found.refusal, "remarks": odd}


def _data(found: JointSummary) -> dict[str, Any]:
    values = asdict(found)
    stages = {stage.pop("name"): stage for stage in values.pop("stages")}
    values["speeds_deg_per_s"] = values.pop("speeds")
    values["temperature_degc"] = values.pop("temperature")
    return values | {"stages": stages}


def _plain(value: Any) -> Any:
    """Return a value that JSON can hold: no paths, no tuples, no NaN."""
    if isinstance(value, dict):
        return {str(key): _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
