"""Heating and cooling phases, in which corrections are simulated."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.correction.replay import PhaseData, phase_data
from frictioncli.correction.settings import MIDDLE_SPEED, CorrectionSettings
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import FrictionModel
from frictioncli.model.late_torque import without_delay
from frictioncli.model.zero_load import friction_at_zero_load


@dataclass(frozen=True, slots=True)
class CorrectionPhase:
    """One heating or cooling phase.

    Attributes
    ----------
    run, name : str
        Name of the run and of the phase.
    pairs : DataFrame
        Rows of :func:`frictioncli.model.zero_load.friction_at_zero_load`.
    data : PhaseData
        The same as arrays.
    """

    run: str
    name: str
    pairs: pd.DataFrame
    data: PhaseData


def correction_phases(
    torques: pd.DataFrame, model: FrictionModel, settings: CorrectionSettings
) -> list[CorrectionPhase]:
    """Return the heat-up and cool-down phases of a joint, ordered by run and time.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the joint.
    model : FrictionModel
        Model of the joint.
    settings : CorrectionSettings
        Speed of corrections and degree of smoothing.

    Returns
    -------
    list of CorrectionPhase
        The phases.

    Raises
    ------
    NotEnoughData
        If the model does not depend on temperature, or there is no such phase.
    """
    if not model.knows_temperature:
        why = model.parameters["delta"].reason or "its friction does not fall with temperature"
        raise NotEnoughData(
            f"joint {model.joint}: the model has no dependence of friction on temperature"
            f" ({why}), so a correction cannot be computed"
        )
    freed = without_delay(torques, model.late_by)
    pairs = friction_at_zero_load(freed, model.friction.alpha)
    pairs = pairs[pairs["motor_temperature"].notna()]
    if "motor_temperature_reading" not in pairs:
        pairs = pairs.assign(motor_temperature_reading=np.nan)
    stretch = (pairs["phase"] != pairs["phase"].shift()) | (pairs["run"] != pairs["run"].shift())
    thermal = pairs["phase"].isin(["heat-up", "cool-down"])
    if not thermal.any():
        raise NotEnoughData(
            f"joint {model.joint}: no heat-up or cool-down of 5 °C or more in the log, so the"
            " correction of temperature cannot be simulated; log a thermal cycle"
        )
    speed = settings.correction_speed
    if speed is None:
        speed = MIDDLE_SPEED * float(pairs.loc[thermal, "speed"].max())
    phases = []
    for _, group in pairs[thermal].groupby(stretch.cumsum()[thermal], sort=True):
        data = phase_data(group, correction_speed=speed, degree=settings.smoothing_degree)
        head = group.iloc[0]
        phases.append(CorrectionPhase(str(head["run"]), str(head["phase"]), group, data))
    return phases
