"""Work folders as the chain leaves them, from tables of torques."""

from datetime import datetime, timedelta

import pandas as pd

from frictioncli import schemas, tables
from frictioncli.model.document import write_models
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from frictioncli.provenance import Provenance

FIRST = datetime(2026, 1, 5, 8)


def write_folder(folder, torques, *, started_at=None, unit="N·m", side="joint", ambient=None):
    """Write ``torques.parquet``, ``model.json`` and, where times are told, ``recordings.parquet``.

    ``started_at`` and ``ambient`` map runs to their start (datetime) and ambient temperature [°C].
    """
    folder.mkdir(parents=True, exist_ok=True)
    facts = {"torque_unit": unit, "torque_side": side, "sign": {}}
    made = Provenance("separate")
    tables.write(folder / "torques.parquet", complete(torques), schemas.TORQUES, made, facts)
    models = [fit_joint(own, facts, FitSettings()) for _, own in torques.groupby("joint")]
    write_models(folder / "model.json", models, Provenance("fit"))
    if started_at is not None:
        rows = [
            {
                "run": run,
                "recording": "001",
                "joint": int(joint),
                "file": "001.csv",
                "started_at": None if start is None else start.isoformat(),
                "start": 0.0,
                "ambient": (ambient or {}).get(run),
                "rows_read": 1,
                "rows_kept": 1,
                "rows_rejected": 0,
                "period": 0.012,
                "notes": "",
            }
            for run, start in started_at.items()
            for joint in torques["joint"].unique()
        ]
        table = pd.DataFrame(rows).astype({"joint": "int16", "ambient": float})
        tables.write(folder / "recordings.parquet", table, schemas.RECORDINGS, Provenance("ingest"))
    return folder


def complete(torques):
    """Rows of torques with every column of the schema."""
    rows = torques.copy()
    for name in ("torque_forward", "torque_reverse"):
        if name not in rows:
            sign = 1 if name.endswith("forward") else -1
            rows[name] = rows["load_torque"] + sign * rows["friction_torque"]
    for name in ("n_forward", "n_reverse"):
        if name not in rows:
            rows[name] = 10
    return rows.assign(joint=rows["joint"].astype("int16"))


def one_each(root, torques, *, weekly=True):
    """Write a work folder per run, a week apart; return their paths in the order of runs."""
    paths = []
    for number, (run, own) in enumerate(torques.groupby("run", sort=True)):
        started_at = {run: FIRST + timedelta(days=7 * number)} if weekly else None
        paths.append(write_folder(root / f"run-{number + 1:02d}", own, started_at=started_at))
    return paths
