"""Simulated logs that hold the positions of other joints, one of which disturbs the torque."""

import numpy as np

from frictioncli.simulator.nuisances.motion_and_torque import other_joint_torque
from frictioncli.simulator.run import run_setup
from frictioncli.simulator.synthesize import synthesize
from frictioncli.simulator.trace_writer import ENCODING

SPEED = 20.0
"""Speed of the first of the other joints, the second has half of it. [deg/s]"""


def write_logs(folder, settings, *, moving=True, joints=(1, 4)):
    """Write simulated traces with positions of other joints, which turn while they add torque.

    Returns the time for which they turn, by run and file [s].
    """
    synthesize(folder, settings)
    turned = {}
    for number, seed in enumerate(np.random.SeedSequence(settings.seed).spawn(settings.runs)):
        setup = run_setup(settings, number, seed)
        traces = sorted(
            path for path in (folder / setup.name).glob("*.csv") if path.stem != "manifest"
        )
        for series, path in enumerate(traces):
            header, *lines = path.read_bytes().decode(ENCODING).splitlines()
            time = np.array([float(line.split(";")[0]) for line in lines])
            disturbed = other_joint_torque(setup.nuisances, number, series, time) != 0
            turned[setup.name, path.name] = float(disturbed.sum() * np.median(np.diff(time)))
            angle = np.cumsum(np.gradient(time) * SPEED * disturbed) * moving
            header += "".join(f";AxisPos_Act{joint}[°]" for joint in joints)
            lines = [
                line + "".join(f";{value / part:.3f}" for part in range(1, len(joints) + 1))
                for line, value in zip(lines, angle, strict=True)
            ]
            path.write_bytes(("\n".join([header, *lines, ""])).encode(ENCODING))
    return turned
