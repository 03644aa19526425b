"""Friction in real logs by another way: numpy and pandas alone, nothing of the program.

Each function reads the raw files of one set with what a person found out about them, its columns,
units and traps, and returns the friction at its speeds. Two ways: half the difference of the mean
torque there and back in bins of 5 degrees, or least squares of all samples on inertia, gravity and
a friction law. Means over bins, no intervals: figures for orientation, not truth.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

_BIN = 5.0
"""Width of the bins of the angle. [deg]"""

Motion = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Time [s], angle [deg], velocity [deg/s] and torque of one file."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Independent:
    """Friction of one joint by the independent script.

    Attributes
    ----------
    joint : int
        Its number, from 1.
    unit : str
        Unit of the friction.
    way : str
        How it was found.
    side : {"motor", "joint"}
        Side of the gear on which the torque was measured.
    friction : dict of float to float
        Friction by speed [deg/s].
    law : tuple of float or None
        Friction at a speed v in deg/s is law[0] + law[1] sqrt(v), where one was fitted.
    """

    joint: int
    unit: str
    way: str
    side: str = "motor"
    friction: dict[float, float] = field(default_factory=dict)
    law: tuple[float, float] | None = None

    def at(self, speed: float) -> float | None:
        """Return the friction at a speed, within 5 % of one of its own, or by its law."""
        if self.law is not None:
            return self.law[0] + self.law[1] * float(np.sqrt(speed))
        near = self.nearest(speed)
        return self.friction.get(near) if abs(near - speed) <= 0.05 * speed else None

    def nearest(self, speed: float) -> float:
        """Return the nearest of its own speeds; 0 without any."""
        return min(self.friction, key=lambda one: abs(one - speed), default=0.0)


def steady(motion: Motion, reach: int, tolerance: float) -> np.ndarray:
    """Return where the velocity has been and stays the same for some samples, in share of it."""
    velocity = motion[2]
    same = np.abs(velocity) > 1.0
    for shift in range(1, reach + 1):
        for other in (np.roll(velocity, shift), np.roll(velocity, -shift)):
            same &= np.abs(other - velocity) < tolerance * np.abs(velocity)
    same[:reach] = same[len(same) - reach :] = False
    return same


def half_differences(
    motions: Sequence[Motion], reach: int, tolerance: float, levels: Sequence[float]
) -> dict[float, float]:
    """Return half the difference there and back per speed, the mean over bins of 5 degrees."""
    parts = []
    for motion in motions:
        _, angle, velocity, torque = (one[steady(motion, reach, tolerance)] for one in motion)
        parts.append(pd.DataFrame({"angle": angle, "velocity": velocity, "torque": torque}))
    rows = pd.concat(parts)
    found = {}
    for level in levels:
        at = rows[np.abs(rows["velocity"].abs() - level) < max(tolerance, 0.05) * level]
        cells = at.groupby([np.floor(at["angle"] / _BIN), at["velocity"] > 0])["torque"].mean()
        ways = [cells[cells.index.get_level_values(1) == forward] for forward in (True, False)]
        there, back = (one.droplevel(1) for one in ways)
        both = (there - back).dropna()
        if len(both):
            speed = float(at["velocity"].abs().mean())
            found[speed] = abs(float(both.mean())) / 2
    return found


def least_squares(motion: Motion, cut: float) -> tuple[tuple[float, float], float]:
    """Return f0, f1 and RMS of torque on inertia, gravity, offset, sign(v) (f0 + f1 sqrt|v|).

    Both sides go through one filter, the mean of 15 samples.
    """
    time, angle, velocity, torque = motion
    turn, sign = np.radians(angle), np.sign(velocity)
    columns = [np.gradient(velocity, time), np.cos(turn), np.sin(turn), np.ones_like(turn), sign]
    columns += [sign * np.sqrt(np.abs(velocity)), torque]
    same = [np.convolve(one, np.full(15, 1 / 15), mode="same") for one in columns]
    design, torque = np.stack(same[:-1], axis=1), same[-1]
    moving = np.abs(velocity) > cut
    solution = np.linalg.lstsq(design[moving], torque[moving], rcond=None)[0]
    left = torque[moving] - design[moving] @ solution
    return (float(solution[4]), float(solution[5])), float(np.sqrt(np.mean(left**2)))


def kuka_kr3(
    folder: Path, joint: int, levels: Sequence[float], channel: str = "DriveMotor"
) -> Independent:
    """KUKA traces: raw values in the CSV are radians, whatever the header says."""
    motions = []
    for file in sorted(folder.glob("*_KRCIpo.csv")):
        rows = pd.read_csv(file, sep=";", encoding="cp1252")
        time, angle, torque = (
            rows[name].to_numpy(float)
            for name in ("Zeit[sec]", f"AxisPos_Act{joint}[°]", f"{channel}Torq_Act{joint}[Nm]")
        )
        angle = np.degrees(angle)
        motions.append((time, angle, np.gradient(angle, time), torque))
    friction = half_differences(motions, 1, 0.02, levels)
    side = "motor" if channel == "DriveMotor" else "joint"
    return Independent(
        joint=joint, unit="N·m", side=side, way="half differences", friction=friction
    )


def dashboard(
    folders: Sequence[Path], joint: int, channel: str, levels: Sequence[float], skip: float = 0.0
) -> Independent:
    """Recordings of an xArm6 or Gen3 at 2 Hz, columns counted from 0, velocity from the angle."""
    motions, names = [], [f"{one}_{joint - 1}" for one in ("Pos", "Velocity", channel)]
    files = sorted(file for folder in folders for file in folder.glob("*.csv"))
    for number, file in enumerate(file for file in files if file.stat().st_size):
        rows = pd.read_csv(file)
        rows = rows[rows["Time (s)"] > (skip if number == 0 else 0.0)]
        time, angle = rows["Time (s)"].to_numpy(), rows[names[0]].to_numpy()
        motions.append((time, angle, np.gradient(angle, time), rows[names[2]].to_numpy()))
    return Independent(
        joint=joint,
        unit="A" if channel == "Current" else "N·m",
        side="motor" if channel == "Current" else "joint",
        way="half differences",
        friction=half_differences(motions, 1, 0.1, levels),
    )


def damiao(folder: Path) -> Independent:
    """A staircase of speeds in rad/s, held for 1 s each."""
    motions = []
    for file in sorted(folder.glob("*.csv")):
        rows = pd.read_csv(file)
        angle, velocity = np.degrees(rows["position"]), np.degrees(rows["velocity"])
        torque = rows["torque_feedback"].to_numpy()
        motions.append((rows["time"].to_numpy(), angle.to_numpy(), velocity.to_numpy(), torque))
    levels = [float(np.degrees(step)) for step in range(1, 9)]
    friction = half_differences(motions, 3, 0.1, levels)
    return Independent(joint=5, unit="N·m", side="joint", way="half differences", friction=friction)


def epos(folder: Path) -> Independent:
    """Ten lines of head, names, units; one speed in rpm per file, backwards with an n."""
    mean = {}
    for file in folder.glob("*.csv"):
        lines = (line.split(";") for line in file.read_text(encoding="utf-8-sig").splitlines())
        rows = [one for one in lines if len(one) == 3 and one[0].replace(".", "").isdigit()]
        values = pd.DataFrame(rows).apply(pd.to_numeric, errors="coerce").dropna().iloc[20:]
        mean[file.stem] = values.mean()
    friction = {
        3.0 * float(mean[name][1] - mean[f"n{name}"][1]): float(mean[name][2] - back[2]) / 2
        for name, back in ((one[1:], mean[one]) for one in mean if one.startswith("n"))
    }
    friction = {abs(speed): abs(torque) for speed, torque in friction.items()}
    return Independent(joint=1, unit="%", way="half differences of file means", friction=friction)


def ur10e(folder: Path) -> Independent:
    """No header: time, six angles, six velocities, six currents; joint 1 alone moves."""
    rows = pd.read_csv(next(folder.glob("*.csv")), header=None).to_numpy(float)
    motion = (rows[:, 0], np.degrees(rows[:, 1]), np.degrees(rows[:, 7]), rows[:, 13])
    law, rms = least_squares(motion, 1.0)
    return Independent(joint=1, unit="A", way=f"least squares, RMS {rms:.3f} A", law=law)


def nist(folder: Path, joint: int) -> Independent:
    """Angles in deg, velocities in rad/s; the other joints move and weigh on this one."""
    rows = pd.read_csv(folder / "run.csv.gz")
    names = ("JOINT_POSITIONS", "JOINT_VELOCITIES", "JOINT_CURRENT")
    angle, velocity, current = (
        rows[f"ROBOT_ACTUAL_{one} (J{joint})"].to_numpy(float) for one in names
    )
    law, rms = least_squares(
        (rows["ROBOT_TIME"].to_numpy(float), angle, np.degrees(velocity), current), 1.0
    )
    way = f"least squares without the other joints, RMS {rms:.3f} A"
    return Independent(joint=joint, unit="A", way=way, law=law)


FIGURES: dict[str, Callable[[Path], list[Independent]]] = {
    "kuka-kr3-vel": lambda real: [
        kuka_kr3(real / "kuka-kr3/PTP_Vel", 3, (46.0, 229.0, 320.0), channel)
        for channel in ("DriveMotor", "Gear")
    ],
    "kuka-kr3-combined": lambda real: [
        kuka_kr3(real / "kuka-kr3/PTP_Combined", 2, (40.0, 53.0)),
        kuka_kr3(real / "kuka-kr3/PTP_Combined", 3, (31.0, 54.0)),
    ],
    "xarm6-j2": lambda real: [dashboard([real / "xarm6-j2"], 2, "Current", (40.0, 50.0))],
    "xarm6-j3": lambda real: [
        dashboard(sorted((real / "xarm6-j3").glob("?_*")), 3, "Current", (30.0, 40.0))
    ],
    "kinova-gen3-j4": lambda real: [
        dashboard([real / "kinova-gen3-j4"], 4, channel, (25.0,), skip=20.0)
        for channel in ("Torque", "Current")
    ],
    "damiao-5": lambda real: [damiao(real / "damiao-5")],
    "epos-drive1": lambda real: [epos(real / "epos-drive1")],
    "ur10e-j1": lambda real: [ur10e(real / "ur10e-j1")],
    "nist-ur5": lambda real: [nist(real / "nist-ur5", joint) for joint in (1, 2)],
}
"""Figures by the name of the case, given the folder of all logs."""
