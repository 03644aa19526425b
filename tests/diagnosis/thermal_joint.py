"""Torques of a joint whose friction is that of a gear in a thermal network, by integrating it."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp

SPEEDS = (20.0, 45.0, 70.0, 100.0)
TAU_C, ALPHA, BETA, GAMMA, DELTA = 10.6, 0.0014, 3.5, 15.7, 0.056
BINS = np.arange(12.5, 180.0, 15.0)
GRAVITY = 60.0 * np.cos(np.radians(BINS)) + 12.0 * np.sin(np.radians(BINS))


@dataclass(frozen=True)
class Network:
    """Heat capacities [J/K], conductances [W/K] and the share of the heat that enters the motor."""

    motor: float = 5200.0
    gear: float = 7500.0
    housing: float = 9000.0
    motor_gear: float = 3.0
    gear_housing: float = 1.5
    housing_ambient: float = 1.7
    motor_ambient: float = 0.6
    motor_heat: float = 0.8
    node: str = "gear"


def friction(speed, temperature, load=0.0):
    """Equation (16)."""
    viscous = BETA + GAMMA * np.exp(-DELTA * temperature)
    return TAU_C + ALPHA * np.square(load) + viscous * np.sqrt(speed)


class _Joint:
    """Temperatures of motor, gear and housing, moved on in time."""

    def __init__(self, network, ambient):
        self.network, self.ambient = network, ambient
        self.state, self.time = np.full(3, ambient), 0.0

    def move(self, seconds, speed):
        """Move at a speed [deg/s], or stand at 0."""
        n = self.network

        def slope(_, state):
            motor, gear, housing = state
            place = {"motor": motor, "gear": gear, "housing": housing}[n.node]
            power = friction(speed, place, 45.0) * np.radians(speed) if speed else 0.0
            to_gear = n.motor_gear * (motor - gear)
            to_housing = n.gear_housing * (gear - housing)
            return [
                (n.motor_heat * power - to_gear - n.motor_ambient * (motor - self.ambient))
                / n.motor,
                ((1 - n.motor_heat) * power + to_gear - to_housing) / n.gear,
                (to_housing - n.housing_ambient * (housing - self.ambient)) / n.housing,
            ]

        self.state = solve_ivp(slope, (0.0, seconds), self.state, rtol=1e-7).y[:, -1]
        self.time += seconds


def torques(network, *, seed=0, runs=2, noise=0.25, highest=58.0, unlogged=0.0):
    """Return runs of heating at 100 deg/s and natural cooling, and the gear's temperatures.

    Four pairs are measured about every degree. The last run follows some seconds of motion that no
    log has. Noise is white per bin and per pair, with a slow
    drift of 0.1 N·m. The temperature of the gear is that in each pair.
    """
    generator, rows, gear = np.random.default_rng(seed), [], []
    for run in range(runs):
        joint = _Joint(network, 21.0 + 2.0 * run)
        if run == runs - 1 and unlogged:
            joint.move(unlogged, 100.0)
            joint.time = 0.0
        pair, heating, drift = 0, True, 0.0
        measured = -np.inf
        while True:
            if abs(joint.state[0] - measured) >= 1.0:
                measured = joint.state[0]
                for speed in SPEEDS:
                    duration = 360.0 / speed
                    joint.move(duration / 2, speed)
                    motor, inside, cover = joint.state
                    gear.append(inside)
                    place = dict(zip(("motor", "gear", "housing"), joint.state, strict=True))
                    drift = 0.98 * drift + 0.02 * generator.normal()  # 0.1 N·m RMS
                    torque = friction(speed, place[network.node], GRAVITY)
                    torque = torque + drift + noise / 2 * generator.normal()
                    torque = torque + noise * generator.normal(size=len(BINS))
                    rows += [
                        (run, pair, speed, joint.time, motor, cover, angle, one, load)
                        for angle, one, load in zip(BINS, torque, GRAVITY, strict=True)
                    ]
                    pair += 1
                    joint.move(duration / 2, speed)
            if heating:
                joint.move(60.0, 100.0)
                heating = joint.state[0] < highest
            else:
                joint.move(60.0, 0.0)
                if joint.state[0] < joint.ambient + 8.0:
                    break
    names = "run pair speed time motor_temperature housing_temperature position friction_torque"
    table = pd.DataFrame(rows, columns=[*names.split(), "load_torque"])
    table["load_torque"] += noise * generator.normal(size=len(table))
    table = table.assign(
        run="day" + table["run"].astype(str),
        joint=2,
        load=np.nan,
        payload=np.nan,
        motor_temperature_reading=np.round(table["motor_temperature"]),
        torque_forward=table["load_torque"] + table["friction_torque"],
        torque_reverse=table["load_torque"] - table["friction_torque"],
    )
    return table, np.array(gear)
