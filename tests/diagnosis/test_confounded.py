"""What may be an effect of something else that goes with it in the data."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.search.confounded import turns_elsewhere, unclaimed
from frictioncli.diagnosis.search.doubtful_steps import doubtful_with_new_run
from frictioncli.diagnosis.search.standing import with_standing
from frictioncli.effects import BY_NAME
from frictioncli.effects.history import history
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.test_standing import ALPHA, MARGIN, cause, standing


@pytest.fixture(scope="module")
def joint():
    return problem(1)


@pytest.fixture(scope="module")
def random_turns(joint):
    """The same joint, of each move a random part."""
    generator = np.random.default_rng(0)
    table = joint.table
    pairs = len(joint.layout.time)
    low, high = np.quantile(table.position, [0.0, 1.0])
    middle = (low + high) / 2
    ends = generator.uniform(low, middle, pairs), generator.uniform(middle, high, pairs)
    pair = joint.layout.row_pair
    kept = (table.position >= ends[0][pair]) & (table.position <= ends[1][pair])
    return joint.part(kept)


def of(name, visible, shape=None):
    """Return a cause of this name that is beyond doubt, with what the base leaves of it."""
    one = BY_NAME[name]
    values = tuple(0.5 * min(parameter.upper, 1.0) for parameter in one.coefficients)
    shape = shape or {axis.name: axis.at(0.5) for axis in one.shape}
    told = cause(one, values, tuple(0.01 * value for value in values), shape=shape)
    return replace(told, visible=visible)


def test_moves_that_turn_elsewhere_each_time_are_told_from_strokes(joint, random_turns):
    assert not turns_elsewhere(joint)
    assert turns_elsewhere(random_turns)


def test_fast_moves_that_reach_their_speed_later_turn_at_the_same_angles(joint):
    """A tenth of the stroke less at either end at twice the speed is no other turn."""
    table = joint.table
    cut = 0.1 * np.ptp(table.position) * np.log2(table.speed / table.speed.min())
    low, high = table.position.min() + cut / 2, table.position.max() - cut / 2
    assert not turns_elsewhere(joint.part((table.position >= low) & (table.position <= high)))


def test_a_spring_beside_inertia_has_no_name_where_moves_turn_elsewhere(joint, random_turns):
    pair = of("dress_pack", 0.4), of("inertia", 0.6)
    assert [one[0] for one in standing(joint, *pair)] == ["named", "named"]
    found = standing(random_turns, *pair)
    assert [one[0] for one in found] == ["undetermined", "named"]
    assert "inertia" in found[0][1]
    # one that is larger than inertia is not what the form of that misses
    assert standing(random_turns, of("dress_pack", 0.8), pair[1])[0][0] == "named"
    # nor is friction
    assert standing(random_turns, of("position_ripple", 0.4), pair[1])[0][0] == "named"
    assert standing(random_turns, of("dress_pack", 0.4))[0][0] == "named"


@pytest.mark.parametrize(
    ("size", "low", "expected"), [(8.5, 0.19, "visible"), (8.5, 0.5, "named"), (2.0, 0.19, "named")]
)
def test_a_delay_that_a_twentieth_of_load_velocity_would_imitate_has_no_name(
    joint, size, low, expected
):
    """The size of an effect with which the catalogue does not confuse it does not matter."""
    delay = replace(of("torque_delay", 0.6), visible_interval=(low, 0.9))
    beside = replace(of("load_velocity", 0.6), size=size)
    found = standing(joint, delay, beside)
    assert [one[0] for one in found] == [expected, "named"]
    assert ("load velocity" in found[0][1]) == (expected != "named")
    other = replace(of("coulomb_temperature", 0.6), size=size)
    assert standing(joint, delay, other)[0][0] == "named"


def test_no_size_is_claimed_of_what_begins_at_unknown_angles(joint, random_turns):
    for name in ("inertia", "reversal_transient"):
        assert not unclaimed(BY_NAME[name], joint)
        assert "reverse at different angles" in unclaimed(BY_NAME[name], random_turns)
    assert not unclaimed(BY_NAME["dress_pack"], random_turns)


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        # the first run has the first half of the pairs
        ([(0.5, 0.56)], "undetermined"),
        ([(0.0, 0.05), (0.5, 0.56)], "undetermined"),
        # its absence
        ([(0.05, 1.0)], "undetermined"),
        ([(0.5, 1.0)], "named"),
        ([(0.5, 0.7)], "named"),
        ([(0.52, 0.56)], "named"),
        ([(0.3, 1.0)], "named"),
    ],
)
def test_a_step_at_the_start_of_runs_may_be_friction_after_a_rest(joint, parts, expected):
    shape = history(parts)
    ((found, reason),) = standing(joint, of("step_change", 0.6, shape=shape))
    assert found == expected
    assert ("after a rest" in reason) == (expected != "named")
    assert standing(joint, of("payload_change", 0.6, shape=shape))[0][0] == "named"


@pytest.mark.parametrize(
    ("parts", "fall", "expected"),
    [
        # in all but the first pairs of each of two runs
        ([(0.05, 0.5), (0.55, 1.0)], 3.0, "undetermined"),
        ([(0.05, 0.5), (0.55, 1.0)], -3.0, "undetermined"),
        # half of such a fall is less than the change of the load
        ([(0.05, 0.5), (0.55, 1.0)], 0.5, "named"),
        # on the first run only, and for half of each run
        ([(0.05, 1.0)], 3.0, "named"),
        ([(0.25, 0.5), (0.75, 1.0)], 3.0, "named"),
    ],
)
def test_a_payload_at_the_start_of_each_run_may_be_friction_that_falls_there(
    joint, parts, fall, expected
):
    """Friction that falls from one move of a pair to the other is in the load by half of that."""
    payload = of("payload_change", 0.6, shape=history(parts))
    pairs = len(joint.layout.time)
    first = (np.arange(pairs) % (pairs // 2) < 0.05 * pairs)[joint.layout.row_pair]
    friction = joint.friction - joint.friction_misfit + fall * first
    ((found, reason),) = standing(replace(joint, friction=friction), payload)
    assert found == expected
    assert ("from move to move" in reason) == (expected != "named")


@pytest.mark.parametrize(
    ("parts", "gradual", "expected"),
    [
        ([(0.25, 0.5), (0.75, 1.0)], True, "undetermined"),
        ([(0.25, 1.0)], True, "undetermined"),
        ([(0.25, 0.5), (0.75, 1.0)], False, "named"),
        # for a while in the middle of a run, at the end of one
        ([(0.15, 0.35)], False, "named"),
        ([(0.9, 1.0)], False, "named"),
        # a whole run has no course
        ([(0.5, 1.0)], True, "named"),
    ],
)
def test_a_load_that_changes_gradually_within_runs_is_no_payload(joint, parts, gradual, expected):
    """Another joint that moves slowly changes gravity as a payload does, but not at a moment."""
    payload = of("payload_change", 0.6, shape=history(parts))
    pairs = len(joint.layout.time)
    share = (np.arange(pairs) + 0.5) / pairs
    there = np.any([(begin < share) & (share < end) for begin, end in parts], axis=0)
    course = 4.0 * (share % 0.5) if gradual else there
    angle = np.radians(joint.table.angle)
    gravity = np.column_stack([np.cos(angle), np.sin(angle)]) @ payload.fit.coefficients
    load = joint.load + 10.0 * gravity * course[joint.layout.row_pair]
    ((found, reason),) = standing(replace(joint, load=load), payload)
    assert found == expected
    assert ("gradually" in reason) == (expected != "named")


@pytest.mark.parametrize(
    ("places", "expected"),
    [
        ([5, 15, 20], "undetermined"),
        # two pairs after the rest, a pair before it, once only
        ([5, 6, 15, 16], "named"),
        ([4, 14, 19], "named"),
        ([5], "named"),
    ],
)
def test_a_payload_of_the_first_pairs_after_rests_may_be_friction_there(joint, places, expected):
    """Every fifth pair follows a rest of a minute, all others at once."""
    pairs = len(joint.layout.time)
    _, heads = np.unique(joint.layout.row_pair, return_index=True)
    stroke = np.maximum.reduceat(joint.table.position, heads)
    stroke -= np.minimum.reduceat(joint.table.position, heads)
    moving = 2 * stroke / joint.layout.speed
    pause = np.where(np.arange(pairs) % 5 == 0, 60.0, 0.5)
    time = np.cumsum(moving + pause) - moving / 2
    rested = replace(joint, layout=replace(joint.layout, time=time))
    shape = history([(place / pairs, (place + 1) / pairs) for place in places])
    ((found, reason),) = standing(rested, of("payload_change", 0.6, shape=shape))
    assert found == expected
    assert ("after rests" in reason) == (expected != "named")


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        # the second half of each of two runs, as the joint is warm
        ([(0.25, 0.5), (0.75, 1.0)], "undetermined"),
        # from the middle of a run on, for good
        ([(0.25, 1.0)], "named"),
    ],
)
def test_a_step_that_comes_in_each_run_at_a_temperature_may_be_one_of_temperature(
    joint, parts, expected
):
    pairs = len(joint.layout.time)
    row_pair = joint.layout.row_pair
    step = of("step_change", 0.6, shape=history(parts))
    daily = 20.0 + 40.0 * ((np.arange(pairs) % (pairs // 2)) / pairs)[row_pair]
    weather = 20.0 + 10.0 * np.sin(1.7 * np.arange(pairs))[row_pair]
    for temperature, standing_then in ((daily, expected), (weather, "named")):
        table = replace(joint.table, measured_temperature=temperature)
        ((found, reason),) = standing(replace(joint, table=table), step)
        assert found == standing_then
        assert ("depends on temperature" in reason) == (found != "named")


@pytest.mark.parametrize(
    ("change", "other", "parts", "expected"),
    [
        # each of two runs warms up in its first half
        ("step_change", "thermal_lag", [(0.25, 0.5), (0.75, 1.0)], "undetermined"),
        # the gear goes on warming for a while
        ("step_change", "thermal_lag", [(0.28, 0.5), (0.78, 1.0)], "undetermined"),
        ("step_change", "rest_recovery", [(0.25, 0.5), (0.75, 1.0)], "undetermined"),
        ("payload_change", "rest_recovery", [(0.25, 0.5), (0.75, 1.0)], "undetermined"),
        # a lag does not show in the load, nor drift at a turn; a step that lasts is there always
        ("payload_change", "thermal_lag", [(0.25, 0.5), (0.75, 1.0)], "named"),
        ("step_change", "drift", [(0.25, 0.5), (0.75, 1.0)], "named"),
        ("step_change", "thermal_lag", [(0.25, 1.0)], "named"),
        ("step_change", "thermal_lag", [(0.15, 0.5), (0.65, 1.0)], "named"),
    ],
)
def test_a_small_change_as_the_joint_turns_to_cool_may_be_the_form_of_another_cause(
    joint, change, other, parts, expected
):
    pairs = len(joint.layout.time)
    hours = (np.arange(pairs) % (pairs // 2)) / (pairs // 2)
    time = 9000.0 * hours[joint.layout.row_pair]
    # up and down between 20 and 45 °C, with a slope that no weather has
    warm = 20.0 + 50.0 * np.minimum(time, 9000.0 - time) / 9000.0
    table = replace(joint.table, time=time, measured_temperature=warm)
    turned = replace(joint, table=table)
    one, two = of(change, 0.6, shape=history(parts)), of(other, 2.0)
    # nothing else is there, so that friction which follows the temperature gradually is no rival
    there = turned.basis(one.fit.effect, one.fit.shape).friction @ one.fit.coefficients
    turned = replace(turned, friction=turned.friction - turned.friction_misfit + there)
    # the lag that is found may have fewer columns than the entry of the catalogue
    if other == "thermal_lag":
        two = replace(two, fit=replace(two.fit, effect=replace(two.fit.effect, source="")))
    judged = with_standing((one, two), turned, MARGIN, ALPHA)
    found, reason = judged[0].standing, judged[0].reason
    # what comes at the same temperature in each run is doubtful for that reason already
    assert (found == "undetermined" and "turns from" in reason) == (expected == "undetermined")
    # a larger one is not what the form of the other misses
    larger = replace(one, visible=0.7)
    judged = with_standing((larger, two), turned, MARGIN, ALPHA)
    assert "turns from" not in judged[0].reason


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        # the second half of the run seen and of the one that was kept out
        ([(0.25, 0.5), (0.75, 1.0)], True),
        # from the middle of the run seen on, for good
        ([(0.25, 1.0)], False),
    ],
)
def test_a_step_that_the_held_out_run_has_at_the_same_temperature_may_be_one_of_temperature(
    joint, parts, expected
):
    pairs = len(joint.layout.time)
    warming = 20.0 + 40.0 * ((np.arange(pairs) % (pairs // 2)) / pairs)[joint.layout.row_pair]
    warm = replace(joint, table=replace(joint.table, measured_temperature=warming))
    seen, new = (warm.part(warm.table.run == number) for number in (0, 1))
    step = of("step_change", 0.6, shape=history(parts))
    # one run alone does not show it
    assert standing(seen, step)[0][0] == "named"
    assert bool(doubtful_with_new_run(step.fit, seen, new)) is expected


def test_a_play_at_one_speed_may_be_a_delay(joint):
    play = of("backlash", 0.7)
    assert standing(joint, play) == [("named", "")]
    one_speed = replace(joint.layout, speed=np.full_like(joint.layout.speed, 40.0))
    ((found, reason),) = standing(replace(joint, layout=one_speed), play)
    assert found == "undetermined"
    assert "one speed" in reason
