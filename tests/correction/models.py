"""The published model, and cycles whose temperature reads too low, for tests of corrections."""

from frictioncli.correction.evaluation import simulate
from frictioncli.correction.settings import (
    CorrectionSettings,
    ScheduleSettings,
)
from frictioncli.model.document import FrictionModel, InputRange, ParameterEstimate
from frictioncli.model.friction import PUBLISHED
from frictioncli.model.noise import Noise
from tests.equation_16 import torques


def published_model(**changes):
    values = {name: getattr(PUBLISHED, name) for name in PUBLISHED.__dataclass_fields__} | changes
    estimates = {
        name: ParameterEstimate(estimate=value, ci95=None, unit="", determined=True)
        for name, value in values.items()
    }
    return FrictionModel(
        joint=2,
        method="joint",
        temperature="motor",
        torque_unit="N·m",
        torque_side="joint",
        sign=1,
        parameters=estimates,
        rmse=0.0,
        n_pairs=1,
        noise=Noise(point=0.1, pair=0.1, drift=0.1, drift_time=1.0),
        correlation={},
        range=InputRange(),
    )


QUIET = {"point": 1e-9, "pair": 0.0, "drift": 0.0}


def shifted(offset):
    """A cycle whose motor temperature reads ``offset`` °C less than what friction obeys."""
    table = torques(0, **QUIET)
    return table.assign(
        motor_temperature=table["motor_temperature"] - offset,
        motor_temperature_reading=table["motor_temperature_reading"] - offset,
    )


def simulated(table, model=None, **schedule):
    return simulate(
        table, model or published_model(), CorrectionSettings(), ScheduleSettings(**schedule)
    )
