"""A few damaged inputs of every form; ``make fuzz`` tries as many as there is time for."""

import shutil
import zipfile

import pytest

from tests.design.few_programmes import few_programmes
from tests.robustness.runs import write_warm_up
from tests.robustness.test_robustness_upgrade import STORED
from tests.studies.fuzz_corpus import KEPT, tried_again
from tests.studies.fuzz_forms import FORMS, examine, lost_rows
from tests.studies.fuzz_process import GOOD
from tests.studies.fuzz_recordings import WRITERS
from tests.studies.soak import soaked

INPUTS = {"work": 1}
"""Inputs that are tried of each form, where it is not six: a stage takes longer than a reading."""


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    """Logs of a joint, and outputs of another twice."""
    folder = tmp_path_factory.mktemp("base")
    write_warm_up(folder / "logs" / "day", levels=(25, 39, 53), seed=1)
    for name in ("work", "other"):
        with zipfile.ZipFile(STORED) as packed:
            packed.extractall(folder / name)
    return folder


@pytest.mark.parametrize("form", FORMS)
def test_damaged_inputs_end_as_they_should(form, base, tmp_path):
    found = []
    for number in range(INPUTS.get(form, 6)):
        (tmp_path / str(number)).mkdir()
        with few_programmes():
            one, outcome, text = examine(form, number, tmp_path / str(number), base)
        if outcome not in GOOD:
            found.append((form, number, one.damage, one.words, outcome, text))
        shutil.rmtree(tmp_path / str(number))
    assert not found


@pytest.mark.parametrize("packed", sorted(KEPT.glob("*.zip")), ids=lambda path: path.stem)
def test_what_was_once_found_stays_mended(packed):
    assert tried_again(packed) == ""


def test_the_study_sees_a_row_that_is_lost(base, tmp_path):
    import pyarrow.parquet as pq

    from tests.studies.fuzz_call import call
    from tests.studies.fuzz_recordings import COLUMNS

    (tmp_path / "logs").mkdir()
    WRITERS["log.npz"](tmp_path / "logs" / "log.npz", COLUMNS)
    assert call(["ingest", str(tmp_path / "logs"), "-w", str(tmp_path / "work")])[0] == 0
    count = len(COLUMNS["time"])
    assert lost_rows(tmp_path / "work", count) == ""
    assert lost_rows(tmp_path / "work", count + 1)
    samples = pq.read_table(tmp_path / "work" / "samples.parquet")
    pq.write_table(samples.slice(1), tmp_path / "work" / "samples.parquet")
    assert lost_rows(tmp_path / "work", count)


@pytest.mark.long
def test_a_disturbed_fleet_ends_as_an_undisturbed_one():
    soak = soaked(joints=2, calls=2, minutes=10, seed=5)
    assert soak.counts["joints compared"] > 0
