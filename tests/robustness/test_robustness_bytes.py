"""The same logs and settings give the same bytes, wherever and however the program runs."""

import pytest

from tests.robustness.runs import digests, finished, write_warm_up


@pytest.mark.long
@pytest.mark.parametrize(
    "elsewhere",
    [
        {
            "PYTHONHASHSEED": "4711",
            "TZ": "Asia/Kathmandu",
            "LC_ALL": "C",
            "HOME": "/nonexistent",
            "SOURCE_DATE_EPOCH": "1",
            "MPLBACKEND": "svg",
        },
    ],
)
def test_two_runs_give_the_same_bytes(tmp_path, elsewhere):
    logs = write_warm_up(tmp_path / "logs" / "day", levels=(25, 39, 53, 67)).parent
    here = {"PYTHONHASHSEED": "0", "TZ": "UTC", "LC_ALL": "C.UTF-8", "MPLCONFIGDIR": str(tmp_path)}
    first = finished("run", logs, "-w", tmp_path / "one", env=here)
    assert first.returncode == 0, first.stderr
    (tmp_path / "deep").mkdir()
    elsewhere = elsewhere | {"MPLCONFIGDIR": str(tmp_path)}
    second = finished("run", logs, "-w", "two words", env=elsewhere, cwd=tmp_path / "deep")
    assert second.returncode == 0, second.stderr
    one, two = digests(tmp_path / "one"), digests(tmp_path / "deep" / "two words")
    assert one.keys() == two.keys()
    assert {name for name in one if one[name] != two[name]} == set()
    assert {"schedule.parquet", "evaluation.parquet", "diagnosis.json"} <= one.keys()
