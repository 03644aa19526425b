"""How well the temperature of a joint is known, by the register that it was read from."""

import numpy as np

from frictioncli.arrays import Array

_FINE = 0.05
"""Standard error of a motor temperature that was reconstructed between the steps of its register,
or whose steps are fine. [°C]"""

_REGISTERED = 0.29
"""Standard error of a motor temperature as registered in steps of 1 °C: 1/sqrt(12). [°C]"""

_COARSE_STEP = 0.5
"""Step of a register from which on it is coarse. [°C]"""

_ON_STEPS = 0.5
"""Least share of the readings that a coarse register gives in whole steps: others are means of
samples on both sides of a step."""


def temperature_error(reading: Array, temperature: Array) -> float:
    """Return the standard error of the motor temperature [°C].

    Parameters
    ----------
    reading : ndarray, shape (rows,)
        As the controller registered it. [°C]
    temperature : ndarray, shape (rows,)
        As it is used, perhaps reconstructed between the steps. [°C]

    Examples
    --------
    >>> import numpy as np
    >>> whole, fine = np.arange(20.0, 30.0), np.arange(20.0, 30.0, 0.13)
    >>> temperature_error(whole, whole), temperature_error(fine, fine)
    (0.29, 0.05)
    """
    if np.nanmax(np.abs(reading - temperature), initial=0.0) > 1e-6:
        return _FINE
    known = reading[np.isfinite(reading)]
    steps = (known - known[:1]) / _COARSE_STEP
    on_steps = np.abs(steps - np.round(steps)) < 1e-3
    return _FINE if known.size and np.mean(on_steps) < _ON_STEPS else _REGISTERED
