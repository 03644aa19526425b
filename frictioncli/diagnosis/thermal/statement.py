"""What an estimated temperature says, in words."""

from collections.abc import Mapping

from frictioncli.diagnosis.thermal.estimate import ThermalEstimate, ThermalParameter
from frictioncli.wording import number_text, quantity_text

_MOSTLY = 0.05
"""A mix is called by one of its parts where the other has no more than this share."""

_ABSENT = 0.01
"""Shares, and degrees, below this are not told."""

_UNKNOWN = 0.9
"""Width of the interval of a share from which on the share is not determined."""


def temperature_statement(estimate: ThermalEstimate, unit: str) -> str:
    """Return what is said of the temperature of friction, with the rivals that a user can choose.

    Parameters
    ----------
    estimate : ThermalEstimate
        The temperature.
    unit : str
        Unit of torque.
    """
    name = estimate.chosen.structure.name
    if name in ("housing", "mix"):
        return _mix_text(estimate)
    return " ".join(filter(None, [_network_text(estimate), _alternative_text(estimate, unit)]))


def _mix_text(estimate: ThermalEstimate) -> str:
    """Return that a temperature which is measured, or a mix, explains friction."""
    share = float(estimate.chosen.fit.coefficients[2])
    if share > 1 - _MOSTLY:
        return "Friction follows the temperature of the housing: use --temperature housing."
    text = (
        f"A mix of {100 * (1 - share):.0f} % motor and {100 * share:.0f} % housing temperature"
        " explains friction"
    )
    option = min((0.0, 0.5, 1.0), key=lambda value: abs(value - share))
    advice = {0.5: "--temperature mean", 1.0: "--temperature housing"}.get(option)
    return f"{text}; of the options {advice} is nearest." if advice else f"{text}."


def _network_text(estimate: ThermalEstimate) -> str:
    """Return what the gear follows, with which time constant, and how far friction heats it."""
    parts = estimate.estimates
    lag, housing = _value(parts, "lag_share"), _value(parts, "housing_lag_share")
    at_housing, heating = _value(parts, "housing_share"), _value(parts, "friction_heating")
    time = _interval_text(parts["time_constant"], 60.0, "min")
    hidden = "housing_time_constant" in parts
    cover = "a housing that is not measured" if hidden else "the housing"
    followed = []
    shares = [parts[name] for name in ("lag_share", "housing_lag_share") if name in parts]
    if len(shares) > 1 and all(one.high - one.low > _UNKNOWN for one in shares):
        followed.append(f"the motor, {cover} or both (these data do not determine which)")
        lag = housing = 0.0
    if lag > _ABSENT:
        followed.append(f"the motor ({100 * lag:.0f} %)" if lag < 1 - _MOSTLY else "the motor")
    if housing > _ABSENT:
        followed.append(f"{cover} ({100 * housing:.0f} %)")
    if followed:
        text = f"The gear follows {' and '.join(followed)} with a time constant of {time}"
    else:
        text = f"Friction warms the gear with a time constant of {time}"
    if at_housing > _ABSENT:
        text += f"; {100 * at_housing:.0f} % of the friction is at the housing"
    if heating > _ABSENT:
        kelvin = _interval_text(parts["friction_heating"], 1.0, "°C")
        text += f"; its own friction warms it by {kelvin} at 100 deg/s"
    return f"{text}."


def _alternative_text(estimate: ThermalEstimate, unit: str) -> str:
    """Return how far a mix of measured temperatures would do instead; empty where it does not."""
    mix, measured = estimate.mix, estimate.rival("measured")
    if mix is None or measured is None or mix.left > 0.5 * measured.left:
        return ""
    share = float(mix.fit.coefficients[2])
    return (
        f"A mix of {100 * (1 - share):.0f} % motor and {100 * share:.0f} % housing temperature"
        f" would leave {number_text(mix.left, 2)} {unit} instead of"
        f" {number_text(estimate.chosen.left, 2)} {unit}."
    )


def _value(parts: Mapping[str, ThermalParameter], name: str) -> float:
    return parts[name].value if name in parts else 0.0


def _interval_text(one: ThermalParameter, scale: float, unit: str) -> str:
    """Return an estimate with its interval in another unit."""
    return quantity_text(one.value / scale, (one.low / scale, one.high / scale), unit)
