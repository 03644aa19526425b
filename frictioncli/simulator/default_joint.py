"""Default constants of the simulated joint: joint 2 of a small industrial arm, as in the paper.

The arm is assumed. Zones and thermal network were tuned so that the simulation reproduces the
findings of the paper: heating from 25 to 65 °C in about 100 min and natural cooling in about
300 min, branches of heating and cooling that differ over either measured temperature and over
every mix of both, equation (16) fitted to the means of both branches near the published
parameters, an error of 1 to 2 N·m at about eight corrections, and cold friction that follows the
square root of the speed down to the slowest sweep. The zones' speed exponents are near 1/2 for
that. Most of the decrease with temperature happens in the gear, which is not measured and lags
both sensors: equation (16) of any mix of motor and housing leaves 5 N·m or more, of the gear's
temperature 1 N·m. Of the paper's parameters only the load coefficient is an input.
"""

from frictioncli.simulator.arm import Arm, Body
from frictioncli.simulator.friction_zones import LubricatedZone
from frictioncli.simulator.joint import HeatEntry, SimulatedJoint
from frictioncli.simulator.motion_profile import Servo
from frictioncli.simulator.noise import SimulatedNoise
from frictioncli.simulator.paper_protocol import PaperProgram
from frictioncli.simulator.recording import Logger
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.thermal_history import HOUSING, MOTOR
from frictioncli.simulator.thermal_network import ThermalLink, ThermalNetwork, ThermalNode

HOUSING_HEAT_SHARE = 0.68
"""Share of the remaining heat that enters at the housing; the rest enters at the gear [-]."""

COPPER_LOSS = 0.0013
"""Copper loss per square of the control torque [W/(N·m)²]."""

BODIES = (
    Body(name="upper arm", mass=9.5, along=0.21, across=0.02, own_inertia=0.12),
    Body(name="forearm with its drives", mass=8.0, along=0.47, across=-0.05, own_inertia=0.10),
    Body(name="wrist", mass=3.0, along=0.75, across=-0.04, own_inertia=0.02),
)
"""Bodies that turn with joint 2, with a straight elbow."""

ROTOR_INERTIA = 1.2
"""Inertia of rotor and gear input, referred to the joint [kg·m²]."""

ZONES = (
    LubricatedZone(
        name="motor bearings and seals",
        node="motor",
        coulomb=1.4,
        viscous_floor=0.44,
        viscous=0.2,
        thinning=0.083,
        speed_exponent=0.455,
    ),
    LubricatedZone(
        name="gear mesh",
        node="gear",
        coulomb=4.9,
        load_square=0.0014,
        viscous_floor=1.67,
        viscous=3.17,
        thinning=0.0422,
        speed_exponent=0.466,
    ),
    LubricatedZone(
        name="output bearing and seal",
        node=HOUSING,
        coulomb=4.3,
        viscous_floor=1.12,
        viscous=0.075,
        thinning=0.055,
        speed_exponent=0.575,
    ),
)
"""Friction zones. The gear's grease causes most of the decrease with temperature."""

NETWORK = ThermalNetwork(
    nodes=(
        ThermalNode(name=MOTOR, capacity=20.0, to_ambient=0.0),
        ThermalNode(name="motor", capacity=6100.0, to_ambient=0.515),
        ThermalNode(name="gear", capacity=7850.0, to_ambient=0.0),
        ThermalNode(name=HOUSING, capacity=10300.0, to_ambient=1.54),
    ),
    links=(
        ThermalLink(first=MOTOR, second="motor", conductance=0.0445),
        ThermalLink(first="motor", second="gear", conductance=0.85),
        ThermalLink(first="gear", second=HOUSING, conductance=0.58),
        ThermalLink(first="motor", second=HOUSING, conductance=0.71),
    ),
)
"""Thermal network; the time constant of a node is its capacity over its conductances.

The sensor lags the motor by seven and a half minutes. The gear, which is not measured, has a time
constant of its own of 90 min: it is colder than the motor while heating and warmer while cooling.
"""

SERVO = Servo(acceleration=400.0, frequency=6.0, damping=0.45)
"""Servo of the joint."""

_DEFAULTS = SynthesisSettings()

PROGRAM = PaperProgram(
    sweep_speeds=(2.3, 4.2, 7.6, 12.4, 19.1, 28.0, 39.4, 52.0, 67.5, 84.0, 101.2),
    cycle_speeds=(19.1, 39.4, 67.5, 101.2),
    heating_speed=180.0,
    angles=(0.0, 180.0),
    lowest=_DEFAULTS.lowest,
    highest=_DEFAULTS.highest,
    dwell=0.4,
    pre_trigger=0.6,
    lead=1.0,
    pause=5.0,
)
"""Algorithms 1 and 2 of the paper."""

NOISE = SimulatedNoise(
    white=0.6,
    correlated=0.4,
    correlation_time=0.15,
    slow=0.35,
    slow_time=1200.0,
    per_pair=0.15,
)
"""Random parts of the log."""

LOGGER = Logger(
    interval=0.012,
    position_step=0.001,
    torque_step=0.01,
    motor_step=1.0,
    housing_step=0.1,
    sign=1,
)
"""Sampling and resolutions of the trace."""


def joint(*, payload: float, motor_heat_share: float) -> SimulatedJoint:
    """Return the simulated joint.

    Parameters
    ----------
    payload : float
        Mass at the flange. [kg]
    motor_heat_share : float
        Share of the dissipated heat that enters at the motor. [-]
    """
    elsewhere = 1.0 - motor_heat_share
    return SimulatedJoint(
        arm=Arm(
            bodies=BODIES,
            payload=Body(name="payload", mass=payload, along=0.85, across=-0.03),
            rotor_inertia=ROTOR_INERTIA,
        ),
        servo=SERVO,
        zones=ZONES,
        network=NETWORK,
        heat=HeatEntry(
            copper_loss=COPPER_LOSS,
            shares={
                "motor": motor_heat_share,
                "gear": elsewhere * (1.0 - HOUSING_HEAT_SHARE),
                HOUSING: elsewhere * HOUSING_HEAT_SHARE,
            },
        ),
    )
