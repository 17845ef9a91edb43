"""Metrics of the offset of distance control: extremes, speeds, noise, alarms."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import ON, ROWS, WITH_CONST_DIST, K, no_value, recorded, seen

from axisrig.bench.judge.distance.truth import (
    ACTIVE_CONST_DIST,
    ERROR,
    FREEZE,
    INACTIVE,
    TURNING_OFF,
)
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.distance import DistanceOrder
from axisrig.bench.record.facts import AlarmRecord
from axisrig.kernel.time.clock import MS, US


def course(*values: tuple[int, float]) -> Any:
    """From each row on an offset, mm."""
    offset = np.zeros(ROWS)
    for row, value in values:
        offset[row:] = value
    return offset


UP_AND_DOWN = course((50, 3.0), (60, 0.0), (300, 0.5), (600, -0.3), (900, 0.2))


@pytest.mark.parametrize(
    ("metric", "value"),
    [
        ("offset_end_mm", 0.2),
        ("offset_mm_max", 3.0),  # also before the control is on
        ("offset_mm_min", -0.3),
        ("offset_speed_mm_s_max", 800.0),  # what is handed over while it is off is no step
        ("offset_speed_down_mm_s_max", 800.0),
        ("offset_acceleration_mm_s2_max", 0.8e6),
    ],
)
def test_the_offset_has_its_extremes(metric: str, value: float) -> None:
    found = seen(recorded(columns={"offset_mm": UP_AND_DOWN}), metric)
    assert found.value == pytest.approx(value)


def test_only_steps_towards_the_workpiece_are_down() -> None:
    rising = recorded(columns={"offset_mm": course((300, 0.5), (600, 0.75))})
    assert seen(rising, "offset_speed_down_mm_s_max").value == 0.0
    assert seen(rising, "offset_speed_mm_s_max").value == pytest.approx(500.0)
    falling = recorded(columns={"offset_mm": course((300, -0.25))})
    assert seen(falling, "offset_speed_down_mm_s_max").value == pytest.approx(250.0)


def test_what_runs_out_is_a_step_and_what_is_handed_over_is_none() -> None:
    """The row after one in TURNING_OFF still moves; from INACTIVE on nothing does."""
    state = np.full(ROWS, float(ACTIVE_CONST_DIST))
    state[:ON], state[500:510], state[510:] = INACTIVE, TURNING_OFF, INACTIVE
    for row, speed in ((499, 500.0), (505, 500.0), (510, 500.0), (511, 0.0), (99, 0.0)):
        columns = {"distance_state": state, "offset_mm": course((row, 0.5))}
        found = seen(recorded(columns=columns), "offset_speed_mm_s_max")
        assert found.value == pytest.approx(speed), row


def test_an_acceleration_counts_while_the_control_is_on() -> None:
    for row, value in ((300, 0.5e6), (50, 0.0)):
        observed = recorded(columns={"offset_mm": course((row, 0.5))})
        assert seen(observed, "offset_acceleration_mm_s2_max").value == pytest.approx(value)
    assert no_value(recorded(state=FREEZE), "offset_acceleration_mm_s2_max") == (
        "distance control was never on"
    )


def test_noise_is_that_of_the_last_half_of_the_steady_part() -> None:
    """1 um on either side from row 540 on, 10 um before; 899 rows are steady."""
    noise = np.where(K % 2, 1.0, -1.0) * np.where(K < 540, 0.010, 0.001)
    assert seen(recorded(columns={"offset_mm": noise}), "offset_noise_um").value == pytest.approx(
        1.0, abs=1e-3
    )


@pytest.mark.parametrize(
    ("state", "word"), [(ACTIVE_CONST_DIST, "ACTIVE_CONST_DIST"), (FREEZE, "FREEZE")]
)
def test_the_state_at_the_end_has_its_word(state: int, word: str) -> None:
    states = np.where(K < ROWS - 1, float(ACTIVE_CONST_DIST), float(state))
    found = seen(recorded(columns={"distance_state": states}), "distance_state_end")
    assert found.value == word


def test_without_a_hold_or_a_freeze_nothing_drifts() -> None:
    assert no_value(recorded(), "freeze_drift_um") == "distance control was never frozen"
    words = "neither feedhold nor override of the axis held the offset"
    assert no_value(recorded(), "offset_held_drift_um") == words
    held = {"distance_held": ((K >= 400) & (K < 500)).astype(float),
            "offset_mm": course((450, 0.002))}  # fmt: skip
    found = seen(recorded(columns=held), "offset_held_drift_um")
    assert found.value == pytest.approx(2.0)
    assert found.note == "held 1 time(s)"


def test_the_own_model_is_compared_while_the_control_is_on() -> None:
    """With no error the model stays where it began; the recording is 3 um off in a row of it."""
    for row, um in ((400, 3.0), (50, 0.0)):
        columns = {"offset_mm": np.where(row == K, 0.003, 0.0)}
        found = seen(recorded(columns=columns), "offset_model_error_um")
        assert found.value == pytest.approx(um, abs=1e-9), row
    assert no_value(recorded(state=INACTIVE), "offset_model_error_um") == (
        "distance control was never on"
    )


@pytest.mark.parametrize("behind", [0, 1, 2])
def test_both_encoders_are_compared_with_what_was_sent_in_the_cycle_before(behind: int) -> None:
    """The axis goes 10 mm/s and is where it was sent so many cycles ago.

    Where it was sent in the cycle before it has no lag: the gap alone is what the law sees, and it
    is the set distance. Each cycle more is 10 um of error, of which kp 0.2 makes 2 um a cycle.
    """
    way_mm = np.clip((K - 300) * 0.01, 0.0, 1.0)
    columns = {"set_mm": way_mm, "actual_mm": np.clip((K - behind - 300) * 0.01, 0.0, 1.0)}
    found = seen(
        recorded(columns=columns, words={"mode_dist_use_both_encoder": 1}), "offset_model_error_um"
    )
    # A hundred cycles of motion, and the one in which the axis starts and stops
    assert found.value == pytest.approx(200.0 * abs(behind - 1), rel=0.02, abs=1e-6)
    plain = seen(recorded(columns=columns), "offset_model_error_um")
    assert plain.value == pytest.approx(0.0, abs=1e-9)


# Alarms: the sensor value is the negative gap; the lower end is -5 mm, a jump is not watched


def below(row: int) -> Any:
    """The tool is 4 mm farther away than the 2 mm it should be, from a row on."""
    return np.where(row <= K, -4.0, 0.0)


def raised(observed: Observed, *alarms: tuple[int, int, bool]) -> Observed:
    """alarms: row of the cycle, ID, whether it is a further one."""
    records = tuple(
        AlarmRecord(row * MS + 600 * US, number, 7, True, "", is_further=further)
        for row, number, further in alarms
    )
    return Observed(replace(observed.facts, alarms=records), observed.series)


FAR = {"max_act_value_change": 10**9, "max_deviation": 10**9}
LATE, AFTER = "distance_alarm_late_cycles", "distance_alarm_after_cycles"


@pytest.mark.parametrize(
    ("alarms", "late"),
    [
        (((500, 70576, False),), 0.0),
        (((502, 70576, False),), 2.0),
        (((499, 70576, False),), -1.0),
        (((490, 70330, True), (501, 70576, False)), 1.0),  # a further one is none of them
        (((490, 50059, False), (501, 70576, False)), 1.0),  # of another function
        (((501, 70576, False), (503, 70576, False)), 1.0),
        (((501, 310020, False),), 1.0),  # the newer ID of the same cause
    ],
)
def test_an_alarm_is_late_by_the_cycles_since_it_was_due(
    alarms: tuple[tuple[int, int, bool], ...], late: float
) -> None:
    observed = raised(recorded(below(500), words=FAR), *alarms)
    found = seen(observed, LATE)
    assert found.value == pytest.approx(late)
    assert found.note.endswith("due in the cycle of 500 ms")


@pytest.mark.parametrize("late", [0, 3])
def test_an_alarm_is_due_in_the_cycle_in_which_the_control_fails(late: int) -> None:
    """The state of its row is ERROR already: what this cycle has read counts all the same."""
    state = np.where(K < ON, float(INACTIVE), float(ACTIVE_CONST_DIST))
    state[500 + late :] = ERROR
    observed = recorded(below(500), words=FAR, columns={"distance_state": state})
    found = seen(raised(observed, (500 + late, 70576, False)), LATE)
    assert found.value == pytest.approx(late)


@pytest.mark.parametrize("alarm_id", [70329, 70330, 70331, 70576, 900314])
def test_alarms_of_sensor_and_offset_are_counted_from_the_first_step(alarm_id: int) -> None:
    """The program switches on in row 99, so that row 100 makes the first step."""
    for row, cycles in ((100, 0), (101, 1), (350, 250)):
        observed = raised(recorded(), (row, alarm_id, False))
        found = seen(observed, AFTER)
        assert found.value == cycles
        assert found.note == f"ID {alarm_id}"
    by_plc = recorded(orders=(DistanceOrder(ON * MS, "PLC", "ON_CONST_DIST"),))
    assert seen(raised(by_plc, (350, alarm_id, False)), AFTER).value == 250


@pytest.mark.parametrize(
    ("changes", "alarms", "words"),
    [
        ({}, (), "due: none, raised: none"),
        ({}, ((500, 70576, False),), "due: none, raised: 70576"),
        ({"behind_mm": below(500), "words": FAR}, (), "due: 70576, raised: none"),
        ({"behind_mm": below(500), "words": FAR}, ((500, 70330, False),),
         "due was 70576, raised 70330"),
        ({"behind_mm": below(500)}, (), "due: 70329, raised: none"),
        ({"behind_mm": -below(500) * 2, "words": {**FAR, "max_pos": -10_000}}, (),
         "due: 70330, raised: none"),
        ({"behind_mm": below(500), "words": {**FAR, "min_pos": -50_000, "tolerance": -20_000}}, (),
         "due: none, raised: none"),
    ],
)  # fmt: skip
def test_an_alarm_that_is_not_both_due_and_raised_says_which(
    changes: Mapping[str, Any], alarms: tuple[tuple[int, int, bool], ...], words: str
) -> None:
    assert no_value(raised(recorded(**changes), *alarms), LATE) == words


def test_without_an_alarm_nothing_came_after_the_begin() -> None:
    assert no_value(recorded(), AFTER) == "no alarm of sensor or offset came up"
    assert WITH_CONST_DIST.by == "NC"


def switched(*spans: tuple[int, int]) -> dict[str, Any]:
    """On in some rows, by the program, which switches in the row before."""
    state = np.full(ROWS, float(INACTIVE))
    orders: list[DistanceOrder] = []
    for begin, end in spans:
        state[begin:end] = ACTIVE_CONST_DIST
        orders += [DistanceOrder((begin - 1) * MS, "NC", "ON_CONST_DIST"),
                   DistanceOrder((end - 1) * MS, "NC", "OFF")]  # fmt: skip
    return {"columns": {"distance_state": state}, "orders": tuple(orders)}


@pytest.mark.parametrize(
    ("spans", "row", "cycles"),
    [
        (((200, 900),), 700, 500),
        (((200, 300), (600, 900)), 700, 500),
        (((200, 300), (600, 900)), 600, 400),
        (((200, 300), (400, 500), (600, 900)), 250, 50),
        (((200, 300), (400, 500), (600, 900)), 350, 150),  # while it is off
    ],
)
def test_an_alarm_is_counted_from_the_first_time_that_the_control_was_on(
    spans: tuple[tuple[int, int], ...], row: int, cycles: int
) -> None:
    """However often it was switched on meanwhile."""
    observed = raised(recorded(**switched(*spans)), (row, 70576, False))
    assert seen(observed, AFTER).value == cycles


@pytest.mark.parametrize("changed", [150, 400, 650])
def test_another_law_is_no_other_begin(changed: int) -> None:
    """A gain that the program writes meanwhile, before the alarm or after it."""
    words = {"kp": 0.3}
    orders = (WITH_CONST_DIST, DistanceOrder(changed * MS, "NC", words=words))
    observed = raised(recorded(orders=orders), (500, 70576, False))
    assert seen(observed, AFTER).value == 400


def test_the_first_alarm_of_sensor_or_offset_counts() -> None:
    alarms = ((300, 50059, False), (350, 70576, True), (400, 70330, False), (500, 70576, False))
    found = seen(raised(recorded(), *alarms), AFTER)
    assert (found.value, found.note) == (300, "ID 70330")
