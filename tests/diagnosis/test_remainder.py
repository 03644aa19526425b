"""What a model leaves of a held-out run."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.remainder import remainder_record
from frictioncli.diagnosis.fit.extension import extend
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.settings import DiagnosisSettings
from tests.diagnosis.dense_noise import days
from tests.equation_16 import TRUTH


def test_a_delay_that_is_not_named_leaves_what_a_refitted_base_leaves():
    """The base model as fitted is that of a torque freed of its delay: 2.5 N·m from this one."""
    rows = days(3)
    angle = np.radians(rows["position"].to_numpy())
    rows["friction_torque"] += 0.03 * rows["speed"] * np.radians(95.0) * np.sin(angle)
    found = diagnose_joint(rows, "motor", "N·m", DiagnosisSettings(), effects=())
    weighted_fit = Step.of(Precomputed.of(found.base), []).predicting_fit()
    alone = extend(found.base, weighted_fit, [])
    left = remainder_record(replace(found, causes=(), extension=None, predicted=alone))

    seen = (rows["run"] == "day1").to_numpy()
    speed = np.sqrt(rows["speed"].to_numpy())
    cold = np.exp(-TRUTH["delta"] * rows["motor_temperature"].to_numpy())
    load = rows["load_torque"].to_numpy()
    one = np.ones_like(load)
    square = 0.0
    for torque, columns in (
        (rows["friction_torque"].to_numpy(), [one, load**2, speed, speed * cold]),
        (load, [one, np.cos(angle), np.sin(angle)]),
    ):
        design = np.column_stack(columns)
        fitted = design @ np.linalg.lstsq(design[seen], torque[seen], rcond=None)[0]
        square += np.mean(np.square(torque - fitted)[~seen])
    assert left.rmse == pytest.approx(np.sqrt(square), rel=0.1)
