"""What the extended model still misses, as ``diagnosis.json`` has it."""

from typing import Annotated

import msgspec

Channel = Annotated[str, msgspec.Meta(pattern="^(friction|load)$")]
"""The part of the torque in which something shows."""


class RemainderRecord(msgspec.Struct, frozen=True, kw_only=True):
    """What the extended model still misses, where that is clearly more than noise.

    Attributes
    ----------
    basis : {"new_run", "within_run"}
        Whether it was measured on a run that the diagnosis has not used.
    rmse, noise_floor : float
        RMS misfit of the extended model, and RMS of the noise. [torque unit]
    size : float
        RMS of what is left beside the noise. [torque unit]
    axis : str
        The column along which most of it shows; ``run`` where it is the same over the whole run.
    channel : {"friction", "load"}
        The part of the torque in which that is.
    axis_size : float
        RMS of the means along that column, or amount of the mean. [torque unit]
    """

    basis: str
    rmse: float
    noise_floor: float
    size: float
    axis: str
    channel: Channel
    axis_size: float
