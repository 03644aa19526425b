"""A killed run leaves old or new files, and the next one completes as if nothing had been."""

import random
from functools import partial

import pytest

from frictioncli.files import atomic_write
from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from tests.robustness.kills import Worlds, killed_before_change, killed_run
from tests.robustness.runs import digests

KILLS = 2
STAGES = {
    "ingest": lambda logs, work: partial(ingest, [logs], work),
    "pair": lambda logs, work: partial(pair, work),
    "fit": lambda logs, work: partial(fit, work),
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Outputs of the whole chain."""
    return Worlds(tmp_path_factory.mktemp("whole"), levels=(25, 39, 53, 67))


@pytest.fixture(scope="module")
def worlds(tmp_path_factory):
    """Outputs up to the model, all that the stages below make or read."""
    return Worlds(tmp_path_factory.mktemp("kill"), levels=(25, 39, 53), whole=False)


@pytest.mark.long
def test_a_run_killed_at_random_times(whole):
    draw = random.Random(7)
    hits = 0
    for number in range(KILLS):
        seconds = draw.uniform(0.3, 0.9) * whole.duration
        work, running = killed_run(whole, seconds, fresh=number % 2 == 0)
        whole.check(work)
        hits += running
    whole.check_next_run(work)
    assert hits  # else nothing was killed at all


@pytest.mark.slow
@pytest.mark.parametrize(
    "stage",
    [pytest.param(one, marks=() if one == "ingest" else pytest.mark.long) for one in STAGES],
)
def test_a_stage_killed_before_each_of_its_changes_on_disk(worlds, stage):
    number = 0
    while True:
        number += 1
        work = worlds.work(fresh=False)
        if not killed_before_change(STAGES[stage](worlds.logs, work), work, number):
            break
        worlds.check(work)
    assert number > 5  # making, opening, syncing, renaming and removing at least
    left_over = worlds.work(fresh=False)
    assert killed_before_change(STAGES[stage](worlds.logs, left_over), left_over, number - 2)
    STAGES[stage](worlds.logs, left_over)()
    assert not [name for name in digests(left_over) if name.startswith(".")]


def write_folder(target, text):
    with atomic_write(target) as draft:
        draft.mkdir()
        for name in ("a.svg", "b.svg", "index.html"):
            (draft / name).write_text(text, encoding="utf-8")


def test_a_folder_killed_before_each_of_its_changes_is_all_old_or_all_new(tmp_path):
    """What the report's folder goes through; there is a folder at every moment."""
    target = tmp_path / "report"
    write_folder(target, "0")
    number, seen = 1, set()
    while killed_before_change(partial(write_folder, target, str(number)), tmp_path, number):
        texts = {path.read_text(encoding="utf-8") for path in target.iterdir()}
        assert len(list(target.iterdir())) == 3
        assert len(texts) == 1
        seen |= texts
        number += 1
    assert {"0", str(number - 1)} <= seen
    assert {path.read_text(encoding="utf-8") for path in target.iterdir()} == {str(number)}
