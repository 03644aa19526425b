"""Effects of the measurement that were refused beside the base, and are possible beside the causes.

One may have come out impossible because of the very cause that was found later: inertia at the ends
of the stroke is much like a filter with a negative second moment, and of a filter that is refused
the delay is, too. Their torque may then still be in the rows, and a cause that resembles it be as
large as both together.
"""

from collections.abc import Sequence

from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.measurement import beside_base, measurement_causes
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import MEASUREMENT_EFFECTS
from frictioncli.effects.sensor_lag import EFFECT as SENSOR
from frictioncli.effects.thermal_lag import EFFECT as LAG


def possible_beside(
    fitted: Sequence[EffectFit],
    step: Step,
    measurement: Sequence[Cause],
    refused: Sequence[Cause],
) -> tuple[EffectFit, ...]:
    """Return effects of the measurement that were refused, and are possible beside a model.

    Parameters
    ----------
    fitted : sequence of EffectFit
        The effects that extend the model.
    step : Step
        Base and causes, with the noise that suits them best.
    measurement : sequence of Cause
        Effects of the measurement beside the base.
    refused : sequence of Cause
        Effects of the measurement that were refused there.

    Returns
    -------
    tuple of EffectFit
        As they are beside base and joint.
    """
    known = [one for one in fitted if not one.effect.measurement]
    # what a sensor may take from a lag is known otherwise
    kept = {SENSOR.name} if any(one.effect.name == LAG.name for one in known) else set()
    gone = {one.fit.effect.name for one in refused} - kept
    if not known or not gone:
        return ()
    stood = {one.fit.effect.name for one in measurement}
    effects = tuple(one for one in MEASUREMENT_EFFECTS if one.name in gone | stood)
    spectra = step.precomputed.noises.spectra
    beside = beside_base(step.problem, measurement=effects, found=known, spectra=spectra)
    again = measurement_causes(Step.of(beside.precomputed, known), beside.effects)
    return tuple(one.fit for one in again if one.fit.effect.name in gone - stood)
