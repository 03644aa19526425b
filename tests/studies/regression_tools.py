"""Friction of an arm by ``separate --by regression`` and by public tools, on the same logs.

``python -m tests.studies.regression_tools`` prints the table of docs/regression.md. It needs the
extra ``study`` (figaroh, mujoco's system identification). Each tool is used as its examples do: the
noise of the log is not told to any of them, and all are given the kinematics with wrong masses.

- **pinocchio**: its joint torque regressor, base columns by pivoted QR, least squares; positions
  differentiated after a zero-phase filter, intervals as of independent noise.
- **figaroh**: its regressor with friction and offset, double QR and weighted least squares per
  joint, with the filter and the intervals of its own.
- **mujoco.sysid**: simulated stretches of 0.5 s from logged states and torques, compared with the
  logged positions and velocities; armature, Coulomb and viscous friction, mass and centre of mass.
  It takes minutes per 10 s of log (``--tools mujoco.sysid --seconds 12 --seeds 1``).
"""

import argparse
import tempfile
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pyarrow as pa
from scipy.linalg import qr
from scipy.signal import butter, sosfiltfilt

from frictioncli.regression.separation import torques_by_regression
from tests.regression import programmes
from tests.regression.test_arm import arm_motions, urdf

WRONG = (2.0, 0.5, 3.0)
"""Factors of the masses in the description that the tools are given."""

NOISE = 0.3
PERIOD = programmes.PERIOD
SPEEDS = (5.0, 15.0, 30.0)
"""Speeds at which friction is compared. [deg/s]"""


@dataclass(frozen=True)
class World:
    """A simulated log: the friction of each joint, and what else is in the torque."""

    name: str
    friction: Callable[[int, np.ndarray], np.ndarray]
    delay: float = 0.0


def root_law(joint, speed):
    """Coulomb friction and the root of speed, as equation (16) has it. [N·m]"""
    tau_c, beta = ((9.0, 2.0), (6.0, 1.5), (4.0, 1.0))[joint]
    return tau_c + beta * np.sqrt(speed)


def linear_law(joint, speed):
    """Coulomb and viscous friction in proportion to speed, as the tools have it. [N·m]"""
    tau_c, viscous = ((9.0, 0.30), (6.0, 0.22), (4.0, 0.15))[joint]
    return tau_c + viscous * speed


def stribeck_law(joint, speed):
    """Friction that falls from rest and then grows, which no tool has. [N·m]"""
    tau_c, viscous = ((9.0, 0.30), (6.0, 0.22), (4.0, 0.15))[joint]
    return tau_c * (1 + 0.4 * np.exp(-speed / 6)) + viscous * speed


WORLDS = (
    World("Coulomb and root of speed (equation 16)", root_law),
    World("Coulomb and linear viscous", linear_law),
    World("with Stribeck's peak", stribeck_law),
    World("linear, torque 12 ms late", linear_law, delay=0.012),
)


@dataclass(frozen=True)
class Log:
    """Angle [rad] and torque [N·m] of three joints, shape (rows, 3)."""

    time: np.ndarray
    angle: np.ndarray
    torque: np.ndarray
    table: pa.Table


def simulated(world: World, seed: int, duration: float) -> Log:
    """Return a log: sines of all joints at once, an encoder of 0.001 deg, correlated noise."""
    generator = np.random.default_rng(seed)
    motions, torques = arm_motions(generator, duration)
    clock = motions[0][0]
    parts, angles = [], []
    for joint, motion in enumerate(motions):
        speed = motion[2]
        torques[:, joint] += np.sign(speed) * world.friction(joint, np.abs(speed))
        torques[:, joint] = np.interp(clock - world.delay, clock, torques[:, joint])
        noise = programmes.autoregressive(generator, len(clock), NOISE, 0.5)
        torques[:, joint] += noise
        angle = np.round(motion[1] / 0.001) * 0.001
        angles.append(np.radians(angle))
        columns = {
            "joint": np.full(len(clock), joint + 1, dtype=np.int16),
            "other_speed": np.full(len(clock), 10.0),
        }
        logged = (clock, angle, motion[2], motion[3])
        parts.append(programmes.samples(logged, torques[:, joint], **columns))
    return Log(clock, np.stack(angles, axis=1), torques, pa.concat_tables(parts))


@dataclass(frozen=True)
class Answer:
    """Friction of each joint at each speed, and half of its 95 % interval, shape (3, speeds)."""

    friction: np.ndarray
    half: np.ndarray
    seconds: float


def ours(log: Log, description: Path) -> Answer:
    """Friction of the regression; that of speeds between by its own law."""
    begin = time.perf_counter()
    found = torques_by_regression(log.table.to_batches, urdf=description)
    friction, half = np.empty((3, len(SPEEDS))), np.empty((3, len(SPEEDS)))
    for joint in range(3):
        one = found.facts[joint + 1]
        parameters = {name: value["estimate"] for name, value in one["parameters"].items()}
        known = [row["speed"] for row in one["friction"]]
        halves = [np.diff(row["ci95"])[0] / 2 for row in one["friction"]]
        root = np.sqrt(SPEEDS)
        value = parameters.get("tau_c", 0.0) + parameters.get("beta", 0.0) * root
        friction[joint] = found.signs[joint + 1] * value
        half[joint] = np.interp(SPEEDS, known, halves)
    return Answer(friction, half, time.perf_counter() - begin)


def cells(log: Log, description: Path) -> Answer:
    """Friction of the rows of ``torques``, which go on to ``fit``: a line through those near."""
    begin = time.perf_counter()
    table = torques_by_regression(log.table.to_batches, urdf=description).table
    friction, half = np.empty((3, len(SPEEDS))), np.empty((3, len(SPEEDS)))
    for joint in range(3):
        rows = table[table["joint"] == joint + 1]
        for place, speed in enumerate(SPEEDS):
            near = rows[np.abs(rows["speed"] / speed - 1) < 0.4]
            line = np.polyfit(near["speed"] - speed, near["friction_torque"], 1)
            friction[joint, place] = line[-1]
            left = near["friction_torque"] - np.polyval(line, near["speed"] - speed)
            half[joint, place] = 1.96 * left.std() / np.sqrt(near["pair"].nunique())
    return Answer(friction, half, time.perf_counter() - begin)


def _filtered(values: np.ndarray, cutoff: float = 5.0) -> np.ndarray:
    return sosfiltfilt(butter(4, cutoff, fs=1 / PERIOD, output="sos"), values, axis=0)


def _of_linear(values: np.ndarray, covariance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return friction and half interval from Coulomb [N·m] and viscous [N·m/(rad/s)] friction."""
    columns = np.stack([np.ones(len(SPEEDS)), np.radians(SPEEDS)], axis=1)
    return columns @ values, 1.96 * np.sqrt(np.einsum("ij,jk,ik->i", columns, covariance, columns))


def plain(log: Log, description: Path) -> Answer:
    """pinocchio's regressor with least squares."""
    begin = time.perf_counter()
    model = pinocchio.buildModelFromUrdf(str(description))
    data = model.createData()
    angle = _filtered(log.angle)
    velocity = np.gradient(angle, PERIOD, axis=0)
    acceleration = np.gradient(velocity, PERIOD, axis=0)
    regressor = pinocchio.computeJointTorqueRegressor
    states = zip(angle, velocity, acceleration, strict=True)
    rows = np.array([regressor(model, data, *state) for state in states])
    own = np.eye(3)[np.newaxis]
    ones = np.ones_like(velocity)
    terms = [own * one[:, np.newaxis] for one in (np.sign(velocity), velocity, ones)]
    # the same filter on both sides of the equation, so that it biases nothing
    inner = slice(50, -50)
    arm = _filtered(rows)[inner].reshape(-1, rows.shape[2])
    friction = np.concatenate([_filtered(one)[inner].reshape(-1, 3) for one in terms], axis=1)
    triangle, pivot = qr(arm[::5], mode="r", pivoting=True)
    size = np.abs(np.diag(triangle))
    kept = np.sort(pivot[: len(size)][size > 1e-6 * size[0]])
    columns = np.hstack([arm[:, kept], friction])
    target = _filtered(log.torque)[inner].reshape(-1)
    values = np.linalg.lstsq(columns, target, rcond=None)[0]
    variance = np.sum(np.square(target - columns @ values)) / (len(target) - len(values))
    covariance = variance * np.linalg.pinv(columns.T @ columns)
    found = []
    for number in range(3):
        places = [len(kept) + number, len(kept) + 3 + number]
        found.append(_of_linear(values[places], covariance[np.ix_(places, places)]))
    return Answer(*(np.array(one) for one in zip(*found, strict=True)), time.perf_counter() - begin)


def figaroh(log: Log, description: Path) -> Answer:
    """figaroh's regressor, double QR and weighted least squares, with its own filter."""
    from figaroh.identification import identification_tools as tools
    from figaroh.tools.qrdecomposition import QRDecomposer
    from figaroh.tools.regressor import RegressorBuilder, RegressorConfig

    begin = time.perf_counter()

    @dataclass
    class Robot:
        model: pinocchio.Model
        data: pinocchio.Data

    model = pinocchio.buildModelFromUrdf(str(description))
    robot = Robot(model, model.createData())
    settings = {"ts": PERIOD, "cut_off_frequency_butterworth": 10.0}
    angle = tools.low_pass_filter_data(log.angle, settings)
    torque = tools.low_pass_filter_data(log.torque, settings)
    angle, velocity, acceleration = tools.calculate_first_second_order_differentiation(
        model, angle, settings
    )
    torque = torque[: len(angle)]
    config = RegressorConfig(has_friction=True, has_joint_offset=True)
    rows = RegressorBuilder(robot, config).build_basic_regressor(
        angle, velocity, acceleration, {"act_idxv": [0, 1, 2]}
    )
    names = [f"p{number}" for number in range(30)]
    names += [f"{kind}{joint}" for kind in ("fv", "fs", "off") for joint in range(3)]
    used = np.flatnonzero(np.sum(np.square(rows), axis=0) > 1e-6)
    # rows of one joint follow each other in figaroh
    target = torque.T.reshape(-1)
    base, _, expressions, values = QRDecomposer().double_decomposition(
        target, rows[:, used], [names[place] for place in used]
    )
    count = len(angle)
    joint = np.repeat(np.arange(3), count)
    misfit = target - base @ values
    spread = np.array([misfit[joint == number].std() for number in range(3)])
    scaled = base / spread[joint][:, np.newaxis]
    covariance = np.linalg.inv(scaled.T @ scaled)
    values = covariance @ (scaled.T @ (target / spread[joint]))
    found = []
    for number in range(3):
        # terms of friction are independent of the others, so that they stand alone
        places = [
            next(i for i, text in enumerate(expressions) if f"{kind}{number}" in text)
            for kind in ("fs", "fv")
        ]
        found.append(_of_linear(values[places], covariance[np.ix_(places, places)]))
    return Answer(*(np.array(one) for one in zip(*found, strict=True)), time.perf_counter() - begin)


def sysid(log: Log, description: Path) -> Answer:
    """mujoco's system identification: short stretches simulated from the log's states."""
    from mujoco import sysid as toolbox

    begin = time.perf_counter()
    text = description.read_text(encoding="utf-8")
    spec = mujoco.MjSpec.from_string(text)
    spec.option.timestep = PERIOD
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    for number in range(1, 4):
        joint = spec.joint(f"joint{number}")
        # torques of a log are not clipped
        joint.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE
        motor = spec.add_actuator(name=f"motor{number}")
        motor.target, motor.trntype = f"joint{number}", mujoco.mjtTrn.mjTRN_JOINT
        for kind, label in (
            (mujoco.mjtSensor.mjSENS_JOINTPOS, "pos"),
            (mujoco.mjtSensor.mjSENS_JOINTVEL, "vel"),
        ):
            sensor = spec.add_sensor(name=f"joint{number}_{label}", type=kind)
            sensor.objtype, sensor.objname = mujoco.mjtObj.mjOBJ_JOINT, f"joint{number}"
    model = spec.compile()
    parameters = toolbox.ParameterDict()
    for number in range(1, 4):
        for name, start, most in (
            ("armature", 0.05, 5.0),
            ("frictionloss", 3.0, 40.0),
            ("damping", 3.0, 80.0),
        ):
            parameters.add(
                toolbox.Parameter(
                    f"{name}{number}",
                    nominal=start,
                    min_value=1e-4,
                    max_value=most,
                    modifier=lambda s, p, n=name, j=number: _set_joint(s, j, n, p.value[0]),
                )
            )
        parameters.add(toolbox.body_inertia_param(spec, model, f"link{number}"))
    angle = _filtered(log.angle, 15.0)
    velocity = np.gradient(angle, PERIOD, axis=0)
    data = mujoco.MjData(model)
    steps = 50
    states, controls, sensors = [], [], []
    for first in range(50, len(log.time) - steps - 50, steps):
        rows = slice(first, first + steps)
        clock = np.arange(steps) * PERIOD
        states.append(toolbox.create_initial_state(model, angle[first], velocity[first], data.act))
        controls.append(toolbox.TimeSeries(clock, log.torque[rows]))
        shown = np.empty((steps, 6))
        shown[:, 0::2], shown[:, 1::2] = angle[rows], velocity[rows]
        sensors.append(toolbox.TimeSeries.from_names(clock[1:], shown[1:], model))
    names = [f"stretch{number}" for number in range(len(states))]
    measured = toolbox.ModelSequences("arm", spec, names, states, controls, sensors)
    residual = toolbox.build_residual_fn(models_sequences=[measured])
    best, result = toolbox.optimize(
        parameters, residual, optimizer="mujoco", verbose=False, max_iters=25
    )
    left, _, _ = residual(best.as_vector(), best)
    covariance, _ = toolbox.calculate_intervals(left, result.jac)
    order = [name for name in best.parameters for _ in range(np.size(best[name].value))]
    found = []
    for number in range(1, 4):
        labels = [f"frictionloss{number}", f"damping{number}"]
        places = [order.index(label) for label in labels]
        values = np.array([best[label].value[0] for label in labels])
        found.append(_of_linear(values, covariance[np.ix_(places, places)]))
    return Answer(*(np.array(one) for one in zip(*found, strict=True)), time.perf_counter() - begin)


def _set_joint(spec, number: int, name: str, value: float) -> None:
    joint = spec.joint(f"joint{number}")
    if name == "damping" and np.ndim(joint.damping):
        joint.damping = [value, *([0.0] * (len(joint.damping) - 1))]
    else:
        setattr(joint, name, value)


TOOLS: Mapping[str, Callable[[Log, Path], Answer]] = {
    "separate --by regression, its law": ours,
    "the same, rows of `torques`": cells,
    "pinocchio, least squares": plain,
    "figaroh": figaroh,
    "mujoco.sysid": sysid,
}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="length of each log [s]")
    parser.add_argument("--seeds", type=int, default=3, help="logs per world")
    parser.add_argument(
        "--tools", nargs="*", default=list(TOOLS)[:-1], help="of: " + ", ".join(TOOLS)
    )
    parser.add_argument("--worlds", nargs="*", type=int, default=[0, 1, 2, 3], help="from 0")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    titles = (
        "friction of the log | tool | error, RMS [%] | greatest [%] | in the interval | time [s]"
    )
    print(f"| {titles} |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        description = Path(folder, "arm.urdf")
        description.write_text(urdf(masses=WRONG), encoding="utf-8")
        for world in [WORLDS[number] for number in options.worlds]:
            truth = np.array([world.friction(joint, np.array(SPEEDS)) for joint in range(3)])
            logs = [simulated(world, seed, options.seconds) for seed in range(options.seeds)]
            for name in options.tools:
                answers = [TOOLS[name](log, description) for log in logs]
                error = np.array([one.friction / truth - 1 for one in answers])
                inside = [np.abs(one.friction - truth) <= one.half for one in answers]
                print(
                    f"| {world.name} | {name} | {100 * np.sqrt(np.mean(error**2)):.1f}"
                    f" | {100 * np.abs(error).max():.1f} | {np.sum(inside)} of {np.size(inside)}"
                    f" | {np.mean([one.seconds for one in answers]):.1f} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
