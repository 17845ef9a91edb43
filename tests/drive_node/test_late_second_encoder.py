"""A second encoder that is shown late: by so many SYNCs, or samples apart from them."""

from typing import Any

import pytest
from tests.drive_node.servo_alone import PER_M, ServoAlone

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

OFFSET_M, SPEED_M_S = 0.002, 0.5


def _moving(fake_axis: Any, delay: int) -> ServoAlone:
    """Return a servo whose axis moves evenly, whatever comes."""
    axis = fake_axis(motion=lambda time_s: SPEED_M_S * time_s, encoder_2_m=OFFSET_M)
    return ServoAlone(axis, profile=DriveProfile(second_delay_cycles=delay))


def _shown(one: ServoAlone, age_ms: float) -> None:
    """Check the second encoder of so long ago; the first one is of now."""
    time_s = one.now_ns * 1e-9
    was_m = SPEED_M_S * (time_s - age_ms * 1e-3) + OFFSET_M
    assert one.image.second_position == pytest.approx(was_m * PER_M, abs=1)
    assert one.image.position_actual == pytest.approx(SPEED_M_S * time_s * PER_M, abs=1)


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_a_late_second_encoder_is_of_an_earlier_sync(fake_axis: Any, delay: int) -> None:
    """Reading it by SDO between two SYNCs makes it no older."""
    one = _moving(fake_axis, delay)
    for _ in range(delay):
        one.cycle()
    for _ in range(3):
        one.cycle()
        _shown(one, delay)
        one.run_ms(0.4)
        one.servo.refresh(one.now_ns)


def test_before_there_were_so_many_samples_the_oldest_one_is_shown(fake_axis: Any) -> None:
    """The first SYNC is at 1 ms."""
    one = _moving(fake_axis, delay=6)
    for now_ms in range(4, 10):
        one.cycle()
        _shown(one, min(6, now_ms - 1))


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_where_samples_are_sent_apart_from_the_sync_those_count_alone(
    fake_axis: Any, delay: int
) -> None:
    """0.3 ms after each SYNC: so many of these ago, and no SYNC counts between them."""
    one = _moving(fake_axis, delay)
    for number in range(delay + 5):
        one.cycle()
        one.run_ms(0.3)
        one.servo.refresh(one.now_ns, is_apart=True)
        if number > delay:
            _shown(one, delay)


@pytest.mark.parametrize("home_units", [0, 5000, -70_000])
def test_a_home_of_the_motor_encoder_moves_no_second_one(fake_axis: Any, home_units: int) -> None:
    """607C and homing shift 6064; 60E4:1 has the scaling of docs/drive.md and nothing beside it."""
    one = ServoAlone(fake_axis(start_m=0.02, encoder_2_m=OFFSET_M))
    before = one.image.second_position
    assert before == round((0.02 + OFFSET_M) * PER_M)
    one.servo.scaling.set_home(0.02, home_units)
    one.cycle()
    assert (one.image.position_actual, one.image.second_position) == (home_units, before)
