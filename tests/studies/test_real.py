"""The page on real logs: its independent script, its intervals, folders unknown to it."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from tests.studies import real
from tests.studies.real_chain import of_pairs
from tests.studies.real_independent import Independent, half_differences, least_squares


def there_and_back(speed, friction, gravity, seconds=40.0, period=0.01):
    """Triangles between 0 and 60 deg: torque is gravity at the angle plus friction."""
    time = np.arange(0.0, seconds, period)
    phase = (speed * time) % 120.0
    angle = np.minimum(phase, 120.0 - phase)
    velocity = np.where(phase < 60.0, speed, -speed)
    torque = gravity * np.cos(np.radians(angle)) + friction * np.sign(velocity)
    return time, angle, velocity, torque


def test_half_differences_give_the_friction_free_of_gravity():
    motions = [there_and_back(20.0, 1.5, 30.0), there_and_back(50.0, 2.5, 30.0)]
    found = half_differences(motions, 3, 0.02, (20.0, 50.0, 90.0))
    assert list(found) == pytest.approx([20.0, 50.0])
    # bins of 5 deg are crossed there and back alike: gravity is in both, up to one sample
    assert list(found.values()) == pytest.approx([1.5, 2.5], abs=0.02)


def test_least_squares_give_the_friction_of_a_sine():
    time = np.arange(0.0, 60.0, 0.01)
    angle, velocity = 40.0 * np.sin(time), 40.0 * np.cos(time)
    torque = 0.02 * -40.0 * np.sin(time) + 5.0 * np.cos(np.radians(angle))
    torque += np.sign(velocity) * (0.6 + 0.3 * np.sqrt(np.abs(velocity)))
    law, rms = least_squares((time, angle, velocity, torque), 3.0)
    assert law == pytest.approx((0.6, 0.3), abs=0.01)
    assert rms < 0.01


def test_friction_of_pairs_has_the_interval_of_their_mean():
    rows = pd.DataFrame(
        {
            "run": "a",
            "pair": [0, 0, 1, 2, 3],
            "speed": [10.0, 10.0, 10.1, 10.2, 50.0],
            "friction_torque": [0.5, 1.5, 2.0, 3.0, 7.0],
        }
    )
    slow, fast = of_pairs(rows)
    assert (slow.speed, slow.friction) == pytest.approx((10.1, 2.0))
    half = stats.t.ppf(0.975, 2) / np.sqrt(3)
    assert slow.ci95 == pytest.approx((2.0 - half, 2.0 + half))
    assert (fast.friction, fast.ci95) == (7.0, None)


def test_no_figure_stands_beside_a_speed_that_it_does_not_know():
    known = Independent(joint=1, unit="A", way="", friction={50.0: 2.0})
    assert (known.at(51.0), known.at(60.0)) == (2.0, None)


def test_any_folder_is_tried_and_a_refusal_is_told(tmp_path, monkeypatch):
    logs = tmp_path / "mine"
    logs.mkdir()
    (logs / "notes.csv").write_text("a,b\n1,2\n3,4\n", encoding="utf-8")
    monkeypatch.setattr(real, "PAGE", tmp_path / "real.md")
    real.main([str(logs)])
    page = (tmp_path / "real.md").read_text(encoding="utf-8")
    assert "| mine | refused | none suggested | none | nothing to compare |" in page
    assert "Of 1 folder 0 end in a result unaided" in page
    assert str(tmp_path) not in page


def test_a_folder_that_is_not_there_is_said(capsys):
    with pytest.raises(SystemExit, match="nowhere: expected folders of logs"):
        real.main(["nowhere"])
