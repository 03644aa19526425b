"""Samples of joints in motion of any kind, by formulas of the tests' own."""

import numpy as np
import pyarrow as pa
from scipy.signal import lfilter

PERIOD = 0.01
INERTIA = 4.0
"""Inertia. [kg·m²]"""

GRAVITY = (55.0, -12.0)
"""Torque by cosine and sine of the angle. [N·m]"""

OFFSET = 1.5
"""Constant torque. [N·m]"""


def sines(duration, generator, *, period=PERIOD, centre=20.0, amplitude=55.0):
    """Time, position, velocity and acceleration of five sines of random phase. [s], [deg], ..."""
    time = np.arange(0, duration, period)
    frequency = np.array([0.05, 0.11, 0.17, 0.26, 0.41])
    size = amplitude * np.array([1.0, 0.5, 0.3, 0.2, 0.1])
    phase = generator.uniform(0, 2 * np.pi, 5)
    rate = 2 * np.pi * frequency
    angle = rate * time[:, np.newaxis] + phase
    return (
        time,
        centre + np.sin(angle) @ size,
        np.cos(angle) @ (size * rate),
        -np.sin(angle) @ (size * rate**2),
    )


def autoregressive(generator, rows, size, memory):
    """Noise of a standard deviation whose neighbours are correlated."""
    drive = generator.standard_normal(rows) * np.sqrt(1 - memory**2)
    drive[0] /= np.sqrt(1 - memory**2)
    return size * lfilter([1.0], [1.0, -memory], drive)


def friction(speed, load, temperature, *, tau_c=8.0, alpha=0.002, beta=2.0, gamma=0.0, delta=0.05):
    """Friction of equation (16), term by term. [N·m]"""
    falling = gamma * np.exp(-delta * np.asarray(temperature))
    return tau_c + alpha * load**2 + (beta + falling) * np.sqrt(speed)


def torque(
    motion, *, temperature=30.0, gravity=GRAVITY, offset=OFFSET, inertia=INERTIA, sign=1, **law
):
    """Torque of the joint without noise. [N·m]"""
    _, position, velocity, acceleration = motion
    angle = np.radians(position)
    load = gravity[0] * np.cos(angle) + gravity[1] * np.sin(angle) + offset
    opposed = sign * np.sign(velocity) * friction(np.abs(velocity), load, temperature, **law)
    return inertia * np.radians(acceleration) + load + opposed


def noisy_log(seed, *, duration=240, **law):
    """Return samples of sines with white and correlated noise of torque, and a coarse encoder."""
    generator = np.random.default_rng(seed)
    motion = sines(duration, generator)
    rows = len(motion[0])
    noise = autoregressive(generator, rows, 0.5, 0.0) + autoregressive(generator, rows, 0.5, 0.95)
    time, position, velocity, acceleration = motion
    logged = (
        time,
        np.round(position / 0.001) * 0.001,
        velocity + 0.05 * generator.standard_normal(rows),
        acceleration,
    )
    return samples(logged, torque(motion, **law) + noise)


def samples(motion, torque, **columns):
    """Return a table of samples of one joint and recording."""
    time, position, velocity, _ = motion
    labels = {"run": "day1", "recording": "log"}
    rows = {
        "joint": np.ones(len(time), dtype=np.int16),
        "time": time,
        "position": position,
        "velocity": velocity,
        "torque": torque,
    } | columns
    return pa.table(
        {name: pa.array([value] * len(time)).dictionary_encode() for name, value in labels.items()}
        | {name: pa.array(values, from_pandas=True) for name, values in rows.items()}
    )
