"""KUKA traces for the tests: an interpolator's file and a drive's, native or as raw CSV."""

import numpy as np

from frictioncli import schemas, tables
from frictioncli.logs.ingest import IngestSettings, ingest

from .diadem_files import raw_numbers, write_diadem
from .logs import back_and_forth, write

RATIO = -90.72
OFFSET = 3.5  # [deg]
FINE = back_and_forth(period=0.004)
TIME, POSITION, VELOCITY, TORQUE = FINE
COARSE = slice(None, None, 3)


def interpolator(torque=True, rows=COARSE):
    """Return what the interpolator traces every 12 ms, in physical units."""
    columns = {
        "X_Act[mm]": 400 * np.cos(np.radians(POSITION[rows])),
        "Y_Act[mm]": 400 * np.sin(np.radians(POSITION[rows])),
        "Z_Act[mm]": 500 + 0 * POSITION[rows],
        "AxisPos_Act2[°]": 20 + POSITION[rows] / 2,
        "AxisPos_Act3[°]": POSITION[rows],
        "DriveMotorTorq_Act2[Nm]": TORQUE[rows] / 50,
        "DriveMotorTorq_Act3[Nm]": TORQUE[rows] / 90,
    }
    if not torque:
        del columns["DriveMotorTorq_Act3[Nm]"], columns["DriveMotorTorq_Act2[Nm]"]
    return columns


def drive(torque=False):
    """Return what drive 3 traces every 4 ms, in physical units."""
    motor = (POSITION - OFFSET) * RATIO
    columns = {
        "Sollposition[°]": motor,
        "Istposition[°]": motor,
        "Istgeschwindigkeit[°/s]": VELOCITY * RATIO,
    }
    if torque:
        columns["Istmoment[Nm]"] = TORQUE / 90
    return columns


def raw(columns):
    return {column: raw_numbers(column, values) for column, values in columns.items()}


def write_file(folder, name, columns, *, native=True, period=0.012, start=0.0):
    """Write a module's file as the controller does, or as CSV without the header's factors."""
    if native:
        return write_diadem(folder / f"{name}.dat", raw(columns), period=period)
    n = len(next(iter(columns.values())))
    with_time = {"Zeit[sec]": start + period * np.arange(n), **raw(columns)}
    return write(folder / f"{name}.csv", with_time, encoding="cp1252", digits=15)


def write_trace(folder, name="t", *, native=True, torque_of_drive=False):
    write_file(folder, f"{name}_KRCIpo", interpolator(), native=native)
    columns = drive(torque_of_drive)
    write_file(folder, f"{name}_NextGenDrive#3", columns, native=native, period=0.004)
    return folder


def read(folder, work, **options):
    summary = ingest([folder], work, IngestSettings(**options))
    return summary, tables.read(work / "samples.parquet", schemas.SAMPLES)


def recordings(work):
    return tables.read(work / "recordings.parquet", schemas.RECORDINGS)
