"""What silence means: the smallest size of each effect that these data would have shown."""

from collections.abc import Sequence

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from frictioncli.diagnosis.fit.judgement import Judged
from frictioncli.diagnosis.search.cause_search import Found
from frictioncli.effects.base import Effect

_POWER = 0.8


def detectable(found: Found, effects: Sequence[Effect], alpha: float) -> dict[str, float | None]:
    """Return per effect the smallest RMS size that is found four times in five. [N·m].

    The white norm that a noncentral chi-squared score needs to pass the threshold, times the
    effect's RMS per white norm. None where the data lack what the effect needs.
    """
    catalogue = max(len(found.last) + len(found.causes), 1)
    candidates = found.last | {cause.score.effect.name: cause.judged for cause in found.causes}
    return {
        effect.name: _smallest(candidates.get(effect.name), alpha / catalogue) for effect in effects
    }


def _smallest(candidate: Judged | None, level: float) -> float | None:
    if candidate is None or candidate.freedom == 0:
        return None
    threshold = candidate.chance.limit(level)
    if not np.isfinite(threshold):
        return None
    needed = brentq(
        lambda shift: stats.ncx2.sf(threshold, candidate.freedom, shift) - _POWER, 1e-6, 1e4
    )
    return float(np.sqrt(needed) * candidate.size_scale)
