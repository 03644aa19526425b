"""Schemas of the tables that the stages exchange: rows, columns, types and units."""

from dataclasses import dataclass, replace

import pyarrow as pa

from frictioncli import quantities as q
from frictioncli.quantities import Quantity

_TEXT = pa.string()
_LABEL = pa.dictionary(pa.int32(), pa.string())
_REAL = pa.float64()
_COUNT = pa.int64()
_JOINT = pa.int16()
_FLAG = pa.bool_()


@dataclass(frozen=True, slots=True)
class Column:
    """A column: name, Arrow type, unit ("" where it has none) and meaning."""

    name: str
    type: pa.DataType
    unit: str
    description: str
    nullable: bool = False


@dataclass(frozen=True, slots=True)
class Table:
    """A table: file stem, meaning of a row, and columns in order."""

    name: str
    row: str
    columns: tuple[Column, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Column names in order."""
        return tuple(column.name for column in self.columns)

    @property
    def required(self) -> tuple[str, ...]:
        """Names of the columns that have a value in every row."""
        return tuple(column.name for column in self.columns if not column.nullable)


def _of(quantity: Quantity, *, nullable: bool = False) -> Column:
    return Column(quantity.name, _REAL, quantity.unit, quantity.description, nullable)


def _nullable(name: str, kind: pa.DataType, unit: str, description: str) -> Column:
    return Column(name, kind, unit, description, nullable=True)


_RUN = Column("run", _LABEL, "", "one folder of logs: one day, one thermal history")
_RECORDING = Column("recording", _LABEL, "", "one log file of the run")
_JOINT_COLUMN = Column("joint", _JOINT, "", "joint number, from 1")
_PAIR = Column("pair", _COUNT, "", "number of the pair, unique within run and joint")
_PHASE = Column("phase", _LABEL, "", "heat-up, cool-down or sweep")
_POSE = Column(q.POSE.name, _COUNT, "", q.POSE.description, nullable=True)
_SPEED = _of(q.SPEED)
_PAIR_TIME = Column("time", _REAL, "s", "middle of the pair, since the run's first sample")
_CRITERION = Column("criterion", _LABEL, "", "rule that decides when to correct")
_K = Column("k", _REAL, "", "scale of the periodicity criterion (20)", nullable=True)
_TMAX = Column("tmax", _REAL, "s", "time after which a correction is forced", nullable=True)
_BOUND = Column(
    "bound", _REAL, q.TORQUE, "greatest uncertainty of friction that is allowed", nullable=True
)

SAMPLES = Table(
    "samples",
    "controller sample",
    (
        _RUN,
        _RECORDING,
        _JOINT_COLUMN,
        _of(q.TIME),
        _of(q.POSITION),
        _of(q.VELOCITY),
        _of(q.MOTOR_TORQUE),
        _of(q.MOTOR_TEMPERATURE, nullable=True),
        _of(q.HOUSING_TEMPERATURE, nullable=True),
        _of(q.MOTOR_TEMPERATURE_READING, nullable=True),
        _of(q.LOAD, nullable=True),
        _of(q.OTHER_SPEED, nullable=True),
        Column(q.OTHER_JOINTS.name, _COUNT, "", q.OTHER_JOINTS.description, nullable=True),
        _POSE,
        _nullable("payload", _REAL, "kg", "payload of the motion, where a program tells several"),
    ),
)

RECORDINGS = Table(
    "recordings",
    "recording and joint",
    (
        _RUN,
        _RECORDING,
        _JOINT_COLUMN,
        Column("file", _TEXT, "", "the file as it was named on the command line or found"),
        Column("started_at", _TEXT, "", "start, ISO 8601, where the log or manifest says", True),
        Column("start", _REAL, "s", "start since the run's first sample"),
        Column("phase", _LABEL, "", "phase given by the manifest", True),
        _of(q.PAYLOAD, nullable=True),
        Column("ambient", _REAL, "°C", "ambient temperature given by the manifest", True),
        Column("rows_read", _COUNT, "", "rows read"),
        Column("rows_kept", _COUNT, "", "rows that became samples"),
        Column("rows_rejected", _COUNT, "", "rows that could not be used"),
        Column("period", _REAL, "s", "median time between samples"),
        Column("notes", _TEXT, "", "what was found and believed, one note a line"),
    ),
)

REJECTED = Table(
    "rejected",
    "rejected row or file",
    (
        _RUN,
        _RECORDING,
        Column("row", _COUNT, "", "line in the file, from 1; none where the whole file", True),
        Column("reason", _LABEL, "", "why it cannot be used"),
        Column("text", _TEXT, "", "the row, or what was found in the file"),
    ),
)

_PAIR_COLUMNS = (
    _RUN,
    _JOINT_COLUMN,
    _PAIR,
    _SPEED,
    _PAIR_TIME,
    _PHASE,
    _of(q.MOTOR_TEMPERATURE, nullable=True),
    _of(q.HOUSING_TEMPERATURE, nullable=True),
    Column("position", _REAL, "deg", "centre of the angle bin"),
    Column("torque_forward", _REAL, q.TORQUE, "mean torque in the bin while position grows"),
    Column("torque_reverse", _REAL, q.TORQUE, "mean torque in the bin while position falls"),
    Column("n_forward", _COUNT, "", "samples of the forward mean"),
    Column("n_reverse", _COUNT, "", "samples of the reverse mean"),
    _of(q.MOTOR_TEMPERATURE_READING, nullable=True),
    _of(q.LOAD, nullable=True),
    _of(q.PAYLOAD, nullable=True),
    _POSE,
)

_ONE_DIRECTION = ("torque_forward", "torque_reverse")

PAIRS = Table("pairs", "pair and angle bin", _PAIR_COLUMNS)

TORQUES = Table(
    "torques",
    "pair and angle bin",
    (
        *(
            # a regression also uses bins that the joint passes in one direction only
            replace(column, nullable=True) if column.name in _ONE_DIRECTION else column
            for column in _PAIR_COLUMNS
        ),
        _of(q.FRICTION_TORQUE),
        _of(q.LOAD_TORQUE),
    ),
)

RAMPS = Table(
    "ramps",
    "move, part of it and bin of distance from the turning point",
    (
        _RUN,
        _RECORDING,
        _JOINT_COLUMN,
        Column("move", _COUNT, "", "number of the move, unique in the table"),
        Column("part", _LABEL, "", "accelerating after the move began, or braking before its end"),
        Column("direction", _JOINT, "", "1 while position grows, -1 while it falls"),
        Column("reversal", _FLAG, "", "the move before went the other way, or is not known"),
        Column("speed", _REAL, "deg/s", "constant speed of the move, > 0"),
        Column("bin", _COUNT, "", "bin of distance, from 0"),
        Column("time", _REAL, "s", "mean time since the run's first sample"),
        _of(q.MOTOR_TEMPERATURE, nullable=True),
        _of(q.HOUSING_TEMPERATURE, nullable=True),
        _of(q.PAYLOAD, nullable=True),
        _of(q.POSITION),
        _of(q.VELOCITY),
        Column("acceleration", _REAL, "deg/s²", "mean slope of the velocity"),
        Column("acceleration_before", _REAL, "deg/s²", "the same one sample earlier"),
        Column("acceleration_after", _REAL, "deg/s²", "the same one sample later"),
        Column("acceleration_2_before", _REAL, "deg/s²", "the same two samples earlier"),
        Column("acceleration_2_after", _REAL, "deg/s²", "the same two samples later"),
        Column("distance", _REAL, "deg", "mean angle since the move began, or until it ends"),
        Column("spread", _REAL, "deg", "standard deviation of the angle in the bin"),
        Column("elapsed", _REAL, "s", "mean time since the move began, or until it ends"),
        _of(q.MOTOR_TORQUE),
        _of(q.LOAD, nullable=True),
        Column("samples", _COUNT, "", "samples of the means"),
        _POSE,
    ),
)

STARTS = Table(
    "starts",
    "sample around the start of a move",
    (
        _RUN,
        _RECORDING,
        _JOINT_COLUMN,
        Column("move", _COUNT, "", "number of the move, unique in the table"),
        Column("direction", _JOINT, "", "1 where position grows in the move, -1 where it falls"),
        Column("speed", _REAL, "deg/s", "constant speed of the move, > 0"),
        Column("since", _REAL, "s", "time since the move began, negative before"),
        _of(q.TIME),
        _of(q.POSITION),
        _of(q.MOTOR_TORQUE),
        _of(q.MOTOR_TEMPERATURE, nullable=True),
        _of(q.HOUSING_TEMPERATURE, nullable=True),
        _of(q.PAYLOAD, nullable=True),
        _POSE,
    ),
)

SCHEDULE = Table(
    "schedule",
    "pair",
    (
        _RUN,
        _JOINT_COLUMN,
        _PAIR,
        _SPEED,
        _PAIR_TIME,
        _PHASE,
        _CRITERION,
        _K,
        _TMAX,
        _of(q.TEMPERATURE_PARAMETER),
        _of(q.TEMPERATURE_CORRECTION),
        Column("corrected", _FLAG, "", "a correction was tried at this pair"),
        Column("failed", _FLAG, "", "the correction could not be computed; the last one was kept"),
        Column("friction_torque", _REAL, q.TORQUE, "measured friction torque at zero load"),
        Column("friction_smoothed", _REAL, q.TORQUE, "the same, smoothed over motor temperature"),
        Column("friction_predicted", _REAL, q.TORQUE, "friction torque predicted at zero load"),
        _BOUND,
    ),
)

EVALUATION = Table(
    "evaluation",
    "phase, criterion and setting",
    (
        _RUN,
        _JOINT_COLUMN,
        _PHASE,
        _CRITERION,
        _K,
        _TMAX,
        Column("corrections", _COUNT, "", "corrections tried in the phase"),
        Column("failed", _COUNT, "", "of these, those that could not be computed"),
        Column("epsilon", _REAL, q.TORQUE, "error (21) against the smoothed friction torque"),
        Column("epsilon_unsmoothed", _REAL, q.TORQUE, "the same against the unsmoothed one"),
        _BOUND,
    ),
)

REFERENCE_TEMPERATURES = (20, 40, 60)
"""Temperatures at which the fleet's table states friction. [°C]"""

_ESTIMATED = ("tau_c", "alpha", "beta", "gamma", "delta")
_IN_UNIT = "torque unit"


def _interval(name: str, unit: str, description: str) -> tuple[Column, ...]:
    return (
        _nullable(name, _REAL, unit, description),
        _nullable(f"{name}_low", _REAL, unit, f"{name}: lower end of its 95 % interval"),
        _nullable(f"{name}_high", _REAL, unit, f"{name}: upper end of its 95 % interval"),
    )


def _estimated(name: str) -> tuple[Column, ...]:
    return (
        *_interval(name, f"{name}_unit", f"parameter {name} of equation (16)"),
        _nullable(f"{name}_unit", _LABEL, "", f"unit of {name}"),
        _nullable(f"{name}_determined", _FLAG, "", f"the data tell {name}"),
    )


FLEET = Table(
    "fleet",
    "joint",
    (
        Column("robot", _TEXT, "", "name of the robot"),
        _JOINT_COLUMN,
        _nullable("runs", _COUNT, "", "runs read"),
        Column("status", _LABEL, "", "done or failed"),
        Column("message", _TEXT, "", "why it failed, or what was left out"),
        _nullable("torque_unit", _LABEL, "", "unit of everything torque-like in this row"),
        *(column for name in _ESTIMATED for column in _estimated(name)),
        _nullable("temperature", _LABEL, "", "temperature that the model is given"),
        _nullable("rmse", _REAL, _IN_UNIT, "error of the model over all pairs and angle bins"),
        _nullable("n_pairs", _COUNT, "", "pairs used"),
        _nullable("epsilon_heating", _REAL, _IN_UNIT, "error (21) with corrections, heat-up"),
        _nullable("epsilon_cooling", _REAL, _IN_UNIT, "error (21) with corrections, cool-down"),
        _nullable("corrections_heating", _REAL, "", "corrections per run, heat-up"),
        _nullable("corrections_cooling", _REAL, "", "corrections per run, cool-down"),
        _nullable("verdict", _LABEL, "", "verdict of the diagnosis"),
        _nullable("causes", _TEXT, "", "its causes, strongest first"),
        *_interval("gain", "", "share of the misfit that the extended model removes"),
        _nullable("gain_basis", _LABEL, "", "new_run, or within_run where the gain is optimistic"),
        _nullable("reference_speed", _REAL, "deg/s", "middle of the speeds of the data"),
        *(
            _nullable(
                f"friction_{temperature}",
                _REAL,
                _IN_UNIT,
                f"friction at {temperature} °C and the reference speed, without load",
            )
            for temperature in REFERENCE_TEMPERATURES
        ),
        *_interval("change", _IN_UNIT, "friction of the last run less the mean of the earlier"),
        _nullable("friction_by_run", pa.list_(_REAL), _IN_UNIT, "each run less their mean"),
        _nullable("inputs_sha256", _TEXT, "", "digest of all files that were read"),
    ),
)
