"""Work folders in which a file is damaged, replaced or missing, and a stage that uses them."""

import copy
import io
import json
import random
import shutil
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from tests.studies.fuzz_damage import _damaged
from tests.studies.fuzz_input import LOGS, RICH, RICH_LOGS, WORK, Input

_FORMER = Path(__file__).parents[1] / "robustness" / "data" / "work-0.1.0.zip"
_VALUES: tuple[Any, ...] = (
    *(None, True, 0, -1, 1e308, -1e308, 1e-308, 10**400, "", "x", "é" * 3000, [], {}, [[]], [None]),
    *(float("nan"), float("inf"), {"a": 1}, [1, "x"], "NaN", "1.5", 3, 2.5),
)
_STAGES = (
    *(["pair"], ["separate"], ["separate", "--by", "regression"], ["fit"], ["simulate"]),
    *(["simulate", "--extended"], ["evaluate"], ["diagnose"], ["plan"], ["export", "--to", "json"]),
    *(["export", "--to", "c"], ["export", "--to", "urdf"], ["export", "--to", "mjcf"], ["report"]),
    ["compare", WORK, "other"],
)


def work_folders(folder: Path, base: Path, draw: random.Random) -> Input:
    """Return a stage on a work folder in which one file is damaged."""
    rich = draw.random() < 0.7 and (base / RICH).is_dir()
    shutil.copytree(base / (RICH if rich else WORK), folder / WORK)
    shutil.copytree(base / "other", folder / "other")
    files = sorted([*(folder / WORK).glob("*.parquet"), *(folder / WORK).glob("*.json")])
    path = draw.choice(files)
    content = path.read_bytes()
    kind = "bytes"
    if draw.random() < 0.2:
        kind, content = _damaged(content, draw)
    elif path.suffix == ".json":
        kind, content = _json(content, draw)
    else:
        kind, content = _parquet(pq.read_table(path), draw)
    if draw.random() < 0.15:
        kind = _replaced(path, files, draw)
    else:
        path.write_bytes(content)
    words = list(draw.choice(_STAGES))
    if path.name == "challenge.parquet" and draw.random() < 0.5:
        shutil.copytree(base / RICH_LOGS, folder / LOGS)
        words = ["challenge", LOGS, "--effect", "stribeck:2"]
    if words[0] == "report" and draw.random() < 0.7:  # it takes longest
        words = ["fit"]
    return Input(f"{path.name}: {kind}", words if WORK in words else [*words, "-w", WORK])


def _replaced(path: Path, files: list[Path], draw: random.Random) -> str:
    """Put something else in the place of a file of a work folder, or nothing."""
    kind = draw.choice(
        ("missing", "several missing", "empty", "folder", "link", "former", "swapped")
    )
    content = path.read_bytes()
    if kind == "several missing":
        for one in draw.sample(files, draw.randrange(1, len(files))):
            one.unlink()
    elif kind == "former":
        with zipfile.ZipFile(_FORMER) as packed:
            names = set(packed.namelist())
            some = [one for one in files if one.name in names]
            for one in draw.sample(some, draw.randrange(1, len(some))):
                one.write_bytes(packed.read(one.name))
    elif kind == "swapped":
        other = draw.choice([one for one in files if one.suffix == path.suffix])
        path.write_bytes(other.read_bytes())
        other.write_bytes(content)
    else:
        path.unlink()
        if kind == "folder":
            path.mkdir()
        elif kind == "link":
            path.symlink_to(draw.choice((path.name, "..", "/dev/zero", "/dev/null", "nowhere")))
        elif kind == "empty":
            path.touch()
    return kind


def _json(content: bytes, draw: random.Random) -> tuple[str, bytes]:
    document = json.loads(content)
    holder, key = document, draw.choice(list(document))
    while isinstance(holder[key], dict | list) and holder[key] and draw.random() < 0.7:
        holder = holder[key]
        key = draw.choice(list(holder) if isinstance(holder, dict) else range(len(holder)))
    kind = draw.choice(("value", "value", "value", "lost", "more", "twice", "number"))
    if kind == "lost":
        del holder[key]
    elif kind == "more" and isinstance(holder, dict):
        holder["another"] = draw.choice(_VALUES)
    elif kind == "twice" and isinstance(holder, list):
        holder.append(copy.deepcopy(holder[key]))
    elif kind == "number" and isinstance(holder[key], int | float):
        holder[key] = draw.choice((-1, 1e9, 1e-9, 0)) * holder[key]
    else:
        holder[key] = draw.choice(_VALUES)
    return f"{kind} of {key}", json.dumps(document).encode("utf-8", "surrogatepass")


def _retyped(column: pa.Array, draw: random.Random) -> pa.Array:
    """Return a column as another type, as other tools write it; as it is where that cannot be."""
    types = (pa.float32(), pa.int32(), pa.int64(), pa.large_string(), pa.string(), pa.bool_())
    kind = draw.choice((*types, pa.decimal128(38, 9), pa.timestamp("us"), pa.null(), pa.binary()))
    try:
        return column.cast(kind, safe=False)
    except pa.ArrowException:
        return pa.nulls(len(column), kind)


def _parquet(table: pa.Table, draw: random.Random) -> tuple[str, bytes]:
    at = draw.randrange(table.num_columns)
    name, column = table.column_names[at], table.column(at).combine_chunks()
    kind = draw.choice(
        (
            "lost",
            "text",
            "value",
            "value",
            "value",
            "nothing",
            "one row",
            "reversed",
            "facts",
            "more",
            "type",
            "order",
        )
    )
    if kind == "lost":
        table = table.remove_column(at)
    elif kind == "text":
        table = table.set_column(at, name, pa.array(["x"] * table.num_rows))
    elif kind == "value" and table.num_rows and pa.types.is_floating(column.type):
        values = column.to_numpy(zero_copy_only=False).copy()
        some = slice(None) if draw.random() < 0.4 else draw.randrange(len(values))
        values[some] = draw.choice((np.nan, np.inf, -np.inf, 0.0, -1.0, 1e308, 1e-308, 1e9))
        table = table.set_column(at, name, pa.array(values))
    elif kind == "value":
        table = table.set_column(at, name, pa.nulls(table.num_rows, column.type))
    elif kind == "facts":
        document = json.loads((table.schema.metadata or {}).get(b"frictioncli", b"{}"))
        if document:
            _, stored = _json(json.dumps(document).encode(), draw)
            table = table.replace_schema_metadata({b"frictioncli": stored})
    elif kind == "type":
        table = table.set_column(at, name, _retyped(column, draw))
    elif kind == "order":
        table = table.select(draw.sample(table.column_names, table.num_columns))
    elif kind == "more":
        table = pa.concat_tables([table, table])
    else:
        rows = {"nothing": [], "one row": [0][: table.num_rows]}
        taken = rows.get(kind, list(range(table.num_rows))[::-1])
        table = table.take(pa.array(taken, pa.int64()))
    sink = io.BytesIO()
    pq.write_table(table, sink)
    return f"{kind} {name}", sink.getvalue()
