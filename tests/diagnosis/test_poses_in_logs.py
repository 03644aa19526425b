"""From logs to a diagnosis: where other joints stand is no change of payload or friction."""

from itertools import cycle, islice

import numpy as np
import pandas as pd
import pytest

from frictioncli.diagnosis.documents.reload import read_documents
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.fit import fit
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from tests.moves import move_sequence

ELBOW = (10.0, 70.0)
"""Angles at which joint 3 stands; joint 2 carries 60 N·m in the first, 36 N·m in the second."""


def friction(speed, load):
    return 8.0 + 0.002 * load**2 + 1.2 * np.sqrt(speed)


def write_day(path, rng, elbow):
    """Moves of joint 2 at four speeds there and back, five times with joint 3 at each angle."""
    speeds = list(islice(cycle((15.0, 30.0, 60.0, 110.0)), 20))
    motion = move_sequence([0, 120] * 20 + [0], np.repeat(speeds, 2))
    stands = np.array(elbow)[np.arange(len(motion)) * 6 // len(motion) % len(elbow)]
    # it takes a second to get there
    window = round(1.0 / 0.012)
    stands = np.convolve(np.pad(stands, window, mode="edge"), np.ones(window) / window, "same")
    stands = stands[window:-window]
    share = np.interp(stands, ELBOW, [1.0, 0.6])
    load = share * 60 * np.cos(np.radians(motion["position"] + 10)) + 3.0
    torque = load + np.sign(motion["velocity"]) * friction(motion["velocity"].abs(), load)
    torque += 6.0 * np.radians(motion["acceleration"]) + rng.normal(0, 0.3, len(motion))
    log = pd.DataFrame(
        {
            "time [s]": motion["time"],
            "q_2 [deg]": motion["position"],
            "qd_2 [deg/s]": motion["velocity"],
            "torque_2 [Nm]": torque,
            "q_3 [deg]": stands,
        }
    )
    path.parent.mkdir(parents=True)
    log.to_csv(path, index=False, float_format="%.6f")


@pytest.mark.parametrize(
    ("second", "known"),
    [
        (ELBOW, True),
        pytest.param(ELBOW[1:], True, marks=pytest.mark.long),
        pytest.param(ELBOW, False, marks=pytest.mark.long),
    ],
    ids=["in turn", "on the second day alone", "not in the log"],
)
def test_a_joint_that_stands_elsewhere_is_no_finding(tmp_path, second, known):
    rng = np.random.default_rng(3)
    first = ELBOW if len(second) > 1 else ELBOW[:1]
    for day, elbow in (("day1", first), ("day2", second)):
        write_day(tmp_path / day / "log.csv", rng, elbow)
        if not known:
            log = pd.read_csv(tmp_path / day / "log.csv").drop(columns="q_3 [deg]")
            log.to_csv(tmp_path / day / "log.csv", index=False)
    work = tmp_path / "work"
    ingest([tmp_path / "day1", tmp_path / "day2"], work, IngestSettings())
    for stage in (pair, separate, fit, diagnose):
        stage(work)
    document, _ = read_documents(work)[2]
    names = {name for cause in (*document.causes, *document.visible) for name in cause.effects}
    if known:
        assert not names & {"payload_change", "step_change"}
        assert document.verdict == "no_evidence"
    else:
        assert document.verdict != "no_evidence"
