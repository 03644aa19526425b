"""A lag of the gear as ``diagnosis.json`` states it: the network that was found, in words."""

from msgspec import structs

from frictioncli.diagnosis.documents.document import CauseRecord
from frictioncli.diagnosis.documents.extended_document import ParameterRecord
from frictioncli.diagnosis.thermal.estimate import ThermalEstimate
from frictioncli.diagnosis.thermal.statement import temperature_statement


def record_of_lag(record: CauseRecord, thermal: ThermalEstimate, unit: str) -> CauseRecord:
    """Return the record of a lag of the gear with the network that was found.

    Its parameters are those of the sentence, with the same intervals.

    Parameters
    ----------
    record : CauseRecord
        The cause, with all parameters of the effect ``thermal_lag``.
    thermal : ThermalEstimate
        The temperature of the gear.
    unit : str
        Unit of torque.
    """
    present = {*thermal.estimates, *(["housing_share"] if thermal.chosen.is_housing else [])}
    parameters = {name: one for name, one in record.parameters.items() if name in present}
    parameters |= {
        name: ParameterRecord(estimate=one.value, ci95=(one.low, one.high), unit=one.unit)
        for name, one in thermal.estimates.items()
    }
    return structs.replace(
        record, statement=temperature_statement(thermal, unit), parameters=parameters
    )
