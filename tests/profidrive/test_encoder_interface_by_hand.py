"""G1_ZSW and G1_XIST2 telegram by telegram: what was read stays, and each run begins anew."""

from dataclasses import replace

import pytest
from tests.profidrive.test_profidrive_control import POS, READING, SETTINGS, Bus, cycles

from axisrig.kernel.drives.profidrive.encoder import EncoderControl
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.profidrive import words

VALUE = POS << words.VALUE_SHIFT


def clear(echo: int = 2) -> EncoderControl:
    control = EncoderControl(POS, echo)
    cycles(control, *[(0, 0)] * (echo + 1))
    assert control.is_clear
    return control


def measured(control: EncoderControl, *values: int) -> None:
    """A run: active, the edge, the command to read, and the values that come then."""
    control.arm()
    cycles(control, (0, 0), (0, 0), (POS, 0), (VALUE, 0))
    assert control.has_latched
    assert control.control == READING
    cycles(control, (VALUE, 0), *((VALUE, value) for value in values))


@pytest.mark.parametrize(
    ("values", "increments"),
    [
        ((7, 7), 7), ((7, 8), None), ((7, 8, 8), 8), ((7, 8, 7), None), ((7, 7, 9, 9, 9), 7),
        ((0, 0), 0), ((-5, -5), -5),
    ],
)  # fmt: skip
def test_the_first_value_that_two_telegrams_in_a_row_have_is_the_measured_one(
    values: tuple[int, ...], increments: int | None
) -> None:
    control = clear()
    measured(control, *values)
    assert control.increments == increments


def test_a_telegram_without_the_value_between_two_begins_anew() -> None:
    control = clear()
    measured(control, 7)
    cycles(control, (VALUE | words.PARK, 7), (VALUE, 7))
    assert control.increments is None
    cycles(control, (VALUE, 7))
    assert control.increments == 7


def test_each_run_is_armed_by_its_own_telegram() -> None:
    """On, off, on: neither what was active nor what was measured before is left."""
    control = clear()
    for value in (7, 8, 9):
        control.arm()
        assert (control.is_armed, control.has_latched, control.increments) == (False, False, None)
        control.disarm()
        cycles(control, *[(0, 0)] * 5)
        measured(control, value, value)
        assert (control.is_armed, control.increments) == (True, value)
        control.disarm()
        assert not control.is_armed
        cycles(control, *[(VALUE, value)] * 3, *[(0, 0)] * 4)
        assert control.is_clear


def test_a_value_that_was_read_in_the_run_before_is_no_first_reading_of_this_one() -> None:
    """The run ends after one reading; the next one latches the same place at once."""
    control = clear()
    measured(control, 7)
    control.disarm()
    cycles(control, *[(VALUE, 7)] * 3, *[(0, 0)] * 4)
    control.arm()
    cycles(control, (0, 0), (0, 0), (VALUE, 0))
    assert control.control == READING
    cycles(control, (VALUE, 7), (VALUE, 7))
    assert control.increments is None
    cycles(control, (VALUE, 7))
    assert control.increments == 7


def test_a_run_is_armed_only_once_the_drive_shows_the_function() -> None:
    control = clear()
    control.arm()
    cycles(control, (0, 0), (0, 0), (0, 0))
    assert not control.is_armed
    cycles(control, (POS, 0))
    assert control.is_armed


@pytest.mark.parametrize(
    ("status", "value", "answer"),
    [
        (words.ABSOLUTE, -42, -42), (0, 5, "G1_ZSW 0x0000, G1_XIST2 5"),
        (
            words.ABSOLUTE | words.ENCODER_ERROR, 6,
            f"G1_ZSW 0x{words.ABSOLUTE | words.ENCODER_ERROR:04X}, G1_XIST2 6",
        ),
    ],
)  # fmt: skip
def test_an_absolute_position_is_one_without_an_error_only(
    status: int, value: int, answer: int | str
) -> None:
    control, found = clear(), list[int | str]()
    assert control.ask_absolute(found.append)
    assert not control.ask_absolute(found.append)  # one at a time
    cycles(control, (0, 0), (status, value))
    assert found == []
    cycles(control, (status, value), (status, value))
    assert found == [answer]


def test_a_value_of_another_function_is_none_of_this_run() -> None:
    """Bit 5 of G1_ZSW is the value of function 2, bit 4 that of function 1, which was activated."""
    control = clear()
    control.arm()
    other = VALUE << 1
    cycles(control, (0, 0), (0, 0), (POS, 0), (other, 9), (other, 9), (other, 9))
    assert (control.has_latched, control.increments) == (False, None)
    cycles(control, (VALUE, 0))
    assert control.has_latched


def test_a_run_that_is_ended_takes_nothing_from_a_question_for_the_place() -> None:
    """No run is under way: a latch that is switched off once more drops nothing."""
    control, found = clear(), list[int | str]()
    control.disarm()
    assert control.is_clear
    assert control.ask_absolute(found.append)
    cycles(control, (0, 0))
    control.disarm()
    assert (control.control, control.is_ordered) == (words.ABSOLUTE, False)
    cycles(control, (words.ABSOLUTE, -42), (words.ABSOLUTE, -42))
    assert found == [-42]


def test_what_stays_out_ages_the_second_encoder_too() -> None:
    bus = Bus(replace(SETTINGS, telegram=words.telegrams()[6], missing_cycles=3))
    ages = []
    for is_new in (True, False, False, True, False):
        bus.cycle(0.0, is_new=is_new, G2_XIST1=5)
        ages.append(bus.drive.second_age_cycles)
    assert ages == [0, 1, 2, 0, 1]


def test_a_sign_of_life_of_0_is_none() -> None:
    """The drive has not begun to count, or has stopped to: its telegram counts for nothing."""
    bus = Bus(replace(SETTINGS, missing_cycles=2))
    bus.cycle(0.0)
    alarms = []
    for _ in range(4):
        bus.life = 15  # the next one is 1; what is packed here is 0
        given = bus.values | {"ZSW2": 0}
        bus.drive.begin_cycle()
        bus.port.receive(bus._inputs.pack(*(given.get(name, 0) for name in bus._taken)))
        try:
            bus.drive.take()
            alarms.append(0)
        except Alarm as alarm:
            alarms.append(alarm.id)
    assert alarms == [0, 0, 900764, 900764]


@pytest.mark.parametrize("missing_max", [1, 3])
def test_telegrams_may_stay_out_again_and_again_if_not_too_often_in_a_row(missing_max: int) -> None:
    """Each one that comes begins the count anew."""
    bus = Bus(replace(SETTINGS, missing_cycles=missing_max))
    for _ in range(4):
        bus.cycle(0.0)
        for _ in range(missing_max):
            bus.cycle(0.0, is_new=False)
    with pytest.raises(Alarm) as silent:
        bus.cycle(0.0, is_new=False)
    assert (silent.value.id, silent.value.values["cycles"]) == (900764, missing_max + 1)
