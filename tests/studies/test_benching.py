"""The harness measures what it says: the child alone, round by round, and only if results agree."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from tests.studies import bench_page
from tests.studies.bench_rounds import measure, stored
from tests.studies.bench_schedule import plain_loop
from tests.studies.benching import Disagreement, Goal, Work, command, faster, function, peak

HUNDRED_MEGABYTES = "b = b'x' * 100_000_000; print(len(b))"
IN_A_CHILD = (
    f"import subprocess, sys; subprocess.run([sys.executable, '-c', {HUNDRED_MEGABYTES!r}])"
)


def work(*contestants, check=lambda runs: "agreed", goals=()):
    return Work(
        name="tried", title="Tried", contestants=contestants, check=check, goals=goals, sources=()
    )


def once(tmp_path, contestant, **parts):
    measured = measure(work(contestant, **parts), rounds=1, store=tmp_path)
    assert not measured.faults
    return measured.rounds[0][contestant.name]


def test_memory_is_that_of_the_command_and_not_of_the_caller(tmp_path):
    ballast = np.ones(30_000_000)
    small = once(tmp_path, command("small", "{python}", "-S", "-c", "pass"))
    assert small.peak < ballast.nbytes / 3
    large = once(tmp_path, command("large", "{python}", "-S", "-c", HUNDRED_MEGABYTES))
    assert 100e6 < large.peak < 120e6


def test_memory_of_a_child_of_the_command_counts(tmp_path):
    run = once(tmp_path, command("parent", "{python}", "-S", "-c", IN_A_CHILD))
    assert run.peak > 100e6


def test_processor_time_is_not_waiting_time(tmp_path):
    idle = once(tmp_path, command("idle", "{python}", "-S", "-c", "import time; time.sleep(0.5)"))
    assert idle.wall >= 0.5
    assert idle.cpu < 0.4


def slept(data, out, seconds):
    """A contestant: the act waits, preparing waits longer."""
    import time

    time.sleep(0.6)
    return lambda: time.sleep(float(seconds)) or {"waited": float(seconds)}


def test_of_a_function_only_the_act_is_timed(tmp_path):
    run = once(tmp_path, function("act", "tests.studies.test_benching:slept", "0.05", times=3))
    assert 0.05 <= run.wall < 0.6
    assert run.result == {"waited": 0.05}


def test_contestants_take_turns_in_going_first(tmp_path):
    order = tmp_path / "order.txt"
    script = f"open({str(order)!r}, 'a').write(__import__('sys').argv[1])"
    contestants = [command(name, "{python}", "-S", "-c", script, name) for name in "abc"]
    measure(work(*contestants), rounds=3, store=tmp_path)
    assert order.read_text() == "abcbcacab"


def test_rounds_are_kept_and_only_missing_ones_run(tmp_path):
    calls = []
    tried = work(
        command("pass", "{python}", "-S", "-c", "pass"), check=lambda runs: calls.append(1) or "ok"
    )
    measure(tried, rounds=2, store=tmp_path)
    assert len(calls) == 2
    assert len(measure(tried, rounds=3, store=tmp_path).rounds) == 3
    assert len(calls) == 3
    renamed = replace(tried, contestants=[command("other", "{python}", "-S", "-c", "pass")])
    assert stored(renamed, tmp_path).rounds == []


def refuse(runs):
    raise Disagreement("two sums differ")


@pytest.mark.parametrize(
    ("tried", "told"),
    [
        (work(command("pass", "{python}", "-c", "pass"), check=refuse), "two sums differ"),
        (work(command("bad", "{python}", "-c", "raise SystemExit('no luck')")), "no luck"),
        (work(command("gone", "{data}/nothing-there")), "could not be started"),
    ],
    ids=["check", "status", "missing"],
)
def test_a_disagreement_is_told_and_its_round_does_not_count(tmp_path, tried, told):
    measured = measure(tried, rounds=1, store=tmp_path)
    assert measured.rounds == []
    assert told in measured.faults[0]
    assert f"**Disagreement:** {measured.faults[0]}" in bench_page.section(tried, measured)


def test_ratios_are_taken_inside_rounds(tmp_path):
    """A machine that is ten times slower in one round leaves the ratio of 4 as it is."""
    rounds = [(1.0, 4.0), (10.0, 40.0), (1.0, 5.0)]
    rows = [
        {
            "state": "e3b0c44298fc",  # the digest of no sources
            "contestants": ["ours", "theirs"],
            "runs": {
                "ours": {"wall": ours, "cpu": 1.0, "peak": 2e8},
                "theirs": {"wall": theirs, "cpu": 1.0, "peak": 1e8},
            },
            "agreed": "yes",
            "fault": "",
            "load": 0.0,
        }
        for ours, theirs in rounds
    ]
    (tmp_path / "tried.jsonl").write_text("\n".join(map(json.dumps, rows)))
    ratio, memory = faster("ours", "theirs", must=3, reach=5), peak("ours", most=150)
    tried = work(command("ours", "a"), command("theirs", "b"), goals=[ratio, memory])
    measured = stored(tried, tmp_path)
    assert measured.figures(ratio) == (4.0, 4.0, 5.0)
    text = bench_page.section(tried, measured)
    assert "| ≥ 3 | ≥ 5 | 4 [4 .. 5] | met |" in text
    assert "| ≤ 150 |  | 200 [200 .. 200] | missed |" in text


@pytest.mark.parametrize(
    ("value", "at_most", "verdict"),
    [(6, False, "reached"), (4, False, "met"), (2, False, "missed"), (2, True, "reached")],
)
def test_verdicts(value, at_most, verdict):
    must, reach = (6, 3) if at_most else (3, 5)
    goal = Goal(text="", figure=lambda runs: 0.0, must=must, reach=reach, at_most=at_most)
    assert goal.verdict(value) == verdict


def test_the_plain_loop_of_the_bench_by_hand():
    """1 °C a minute: k = 5 waits more than 5 min, so it corrects every 6th minute."""
    time = [60.0 * i for i in range(20)]
    assert plain_loop(time, [20.0 + i for i in range(20)], 5.0, 3600.0) == [0, 6, 12, 18]


def test_the_small_bench_runs(tmp_path):
    """As a user starts it; the smallest work only."""
    words = ["--small", "--rounds", "1", "--only", "schedule-3e3", "--data", str(tmp_path)]
    done = subprocess.run(
        [sys.executable, "-m", "tests.studies.bench", *words, "--store", str(tmp_path)],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "The same" in done.stdout
    assert (tmp_path / "small" / "schedule-3e3.jsonl").exists()
