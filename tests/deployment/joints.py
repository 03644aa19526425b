"""Joints as they are deployed, for tests: published, extended, and with random parameters."""

from dataclasses import replace

import numpy as np

from frictioncli.correction.settings import ScheduleSettings
from frictioncli.deployment.deployed_model import DeployedModel
from frictioncli.deployment.extension import DeployedExtension
from frictioncli.deployment.gear_temperature import GearLag
from frictioncli.diagnosis.documents.extended_model import FittedEffect
from frictioncli.effects import BY_NAME
from frictioncli.model.document import InputRange, ParameterEstimate
from frictioncli.model.friction import PUBLISHED
from tests.correction.models import published_model

UNITS = {
    "tau_c": "N·m",
    "alpha": "1/(N·m)",
    "beta": "N·m/(deg/s)^0.5",
    "gamma": "N·m/(deg/s)^0.5",
    "delta": "1/°C",
}
RANGE = InputRange(
    speed=(2.3, 101.2),
    load=(-95.0, 90.0),
    temperature=(20.0, 65.0),
    position=(2.5, 177.5),
)

LAG = GearLag(
    time_constant=1500.0,
    time_constant_ci95=(900.0, 2600.0),
    lag_share=0.5,
    friction_heating=6.0,
    housing_share=0.1,
    housing_lag_share=0.3,
    housing_time_constant=None,
    reference_power=5000.0,
    start_sd=3.0,
)


def joint(*, extension=None, unit="N·m", schedule=None, **parameters):
    """The published joint, with what is told in place of its own."""
    model = published_model(**parameters)
    units = {name: text.replace("N·m", unit) for name, text in UNITS.items()}
    estimates = {
        name: ParameterEstimate(
            estimate=entry.estimate,
            ci95=(0.9 * entry.estimate, 1.1 * entry.estimate) if entry.estimate else None,
            unit=units[name],
            determined=entry.estimate != 0,
            reason=None if entry.estimate else "temperature spans 1 °C",
        )
        for name, entry in model.parameters.items()
    }
    return DeployedModel(
        model=replace(model, parameters=estimates, range=RANGE, torque_unit=unit),
        schedule=schedule or ScheduleSettings(),
        correction_speed=67.5,
        extension=extension,
        origin={"model.json": "0" * 64},
        version="1.2.3",
    )


def effect(name, coefficient, **shape):
    return FittedEffect(effect=BY_NAME[name], shape=shape, coefficients=np.array([coefficient]))


TERMS = (
    effect("stribeck", 4.0, velocity=6.0, exponent=1.3, shift=0.02),
    effect("linear_viscous", 0.05),
    effect("quadratic_drag", 2.0),
    effect("coulomb_temperature", -0.7),
    effect("load_linear", 0.03),
    effect("load_velocity", 0.1),
    effect("load_temperature", -0.2, bend=0.03),
)


def extended(terms=TERMS, gear=LAG):
    return DeployedExtension(
        about=PUBLISHED,
        parameters=replace(PUBLISHED, tau_c=9.9, alpha=0.0015, beta=3.0, gamma=20.0, delta=0.07),
        gear=gear,
        terms=terms,
        left_out={"drift": "depends on the time since the first log"},
    )


def day(seed, length=400):
    """What a controller sees: times [s], motor and housing [°C], loads, speeds, measured pairs."""
    generator = np.random.default_rng(seed)
    time = np.cumsum(generator.choice([0.0, 0.012, 15.0, 60.0, 240.0], length))
    motor = 30 + np.cumsum(generator.normal(0.05, 0.4, length))
    motor = np.round(motor) if seed % 2 else motor
    housing = motor - 3 + generator.normal(0, 1, length)
    housing[generator.random(length) < 0.1] = np.nan
    return {
        "time": time,
        "motor": motor,
        "registered": np.round(motor),
        "housing": housing,
        "power": generator.uniform(0, 8000, length),
        "load": generator.uniform(-90, 90, length),
        "speed": generator.uniform(0.5, 110, length),
        # now and then less than any temperature gives
        "friction": np.where(
            generator.random(length) < 0.15, 1.0, generator.uniform(40, 90, length)
        ),
    }
