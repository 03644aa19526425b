"""A lag of the gear as ``diagnosis.json`` states it: the network that was found, in words."""

from msgspec import structs

from frictioncli.diagnosis.documents.document import CauseRecord
from frictioncli.diagnosis.documents.extended_model import ParameterRecord
from frictioncli.diagnosis.thermal.estimate import ThermalEstimate
from frictioncli.diagnosis.thermal.statement import temperature_statement
from frictioncli.effects import thermal_lag


def record_of_lag(record: CauseRecord, thermal: ThermalEstimate, unit: str) -> CauseRecord:
    """Return the record of a lag of the gear with the network that was found.

    Parameters
    ----------
    record : CauseRecord
        The cause, with all parameters of the effect ``thermal_lag``.
    thermal : ThermalEstimate
        The temperature of the gear.
    unit : str
        Unit of torque.
    """
    parameters = {}
    coefficients = {one.name: one for one in thermal_lag.EFFECT.coefficients}
    present = {*thermal.estimates, *(["housing_share"] if thermal.chosen.is_housing else [])}
    for name, one in record.parameters.items():
        if name not in present:
            continue
        if name in coefficients and one.ci95 is not None:
            low, high = coefficients[name].lower, coefficients[name].upper
            one = structs.replace(one, ci95=(max(one.ci95[0], low), min(one.ci95[1], high)))
        parameters[name] = one
    for name, stated in thermal.estimates.items():
        if name.endswith("time_constant"):
            interval = (stated.low, stated.high)
            parameters[name] = ParameterRecord(
                estimate=stated.value, ci95=interval, unit=stated.unit
            )
    return structs.replace(
        record, statement=temperature_statement(thermal, unit), parameters=parameters
    )
