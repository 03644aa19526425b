"""What nuisances do to the motion, to the logged position and to the logged torque."""

import math

import numpy as np
from scipy.signal import lfilter

from frictioncli.arrays import Array
from frictioncli.simulator.motion_profile import MotionProfile
from frictioncli.simulator.nuisances.definition import Nuisances
from frictioncli.simulator.planted.state import STANDING_SPEED

_STREAM = 2_100_000
"""Keeps the draw of disturbed recordings apart from other random numbers."""


def clock_factor(nuisances: Nuisances) -> float:
    """Return true over logged time between samples: the factor on the logged velocity [-]."""
    return 1.0 + nuisances.size("velocity_scale") / 100.0


def rippled(motion: MotionProfile, nuisances: Nuisances) -> MotionProfile:
    r"""Return a motion whose speed ripples with the angle.

    Notes
    -----
    With the commanded angle s, :math:`q = s - (\epsilon / N) \cos(N s + p)`, so that
    :math:`\dot q = \dot s (1 + \epsilon \sin(N s + p))`; the acceleration is its exact derivative.
    """
    size = nuisances.size("speed_ripple") / 100.0
    if size == 0.0:
        return motion
    order = nuisances.parameter("speed_ripple", "order")
    angle = order * np.radians(motion.position) + nuisances.parameter("speed_ripple", "phase")
    factor = 1.0 + size * np.sin(angle)
    bend = size * order * np.cos(angle) * np.radians(np.square(motion.velocity))
    return MotionProfile(
        position=motion.position - np.degrees(size / order) * np.cos(angle),
        velocity=motion.velocity * factor,
        acceleration=motion.acceleration * factor + bend,
    )


def logged_position(motion: MotionProfile, nuisances: Nuisances) -> Array:
    """Return the position with its offset between the directions [deg]."""
    half = nuisances.size("backlash") / 2.0
    return np.asarray(motion.position + half * np.clip(motion.velocity / STANDING_SPEED, -1.0, 1.0))


def filtered(torque: Array, interval: float, nuisances: Nuisances) -> Array:
    """Return samples ``interval`` s apart behind a first-order filter, from its steady state."""
    time_constant = nuisances.size("torque_filter")
    if time_constant == 0.0 or not len(torque):
        return torque
    # exact for a signal that is linear between its samples
    ratio = interval / time_constant
    memory = math.exp(-ratio)
    past = (1.0 - memory) / ratio - memory
    now = 1.0 - (1.0 - memory) / ratio
    start = [(past + memory) * torque[0]]
    return np.asarray(lfilter([now, past], [1.0, -memory], torque, zi=start)[0])


def other_joint_torque(nuisances: Nuisances, run: int, series: int, since_start: Array) -> Array:
    """Return the torque of another joint that moves when a recording begins.

    Parameters
    ----------
    nuisances : Nuisances
        What the log has.
    run, series : int
        Numbers of the run and of its recording, which decide whether it is disturbed.
    since_start : ndarray
        Time since the recording's first sample. [s]

    Returns
    -------
    ndarray
        Torque, the same in both directions; 0 once the other joint stands. [N·m]
    """
    size = nuisances.size("other_joint")
    if size == 0.0:
        return np.zeros(since_start.shape)
    key = (_STREAM, run, series)
    seed = np.random.SeedSequence(nuisances.seed, spawn_key=key)
    drawn = np.random.Generator(np.random.PCG64(seed)).random()
    if drawn >= nuisances.parameter("other_joint", "share"):
        return np.zeros(since_start.shape)
    share = np.clip(since_start / nuisances.parameter("other_joint", "duration"), 0.0, 1.0)
    return np.asarray(size * (0.5 + 0.5 * np.cos(np.pi * share)))
