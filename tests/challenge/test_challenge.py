"""The command on a small log: sizes, names, rows, what is taken up again, and its faults."""

import hashlib
import os
import re
import shutil
import signal
import time

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.challenge import challenge as module
from frictioncli.challenge import trial
from frictioncli.challenge.challenge import challenge
from frictioncli.challenge.settings import ChallengeSettings
from frictioncli.challenge_schema import CHALLENGE as CHALLENGE_TABLE
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.errors import OptionError
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.report import report
from frictioncli.workfiles import DIAGNOSIS, EXTENDED, MODEL, RAMPS, STARTS, TORQUES
from tests.command_line import invoke
from tests.robustness.runs import started, write_warm_up

LEVELS = (25, 32, 39, 46, 53)

TABLE = "challenge.parquet"


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    return write_warm_up(tmp_path_factory.mktemp("small") / "day", levels=LEVELS)


def rows_of(work):
    return tables.read(work / TABLE, CHALLENGE_TABLE)


def one(rows, effect, purpose="given"):
    return rows[(rows["effect"] == effect) & (rows["purpose"] == purpose)].iloc[0]


@pytest.fixture(scope="module")
def asymmetry(logs, tmp_path_factory):
    """A finished challenge of one effect, and what it says."""
    work = tmp_path_factory.mktemp("asymmetry") / "work"
    result = invoke("challenge", logs, "-w", work, "--effect", "direction_asymmetry:2")
    return work, result.stdout, rows_of(work)


def test_an_asymmetry_is_found_by_its_name_and_the_log_as_it_is_has_none(asymmetry):
    _, said, rows = asymmetry
    logged = rows[rows["purpose"] == "as_logged"].iloc[0]
    assert (logged["names"], logged["effect"], logged["verdict"]) == ("", "none", "no_evidence")
    row = one(rows, "direction_asymmetry")
    assert (row["names"], row["verdict"], row["wrong"]) == ("direction_asymmetry", "named", "")
    assert row["right_in_set"]
    assert row["right_alone"]
    assert not row["already"]
    assert "as logged: no_evidence" in said
    assert "trials with a wrong new name: 0 of 1 trial" in said


def test_gain_is_of_the_diagnosis_with_the_effect(asymmetry):
    _, _, rows = asymmetry
    row = one(rows, "direction_asymmetry")
    assert row["gain"] == pytest.approx(1.0 - row["rmse_after"] / row["rmse_before"], abs=1e-6)
    # the effect shows in the load, of which the rest is noise
    assert row["rmse_before"] > 0.5
    assert row["gain"] > 0.5


def test_rows_carry_inputs_and_nothing_is_left_of_the_trials(asymmetry):
    work, _, _ = asymmetry
    about = tables.metadata(work / TABLE)
    assert about["stage"] == "challenge"
    assert {"samples.parquet", "torques.parquet", "diagnosis.json"} <= set(about["inputs"])
    assert about["facts"]["torque_unit"] == "N·m"
    assert not [path for path in work.iterdir() if path.name.startswith(".")]


def test_there_is_one_picture_per_effect(asymmetry):
    work, said, _ = asymmetry
    names = sorted(path.name for path in (work / "challenge").iterdir())
    assert names == ["direction_asymmetry.png", "direction_asymmetry.svg"]
    assert str(work / "challenge") in said


@pytest.mark.long
def test_the_page_shows_planted_effects_as_long_as_they_are_of_these_data(asymmetry, tmp_path):
    work = shutil.copytree(asymmetry[0], tmp_path / "work")
    report(work)
    page = (work / "report" / "index.html").read_text(encoding="utf-8")
    table = page.split("Effects planted in these logs")[1].split("</table>")[0]
    cells = re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", table.split("<tbody>")[-1])
    assert cells[:3] == ["direction asymmetry", "direction asymmetry", "found"]
    assert "Trials with a wrong new name: 0 of 1 trial." in page
    # another diagnosis than the one that was challenged
    diagnose(work, DiagnosisSettings(alpha=0.01))
    report(work)
    page = (work / "report" / "index.html").read_text(encoding="utf-8")
    assert "Effects planted in these logs" not in page
    assert "Planted effects left out" in page


@pytest.fixture(scope="module")
def known():
    """Diagnoses by what they were made from."""
    return {}


@pytest.fixture
def undiagnosed(monkeypatch, known):
    """Trials say of every planted log what the log as it is says; the rest is as it is.

    A log is diagnosed once in the module, and what was said is copied.
    """

    def once(work, settings):
        inputs = [(work / name).read_bytes() for name in (TORQUES, RAMPS, STARTS, MODEL)]
        key = (hashlib.sha256(b"".join(inputs)).hexdigest(), settings)
        outputs = [work / DIAGNOSIS, work / EXTENDED]
        if key not in known:
            diagnose(work, settings)
            known[key] = [path.read_bytes() for path in outputs]
        for path, content in zip(outputs, known[key], strict=True):
            path.write_bytes(content)

    def copied(folder, settings, *, sizes):
        for name in ("diagnosis.json", "model.json"):
            shutil.copyfile(folder.parent / name, folder / name)

    monkeypatch.setattr(module, "diagnose", once)
    monkeypatch.setattr(trial, "diagnose", copied)
    monkeypatch.setattr(trial, "fit", lambda folder, settings: None)


def test_each_effect_has_the_size_that_was_asked_for(logs, tmp_path, undiagnosed):
    asked = {"position_ripple": 2.0, "drift": 1.5, "dress_pack": 0.7}
    effects = tuple(f"{name}:{size}" for name, size in asked.items())
    challenge([logs], tmp_path, options=ChallengeSettings(effects=effects))
    rows = rows_of(tmp_path)
    for effect, size in asked.items():
        row = one(rows, effect)
        assert row["size"] == pytest.approx(size, rel=0.02)
        assert (row["asked"], row["unit"], row["status"]) == (size, "N·m", "done")


def test_the_usual_size_is_a_share_of_the_mean_friction(logs, tmp_path, undiagnosed):
    options = ChallengeSettings(effects=("drift", "inertia"), share=5.0, draws=2)
    challenge([logs], tmp_path, options=options)
    torques = tables.read(tmp_path / "torques.parquet", schemas.TORQUES)
    rows = rows_of(tmp_path)
    drift = rows[rows["effect"] == "drift"]
    expected = 0.05 * torques["friction_torque"].mean()
    np.testing.assert_allclose(drift["size"], expected, rtol=0.02)
    np.testing.assert_allclose(drift["share"], 0.05, rtol=0.02)
    assert drift["seed"].tolist() == [0, 1]
    # an effect after reversals has it there
    assert np.all(rows[rows["effect"] == "inertia"]["size"] < 0.9 * expected)


def test_no_magnet_loses_more_than_nature_lets_it(logs, tmp_path, undiagnosed):
    """Usually the largest size that there is; one that was asked for and is none is refused."""
    for effects, share in ((("torque_constant",), 50.0), (("torque_constant:1000",), 10.0)):
        challenge([logs], tmp_path, options=ChallengeSettings(effects=effects, share=share))
    rows = rows_of(tmp_path)
    usual, given = one(rows, "torque_constant", "share"), one(rows, "torque_constant")
    samples = tables.read(tmp_path / "samples.parquet", schemas.SAMPLES)
    torques = tables.read(tmp_path / "torques.parquet", schemas.TORQUES)
    whole = np.sqrt(np.mean(torques[["friction_torque", "load_torque"]].max(axis=1) ** 2))
    most = 0.002 * np.ptp(samples["motor_temperature"]) * whole
    assert usual["status"] == "done"
    assert 0 < usual["size"] < 1.3 * most < usual["asked"]
    assert given["status"] == "cannot"
    assert "cannot show it at a size of 1e+03" in given["message"]


def test_an_interrupted_call_goes_on_and_does_nothing_twice(
    logs, tmp_path, undiagnosed, monkeypatch
):
    options = ChallengeSettings(effects=("position_ripple:2", "drift:1.5"))
    tried = []
    real = module.Planter.trial

    def interrupted(planter, name, *rest, **how):
        if name == "drift" and len(tried) == 1:
            raise KeyboardInterrupt
        tried.append(name)
        return real(planter, name, *rest, **how)

    monkeypatch.setattr(module.Planter, "trial", interrupted)
    with pytest.raises(KeyboardInterrupt):
        challenge([logs], tmp_path, options=options)
    assert rows_of(tmp_path)["effect"].tolist() == ["none", "position_ripple"]
    tried.append("interrupted")
    challenge([logs], tmp_path, options=options)
    assert tried == ["position_ripple", "interrupted", "drift"]
    challenge([logs], tmp_path, options=options)
    assert len(tried) == 3
    assert rows_of(tmp_path)["effect"].tolist() == ["none", "position_ripple", "drift"]


@pytest.mark.long
def test_rows_of_other_logs_are_dropped(logs, tmp_path, undiagnosed):
    options = ChallengeSettings(effects=("position_ripple:2",))
    work = tmp_path / "work"
    challenge([logs], work, options=options)
    challenge([logs], work, options=ChallengeSettings(effects=("drift:1",)))
    assert rows_of(work)["effect"].tolist() == ["none", "position_ripple", "drift"]
    other = write_warm_up(tmp_path / "other" / "day", levels=LEVELS[1:])
    challenge([other], work, options=options)
    assert rows_of(work)["effect"].tolist() == ["none", "position_ripple"]


def test_what_these_data_cannot_show_is_told_as_such(logs, tmp_path, undiagnosed):
    # between its recordings, an hour each, a gear takes the temperature of the motor
    result = challenge([logs], tmp_path, options=ChallengeSettings(effects=("thermal_lag:9",)))
    row = rows_of(tmp_path).iloc[1]
    assert (row["status"], row["right_in_set"]) == ("cannot", False)
    assert "cannot show it" in row["message"]
    assert "not visible in these data" in str(result)


@pytest.mark.parametrize("threshold", [0.8, 3.0])
def test_the_search_brackets_the_least_size_that_is_found(
    logs, tmp_path, monkeypatch, undiagnosed, threshold
):
    """A diagnosis that finds a ripple from one size on."""
    real = module.row_of_trial

    def from_threshold(subject, effect, seed, purpose, asked, made):
        found = made.size >= threshold
        return real(subject, effect, seed, purpose, asked, made) | {"right_in_set": found}

    monkeypatch.setattr(module, "row_of_trial", from_threshold)
    options = ChallengeSettings(effects=("drift:2",), search=True)
    challenge([logs], tmp_path, options=options)
    rows = rows_of(tmp_path)
    searched = rows[rows["effect"] == "drift"]
    assert searched["size_found"].nunique() == 1
    low, high = (searched[f"size_found_{end}"].iloc[0] for end in ("low", "high"))
    # planted to 2 %
    assert low <= 1.02 * threshold
    assert high >= 0.98 * threshold
    assert high / low <= 1.35


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--effect", "wobble"), "unknown"),
        (("--effect", "drift:0"), "above 0"),
        (("--effect", "step_change@recurring"), "permanent"),
        (("--share", "0"), "above 0"),
        (("--draws", "0"), "1 to 100"),
        (("--seed", "-1"), "0 or more"),
    ],
)
def test_wrong_options_are_told_before_anything_is_read(tmp_path, words, told):
    with pytest.raises(OptionError, match=told):
        invoke("challenge", tmp_path / "none", "-w", tmp_path / "work", *words)
    assert not (tmp_path / "work").exists()


@pytest.mark.long
def test_a_killed_call_leaves_a_whole_table_and_goes_on(logs, tmp_path):
    work = tmp_path / "work"
    words = ("challenge", logs, "-w", work, "--effect", "direction_asymmetry:2")
    words += ("--effect", "stroke_bump:2")
    process = started(*words)
    deadline = time.monotonic() + 240
    while not ((work / TABLE).exists() and len(rows_of(work)) >= 2):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    before = rows_of(work)
    again = started(*words)
    told, faults = again.communicate(timeout=300)
    assert again.returncode == 0, faults
    after = rows_of(work)
    assert after["effect"].tolist() == ["none", "direction_asymmetry", "stroke_bump"]
    # what was done was not done again
    np.testing.assert_array_equal(after["seconds"][: len(before)], before["seconds"])
    assert "stroke_bump" in told
    assert not [path for path in work.iterdir() if path.name.startswith(".")]
