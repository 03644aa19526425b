"""Units of torque in the documents of a diagnosis."""

from typing import NamedTuple

from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.effects.base import Effect
from frictioncli.effects.parameter import Parameter
from frictioncli.quantities import TORQUE

_OF_LOAD_CHANNEL = "N·m"
"""Unit of a load that the log has in a channel of its own."""


class TorqueUnits(NamedTuple):
    """Units of torque: that of the log, and that of the load, which may have its own channel."""

    torque: str
    load: str

    @classmethod
    def of_diagnosis(cls, diagnosis: Diagnosis) -> "TorqueUnits":
        """Return the units of a diagnosis; a load in a channel of its own is in N·m."""
        unit = diagnosis.torque_unit
        return cls(unit, _OF_LOAD_CHANNEL if diagnosis.base.has_load_channel else unit)

    def of(self, effect: Effect, parameter: Parameter) -> str:
        """Return the unit of a coefficient."""
        in_load = parameter.of_load or effect.channel == "load"
        return parameter.unit.replace(TORQUE, self.load if in_load else self.torque)
