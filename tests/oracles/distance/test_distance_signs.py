"""Signs, lists, dead cycles and the instant of an alarm."""

import math

import numpy as np
import pytest

from axisrig.bench.oracles.distance.cycles import NotMeasurableError, Sent, measured, predicted
from axisrig.bench.oracles.distance.lists import Control, Limits, as_written
from axisrig.bench.oracles.distance.loop import SET_POS
from axisrig.bench.oracles.distance.model import Law, Rig, simulate
from axisrig.bench.oracles.distance.signs import TABLE, Signs
from axisrig.bench.oracles.distance.signs import predicted as due_with
from axisrig.bench.oracles.distance.supervision import (
    ABOVE,
    BELOW,
    JUMP,
    OFFSET,
    changes_mm,
    first_due,
)

PERIOD_NS = 1_000_000
LIMITS = Limits(50.0, 1e6, 3.0, 1e9, -5.0, 5.0)


@pytest.mark.long(but=1)
@pytest.mark.parametrize("signs", TABLE, ids=str)
def test_only_the_documented_signs_converge(signs: Signs) -> None:
    """Half of the twelve; the others end at a limit, later with a smaller kp."""
    due = {
        kp: due_with(signs, Law(signs.mode, Control(kp), PERIOD_NS, LIMITS), Rig(), 1.5, 1.0)
        for kp in (0.002, 0.02)
    }
    if signs.converges:
        assert set(due.values()) == {None}
        return
    early, late = due[0.02], due[0.002]
    assert early is not None
    assert late is not None
    assert early.alarm in (ABOVE, BELOW, OFFSET)
    assert early.row < late.row


def test_twelve_combinations() -> None:
    assert len(TABLE) == 12
    assert sum(signs.converges for signs in TABLE) == 6


@pytest.mark.parametrize(
    ("values", "offset", "alarm", "row"),
    [
        ([0, 0, 0.02, 0.02], [0, 0, 0, 0], JUMP, 2),
        ([0, 0, 0.01, 0.02], [0, 0, 0, 0], None, None),
        ([0.99, 0.995, 1.001, 1.0], [0, 0, 0, 0], ABOVE, 2),
        ([-1.99, -1.995, -2.0, -2.001], [0, 0, 0, 0], BELOW, 3),
        ([0, 0, 0, 0], [0, 0.49, 0.51, 0.5], OFFSET, 2),
        # Of several the one that comes first
        ([0.995, 1.001, 1.001, 0.5], [0, 0, 0, 0], ABOVE, 1),
        ([-1.995, -2.001, -2.001, 0], [0, 0, 0.51, 0], BELOW, 1),
        ([0, 0, 0.02, 0], [0.51, 0, 0, 0], OFFSET, 0),
        ([0, 0, 0.02, 0.02], [0, 0, 0, 0.51], JUMP, 2),
    ],
)
def test_alarms_are_due_in_the_cycle_of_the_value(
    values: list[float], offset: list[float], alarm: int | None, row: int | None
) -> None:
    limits = Limits(1.0, 1.0, 0.5, 10.0, -2.0, 1.0)
    watched = np.ones(4, dtype=bool)
    sensor = np.array(values, dtype=np.float64)
    due = first_due(sensor, changes_mm(sensor), np.array(offset), watched, limits, PERIOD_NS)
    assert (None if due is None else (due.alarm, due.row)) == (
        None if alarm is None else (alarm, row)
    )


@pytest.mark.parametrize("is_optimized", [False, True])
@pytest.mark.parametrize("age", [0, 1, 3])
def test_dead_cycles_from_frames(is_optimized: bool, age: int) -> None:
    """Frames of the model: the sensor value steps, a set position answers, the value shows it."""
    increment = 1e-4
    surface = np.where(np.arange(60) < 20, 0.0, 0.5)
    expected = predicted(is_optimized=is_optimized, sensor_age_cycles=age)
    rig = Rig(expected.reaction, skew_cycles=age, increment_mm=increment)
    course = simulate(Law("CONST_DIST", Control(0.2), PERIOD_NS), rig, surface, 5.0, 5.0)
    sensor = [
        Sent(k * PERIOD_NS + 300_000, round(value / increment))
        for k, value in enumerate(course.sensor_mm)
    ]
    sent = np.concatenate([np.zeros(expected.reaction), course.offset_mm])[: len(surface)]
    targets = [
        Sent(k * PERIOD_NS + 700_000, round((5.0 + value) / increment))
        for k, value in enumerate(sent)
    ]
    found = measured(targets, sensor, PERIOD_NS)
    assert found.cycles.reaction == expected.reaction
    assert found.cycles.way == expected.way
    assert found.cycles.dead == expected.dead == (1 if is_optimized else 2) + age
    assert found.way_ns == (2 + age) * PERIOD_NS - 400_000


def test_frames_that_show_no_step() -> None:
    still = [Sent(k * PERIOD_NS, 5) for k in range(5)]
    with pytest.raises(NotMeasurableError, match="never changed"):
        measured(still, still, PERIOD_NS)
    moving = [Sent(k * PERIOD_NS, 3 * k) for k in range(9)]
    answer = [Sent(k * PERIOD_NS + 7, 0 if k < 4 else 1) for k in range(9)]
    with pytest.raises(NotMeasurableError, match="no step"):
        measured(answer, moving, PERIOD_NS)
    with pytest.raises(NotMeasurableError, match="no set position"):
        measured(still, moving, PERIOD_NS)


@pytest.mark.parametrize(
    ("is_optimized", "every", "dead"), [(True, 1, 1), (True, 2, 1), (True, 3, 2), (False, 2, 3)]
)
def test_a_telegram_that_comes_seldom(is_optimized: bool, every: int, dead: int) -> None:
    assert predicted(is_optimized=is_optimized, every=every).dead == dead


@pytest.mark.parametrize("every", [1, 2, 3, 5])
@pytest.mark.parametrize(("age", "late"), [(0, 0), (1, 0), (0, 1), (2, 1)])
@pytest.mark.parametrize("is_optimized", [True, False])
def test_a_late_value_waits_for_a_telegram_that_comes_seldom(
    is_optimized: bool, age: int, late: int, every: int
) -> None:
    """Telegrams come in cycles 0, every, 2 every: the first that can show the offset of cycle 0."""
    sent = 0 if is_optimized else 1
    can_show = sent + 2 + age + late
    shown = next(cycle for cycle in range(0, 99, every) if cycle >= can_show)
    found = predicted(
        is_optimized=is_optimized, sensor_age_cycles=age, every=every, late_cycles=late
    )
    assert (found.reaction, found.way, found.age) == (sent, shown - sent, age)
    assert found.dead == shown - 1


def test_lists_as_written() -> None:
    listed = as_written({})
    assert listed.control == Control()
    assert listed.limits == Limits(5.0, 1000.0, 5.0, 5.0, -5.0, 5.0)
    listed = as_written(
        {
            "kenngr.distc.kp": 0.3,
            "kenngr.dist_ctrl[0].kp": 0.4,
            "kenngr.distc.toleranz": 1000,
            "kenngr.distc.max_pos": 20000,
            "kenngr.distc.use_adaptive_acceleration": 1,
            "kenngr.distc.v_weight_down": 400,
            "lr_hw[1].encoder_resolution_denom": 100_000,
            "lr_hw[1].encoder_resolution_num": 1_048_576,
            "lr_hw[1].vz_istw": 1,
            "kenngr.distc.ref_offset": 5000,
        }
    )
    assert listed.control.kp == 0.4
    assert (listed.limits.low_mm, listed.limits.high_mm) == pytest.approx((-4.9, 1.9))
    assert listed.limits.adaptive == (500.0, 0.1, 0.5)
    assert listed.sensor_mm(1_048_576) == pytest.approx(-10.5)


def test_the_clamp_of_the_deviation_tells_what_was_asked() -> None:
    law = Law(SET_POS, Control(0.5), PERIOD_NS, Limits(math.inf, math.inf, 0.4, 1.0, -1.0, 1.0))
    assert law.walk(0.6, 0.0, 0.0, 0.0) == 0.3
    assert law.walk(0.6, 0.0, 0.0, 0.0) == 0.4
    assert law.asked_mm == pytest.approx(0.45)


def test_frames_of_a_ramp_and_of_noise_show_no_step() -> None:
    """The value that follows the answer has to come back, and the first one to come from rest."""
    ramp = [Sent(k * PERIOD_NS, max(0, k - 5)) for k in range(12)]
    answer = [Sent(k * PERIOD_NS + 7, max(0, k - 5)) for k in range(12)]
    with pytest.raises(NotMeasurableError, match="went on changing: no step"):
        measured(answer, ramp, PERIOD_NS)
    noise = [Sent(k * PERIOD_NS, k % 2) for k in range(12)]
    answering = [Sent(k * PERIOD_NS + 7, 0 if k < 3 else (-1) ** k) for k in range(12)]
    turning = [Sent(k * PERIOD_NS, 0 if k < 5 else (-1) ** k) for k in range(12)]
    with pytest.raises(NotMeasurableError, match="was not constant before the sensor value"):
        measured(answering, turning, PERIOD_NS)
    at_once = [Sent(k * PERIOD_NS + 7, 0 if k < 1 else 1) for k in range(12)]
    with pytest.raises(NotMeasurableError, match="was not constant before its change: no step"):
        measured(at_once, noise, PERIOD_NS)


@pytest.mark.parametrize(("quiet", "is_step"), [(2, False), (3, True), (9, True)])
@pytest.mark.parametrize("first", [0, 500])
def test_a_step_comes_after_three_cycles_of_rest(quiet: int, is_step: bool, first: int) -> None:
    """Wherever the record begins; the answer is one cycle later and shows after two more."""

    def course(step: int, back: int) -> list[int]:
        return [0 if k < quiet else step if k < quiet + 3 else back for k in range(quiet + 8)]

    sensor = [Sent((first + k) * PERIOD_NS, v) for k, v in enumerate(course(10, 4))]
    targets = [
        Sent((first + k) * PERIOD_NS + 7, 0 if k < quiet + 1 else -6) for k in range(quiet + 8)
    ]
    if not is_step:
        with pytest.raises(NotMeasurableError, match="was not constant before its change"):
            measured(targets, sensor, PERIOD_NS)
        return
    found = measured(targets, sensor, PERIOD_NS)
    assert (found.cycles.reaction, found.cycles.way) == (1, 2)
    assert found.way_ns == 2 * PERIOD_NS - 7
    assert measured(targets, sensor, PERIOD_NS, quiet_increments=5).cycles == found.cycles
    with pytest.raises(NotMeasurableError, match="never changed"):
        measured(targets, sensor, PERIOD_NS, quiet_increments=10)
    with pytest.raises(NotMeasurableError, match="no sensor value showed"):
        measured(targets, sensor, PERIOD_NS, quiet_increments=6)


def courses(sensor: list[int], target: list[int]) -> tuple[list[Sent], list[Sent]]:
    """Frames of each cycle: set positions 7 ns after the sensor values."""
    return (
        [Sent(k * PERIOD_NS + 7, value) for k, value in enumerate(target)],
        [Sent(k * PERIOD_NS, value) for k, value in enumerate(sensor)],
    )


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("meanwhile", "is_step"), [(10, True), (12, True), (13, False), (7, False)]
)
def test_between_step_and_answer_the_sensor_value_rests_but_for_its_noise(
    side: int, meanwhile: int, is_step: bool
) -> None:
    """10 increments at 5 T, another value at 7 T, the answer at 8 T, which shows at 10 T."""
    sensor = [0] * 5 + [10] * 2 + [meanwhile] * 3 + [2] * 4
    answer = [0] * 8 + [-6] * 6
    frames = courses([side * one for one in sensor], [side * one for one in answer])
    if is_step:
        found = measured(*frames, PERIOD_NS, quiet_increments=2)
        assert (found.cycles.reaction, found.cycles.way) == (3, 2)
        assert (found.seen_ns, found.shown_ns) == (5 * PERIOD_NS, 10 * PERIOD_NS)
        return
    with pytest.raises(NotMeasurableError, match="went on changing: no step"):
        measured(*frames, PERIOD_NS, quiet_increments=2)


def test_the_noise_of_the_sensor_excuses_no_set_position() -> None:
    """One increment of the set position before the step is a motion of its own."""
    sensor = [0] * 5 + [10] * 5 + [2] * 4
    for moved in (0, 1, -1):
        frames = courses(sensor, [0] * 2 + [moved] * 6 + [-6] * 6)
        if not moved:
            assert measured(*frames, PERIOD_NS, quiet_increments=5).cycles.reaction == 3
            continue
        with pytest.raises(NotMeasurableError, match="the set position was not constant before"):
            measured(*frames, PERIOD_NS, quiet_increments=5)
