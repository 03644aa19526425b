"""Planted effects of speed, load and temperature that have a counterpart in the catalogue.

No law equals the counterpart's: the physics is the same, the formula another, or its temperature
is one that no log has. ``tests/simulator/test_planted_laws.py`` measures by how much they differ.
"""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.simulator.planted.effect import (
    EffectDefinition,
    Range,
    either,
    log_uniform,
    uniform,
    zero_or,
)
from frictioncli.simulator.planted.operating_history import TIME_STEP, OperatingHistory
from frictioncli.simulator.planted.state import AddedTorque, State

NEVMERZHITSKIY = "Nevmerzhitskiy et al. 2019, doi:10.1155/2019/6931563"


def _stribeck(
    state: State, *, magnitude: float, velocity: float, exponent: float, shift: float
) -> AddedTorque:
    """Mixed lubrication: the share of solid contact falls with the Hersey number."""
    # speed times viscosity, which thins with the temperature
    hersey = state.speed / velocity * np.exp(-shift * (state.gear - 40.0))
    return AddedTorque(friction=magnitude / (1.0 + hersey**exponent))


STRIBECK = EffectDefinition(
    name="stribeck",
    equation="m / (1 + H^k), H = |v| / vs exp(-c (Tgear - 40))",
    magnitude="torque at rest [N·m]",
    parameters=(
        Range("velocity", log_uniform(3.0, 9.0), "deg/s", "speed vs of half contact at 40 °C"),
        Range("exponent", uniform(1.7, 2.3), "-", "exponent k of the Hersey number"),
        Range("shift", uniform(0.0, 0.02), "1/K", "thinning c with gear temperature"),
    ),
    law=_stribeck,
    source=(
        "Share of solid contact over the Hersey number, as a rational function; survey:"
        " Armstrong-Hélouvry et al. 1994, doi:10.1016/0005-1098(94)90209-7"
    ),
)


def _velocity_exponent(
    state: State,
    *,
    magnitude: float,
    exponent: float,
    bend: float,
    crossing: float,
    floor: float,
    thinning: float,
) -> AddedTorque:
    """Viscous friction with an exponent of speed other than one half, and not quite constant."""
    ratio = state.speed / crossing
    # at rest, as at a reversal, it is none
    power = ratio ** (exponent + bend * np.log(np.maximum(ratio, 1e-9)))
    thin = np.exp(-thinning * (state.motor - 40.0))
    viscous = floor + (1.0 - floor) * thin
    # the exact difference of two powers, not a derivative with respect to the exponent
    return AddedTorque(friction=magnitude * viscous * (power - np.sqrt(ratio)))


VELOCITY_EXPONENT = EffectDefinition(
    name="velocity_exponent",
    equation="m (f + (1 - f) exp(-d (Tmotor - 40))) (x^(p + b ln x) - x^0.5), x = |v| / vc",
    magnitude="viscous torque at the speed vc and 40 °C [N·m]",
    parameters=(
        Range("exponent", either(uniform(0.3, 0.4), uniform(0.65, 0.95)), "-", "p in place of 1/2"),
        Range("bend", uniform(0.001, 0.004), "-", "growth b of p with the logarithm of speed"),
        Range("crossing", log_uniform(15.0, 50.0), "deg/s", "speed at which both laws agree"),
        Range("floor", uniform(0.3, 0.7), "-", "share of the torque that does not thin"),
        Range("thinning", uniform(0.02, 0.06), "1/K", "rate at which the rest thins"),
    ),
    law=_velocity_exponent,
    source=f"Equation (13) of {NEVMERZHITSKIY}, where the exponent is fixed at 1/2",
)


def _linear_viscous(state: State, *, magnitude: float, rounding: float) -> AddedTorque:
    """Viscous friction proportional to speed, rounded near rest."""
    rounded = np.hypot(state.speed, rounding) - rounding
    return AddedTorque(friction=magnitude * rounded / 100.0)


LINEAR_VISCOUS = EffectDefinition(
    name="linear_viscous",
    equation="m (sqrt(v^2 + vr^2) - vr) / 100",
    magnitude="torque at 100 deg/s [N·m]",
    parameters=(Range("rounding", uniform(6.0, 14.0), "deg/s", "speed below which it is rounded"),),
    law=_linear_viscous,
    source=f"Equation (5) of {NEVMERZHITSKIY}, rounded at rest",
)


def _quadratic_drag(
    state: State, *, magnitude: float, exponent: float, thinning: float
) -> AddedTorque:
    """Churning of the lubricant, which grows about with the square of speed."""
    thin = np.exp(-thinning * (state.gear - 40.0))
    return AddedTorque(friction=magnitude * thin * (state.speed / 100.0) ** exponent)


QUADRATIC_DRAG = EffectDefinition(
    name="quadratic_drag",
    equation="m (|v| / 100)^n exp(-c (Tgear - 40))",
    magnitude="torque at 100 deg/s and 40 °C [N·m]",
    parameters=(
        Range("exponent", either(uniform(1.8, 1.9), uniform(2.1, 2.3)), "-", "exponent n"),
        Range("thinning", uniform(0.0, 0.01), "1/K", "fall with gear temperature"),
    ),
    law=_quadratic_drag,
    source="Drag of churned lubricant, near its turbulent limit",
)


def _coulomb_temperature(
    state: State, *, magnitude: float, rate: float, reference: float
) -> AddedTorque:
    """Coulomb friction that falls with motor temperature."""
    return AddedTorque(friction=magnitude * np.expm1(-rate * (state.motor - reference)))


COULOMB_TEMPERATURE = EffectDefinition(
    name="coulomb_temperature",
    equation="m (exp(-k (Tmotor - T0)) - 1)",
    magnitude="Coulomb torque that depends on temperature [N·m]",
    parameters=(
        Range("rate", log_uniform(0.005, 0.03), "1/K", "rate k of the fall"),
        Range("reference", uniform(30.0, 55.0), "°C", "temperature T0 with nothing added"),
    ),
    law=_coulomb_temperature,
    source=f"Linear term beside equation (16) of {NEVMERZHITSKIY}, here exponential",
)


def _load_linear(state: State, *, magnitude: float, rounding: float) -> AddedTorque:
    """Friction proportional to the absolute load, rounded at zero load."""
    rounded = np.hypot(state.load, rounding) - rounding
    return AddedTorque(friction=magnitude * rounded / 50.0)


LOAD_LINEAR = EffectDefinition(
    name="load_linear",
    equation="m (sqrt(L^2 + Lr^2) - Lr) / 50",
    magnitude="torque at a load of 50 N·m [N·m]",
    parameters=(Range("rounding", uniform(4.0, 8.0), "N·m", "load below which it is rounded"),),
    law=_load_linear,
    source=f"Equation (4) of {NEVMERZHITSKIY}, rounded at zero load",
)


def _load_velocity(
    state: State, *, magnitude: float, load_exponent: float, speed_exponent: float
) -> AddedTorque:
    """Friction that grows with load and speed together."""
    load = (np.abs(state.load) / 50.0) ** load_exponent
    speed = (state.speed / 50.0) ** speed_exponent
    return AddedTorque(friction=magnitude * load * speed)


LOAD_VELOCITY = EffectDefinition(
    name="load_velocity",
    equation="m (|L| / 50)^a (|v| / 50)^b",
    magnitude="torque at 50 N·m and 50 deg/s [N·m]",
    parameters=(
        Range("load_exponent", uniform(1.6, 2.2), "-", "exponent a of the load"),
        Range("speed_exponent", uniform(0.4, 0.8), "-", "exponent b of the speed"),
    ),
    law=_load_velocity,
    source=f"Product of the load and speed terms of equation (16) of {NEVMERZHITSKIY}",
)


def _load_temperature(
    state: State, *, magnitude: float, reference: float, width: float
) -> AddedTorque:
    """Friction by load that falls with temperature."""
    fall = np.tanh((state.motor - reference) / width)
    return AddedTorque(friction=-magnitude * np.square(state.load / 50.0) * fall)


LOAD_TEMPERATURE = EffectDefinition(
    name="load_temperature",
    equation="-m (L / 50)^2 tanh((Tmotor - T0) / w)",
    magnitude="torque at 50 N·m that is lost when hot [N·m]",
    parameters=(
        Range("reference", uniform(35.0, 50.0), "°C", "temperature T0 with nothing added"),
        Range("width", uniform(12.0, 25.0), "K", "width w of the fall"),
    ),
    law=_load_temperature,
    source=f"Product of the load and temperature terms of equation (16) of {NEVMERZHITSKIY}",
)


def gear_minus_motor(
    operation: OperatingHistory,
    *,
    magnitude: float,
    heating: float,
    loss: float,
    stirring: float,
) -> Array:
    r"""Return gear minus motor temperature on the time grid of the history.

    Parameters
    ----------
    operation : OperatingHistory
        Temperatures and dissipated power of the run.
    magnitude : float
        Time constant of conduction from the motor at rest. [min]
    heating : float
        Heating of the gear per energy dissipated in the joint. [K/kJ]
    loss : float
        Time constant of the gear's own loss to ambient. [min]
    stirring : float
        Growth of both conductances while the joint moves. [-]

    Returns
    -------
    ndarray, shape (times,)
        Temperature difference. [K]

    Notes
    -----
    .. math:: \dot T_g = (1 + s) [(T_m - T_g)/\tau - (T_g - T_a)/\tau_a] + k P

    with s = 0 at rest: stirred grease and moved air carry more heat, which no network of constant
    conductances has.
    A heated gear is warmer than the motor while the joint heats, so the loop between heating and
    cooling has the other sign than that of a gear which only lags. The heat that other effects
    dissipate does not count.
    """
    motor = operation.temperatures.get("motor", operation.temperatures["motor sensor"])
    stirred = np.where(operation.heat > 0.0, 1.0 + stirring, 1.0)
    inward, outward = stirred / (60.0 * magnitude), stirred / (60.0 * loss)
    rate = inward + outward
    target = (
        inward * motor + outward * operation.ambient + heating / 1000.0 * operation.heat
    ) / rate
    memory = np.exp(-rate * TIME_STEP)
    # The grid's last step is shorter; the gear hardly changes in it.
    driven = (1.0 - memory[1:]) * (target[1:] + target[:-1]) / 2.0
    gear = [float(motor[0])]
    for kept, new in zip(memory[1:].tolist(), driven.tolist(), strict=True):
        gear.append(kept * gear[-1] + new)
    return np.array(gear) - motor


def _thermal_lag(
    state: State, *, magnitude: float, heating: float, loss: float, stirring: float
) -> AddedTorque:
    """Friction at a hidden gear temperature in place of the motor temperature."""
    difference = gear_minus_motor(
        state.operation, magnitude=magnitude, heating=heating, loss=loss, stirring=stirring
    )
    shift = state.operation.at(state.time, difference)
    shifted = {name: value + shift for name, value in state.temperatures.items()}
    with_lag = state.joint.friction(load=state.load, speed=state.speed, temperatures=shifted)
    without = state.joint.friction(
        load=state.load, speed=state.speed, temperatures=state.temperatures
    )
    return AddedTorque(friction=with_lag - without)


THERMAL_LAG = EffectDefinition(
    name="thermal_lag",
    equation=(
        "f(Tgear) - f(Tmotor), dTgear/dt = (1 + s) ((Tmotor - Tgear) / tau"
        " - (Tgear - Tambient) / ta) + k P, s = 0 at rest"
    ),
    magnitude="time constant tau of conduction from the motor at rest [min]",
    parameters=(
        Range("heating", zero_or(log_uniform(0.08, 0.22)), "K/kJ", "gear heating k per energy"),
        Range("loss", log_uniform(600.0, 3000.0), "min", "time constant ta of its own loss"),
        Range("stirring", uniform(0.2, 0.5), "-", "growth s of the conductances in motion"),
    ),
    law=_thermal_lag,
    source=(
        f"Lumped heat balance of motor and gear; the loop is figures 5 and 6 of {NEVMERZHITSKIY};"
        " hidden joint temperature: Simoni et al. 2017, doi:10.1017/S0263574717000509"
    ),
)

SPEED_AND_LOAD_EFFECTS = (
    STRIBECK,
    VELOCITY_EXPONENT,
    LINEAR_VISCOUS,
    QUADRATIC_DRAG,
    COULOMB_TEMPERATURE,
    LOAD_LINEAR,
    LOAD_VELOCITY,
    LOAD_TEMPERATURE,
    THERMAL_LAG,
)
"""Definitions in the order of :data:`frictioncli.simulator.planted.catalogue.EFFECTS`."""
