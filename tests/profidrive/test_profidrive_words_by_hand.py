"""What a PROFIdrive drive gets in each state and request, and where its position counts no more."""

from dataclasses import replace
from typing import Any

import pytest
from tests.profidrive.test_profidrive_control import SETTINGS, Bus
from tests.profidrive.test_profidrive_parameters import Far

from axisrig.kernel.drives.frozen_encoder import STANDS_S
from axisrig.kernel.drives.position_watch import jump_alarm
from axisrig.kernel.drives.power import PowerOrder, PowerRequest
from axisrig.kernel.drives.profidrive.watch import ProfidriveWatch
from axisrig.kernel.profiles.profidrive import parameters, words

PER_MM = SETTINGS.increments_per_mm
READY, OPERATES, INHIBITED, FAULT = 0x0231, 0x0237, 0x0270, 0x0238
OFF, MOVING, HALTED, ACKNOWLEDGE = 0x047E, 0x047F, 0x043F, 0x04FE
LARGEST = (1 << 31) - 1


def bus_of(**settings: Any) -> Bus:
    made = Bus(replace(SETTINGS, **settings))
    made.drive.order(PowerOrder.SWITCH_ON)
    return made


@pytest.mark.parametrize(
    ("request_", "expected"),
    [
        # STW1 when it is ready, in operation, inhibited
        (PowerRequest.OFF, (OFF, OFF, OFF)), (PowerRequest.ON, (MOVING, MOVING, OFF)),
        (PowerRequest.KEEP, (OFF, MOVING, OFF)), (PowerRequest.RELEASE, (OFF, OFF, OFF)),
        (PowerRequest.STOP, (OFF, HALTED, OFF)),
    ],
)  # fmt: skip
@pytest.mark.parametrize("acknowledges", [False, True])
def test_control_word_1_follows_request_and_state(
    request_: PowerRequest, expected: tuple[int, int, int], acknowledges: bool
) -> None:
    for status, word in zip((READY, OPERATES, INHIBITED), expected, strict=True):
        bus = bus_of()
        bus.drive.request, bus.drive.acknowledges_faults = request_, acknowledges
        assert bus.cycle(0.0, ZSW1=status)["STW1"] == word
        assert bus.cycle(0.0, ZSW1=FAULT)["STW1"] == (ACKNOWLEDGE if acknowledges else OFF)


@pytest.mark.parametrize(("status", "word"), [(READY, OFF), (OPERATES, MOVING), (INHIBITED, OFF)])
def test_a_place_is_proved_before_the_drive_is_led_into_operation_and_not_in_it(
    status: int, word: int
) -> None:
    """KEEP, STOP and ON alike never take away the operation that the drive is in."""
    bus = bus_of(proves_places=True)
    assert not bus.drive.is_placed
    assert bus.cycle(0.0, ZSW1=status)["STW1"] == word


@pytest.mark.parametrize(
    ("status", "zsw", "code", "alarm_id"),
    [
        (OPERATES, 0, 5, None), (OPERATES, words.ENCODER_ERROR, 6, 900763),
        (OPERATES, words.ENCODER_ERROR, 0, 900763), (READY, 0, 0, 900027),
        (READY, words.ENCODER_ERROR, 0, 900763), (FAULT, words.ENCODER_ERROR, 6, 900005),
    ],
)  # fmt: skip
def test_what_is_wrong_with_the_encoder_comes_before_what_follows_from_it(
    status: int, zsw: int, code: int, alarm_id: int | None
) -> None:
    """Bit 15 of G1_ZSW says that there is an error, whatever its code is."""
    bus = bus_of()
    bus.cycle(0.0, ZSW1=OPERATES)
    bus.cycle(0.0, ZSW1=status, G1_ZSW=zsw, G1_XIST2=code)
    found = ProfidriveWatch(bus.drive).condition()
    assert (found and found.id) == alarm_id
    if alarm_id == 900763:
        assert found is not None
        assert found.values["code"] == code


@pytest.mark.parametrize("sign", [1, -1])
def test_deviation_and_speed_end_at_32_bits_in_both_directions(sign: int) -> None:
    """6000 mm are 2.5e9 increments."""
    bus = bus_of(feed_forward=1.0)
    bus.cycle(0.0)
    sent = bus.cycle(sign * 6000.0)
    assert (sent["XERR"], sent["NSOLL_B"]) == (sign * LARGEST, sign * LARGEST)


@pytest.mark.parametrize("feed_forward", [0.0, 0.5, 1.0])
def test_after_a_jump_the_loop_in_the_drive_gets_the_set_speed_alone(feed_forward: float) -> None:
    """No deviation, and all of the set speed whatever its share was: 10 mm/s and 0."""
    bus = bus_of(feed_forward=feed_forward, jump_mm=1.0)
    bus.cycle(0.0, G1_XIST1=0)
    sent = bus.cycle(0.01)
    assert (sent["XERR"], sent["NSOLL_B"]) == (4194, round(feed_forward * 10 * 393_216))
    for set_mm, speed in ((0.02, 10 * 393_216), (0.01, -10 * 393_216), (0.01, 0)):
        sent = bus.cycle(set_mm, G1_XIST1=round(5 * PER_MM))
        assert (sent["XERR"], sent["NSOLL_B"]) == (0, speed)
    assert jump_alarm(bus.drive) is not None
    bus.drive.close_loop()
    assert bus.cycle(5.5)["XERR"] == round(0.5 * PER_MM)


def test_an_encoder_that_counts_nothing_opens_the_loop_in_the_drive_too() -> None:
    """16.667 1/s times 1 mm are 16.7 mm/s, at which it would have counted."""
    bus = bus_of()
    cycles = round(STANDS_S / SETTINGS.period_s)
    deviations = [bus.cycle(1.0)["XERR"] for _ in range(cycles + 2)]
    assert deviations == [round(PER_MM)] * cycles + [0, 0]


def test_without_a_gain_the_drive_closes_no_loop_and_nothing_is_watched() -> None:
    bus = bus_of(gain=0, feed_forward=1.0)
    sent = [bus.cycle(1.0) for _ in range(200)]
    assert {each["XERR"] for each in sent[1:]} == {round(PER_MM)}
    assert bus.drive.frozen is None


@pytest.mark.parametrize(
    ("response", "data"),
    [
        ("01 01 00 01 41 01 7B 00", b"\x7b"),  # a byte, filled up to a word
        ("01 01 00 01 42 01 03 E8", b"\xe8\x03"), ("01 01 00 01 43 01 00 01 02 03", b"\3\2\1\0"),
    ],
)  # fmt: skip
def test_a_value_is_as_long_as_its_format_says(response: str, data: bytes) -> None:
    far = Far()
    far.channel.read(1230, 0, far.found.append)
    assert far.answer(response) == data


@pytest.mark.parametrize(
    ("data", "written"),
    [
        (b"\x7b", "41 01 7B 00"),  # filled up to a word
        (b"\x03\xe8", "42 01 03 E8"), (b"\0\1\2\3", "43 01 00 01 02 03"), (b"", ""),
    ],
)  # fmt: skip
def test_a_value_is_written_with_the_format_of_its_length(data: bytes, written: str) -> None:
    """FCT-C4: byte 0x41, word 0x42, double word 0x43; a request without a value reads."""
    kind = "02" if data else "01"
    request = parameters.Request(7, 1230, 2, data).pack()
    assert request == bytes.fromhex(f"07 {kind} 00 01  10 01 04CE 0002 {written}")
    answer = parameters.positive(request, data)
    assert answer == bytes.fromhex(f"07 {kind} 00 01 {written}")


@pytest.mark.parametrize(
    ("to_drive", "from_drive", "has_dsc", "has_second"),
    [
        (("STW1", "XERR", "KPC"), ("ZSW1", "G1_XIST1"), True, False),
        (("KPC", "XERR"), ("G2_XIST1",), True, True), (("STW1", "XERR"), ("G2_ZSW",), False, False),
        (("STW1", "KPC"), (), False, False), (("STW1", "NSOLL_B"), ("G2_XIST1",), False, True),
    ],
)  # fmt: skip
def test_dynamic_servo_control_takes_both_of_its_signals(
    to_drive: tuple[str, ...], from_drive: tuple[str, ...], has_dsc: bool, has_second: bool
) -> None:
    telegram = words.Telegram(99, to_drive, from_drive)
    assert (telegram.has_dsc, telegram.has_second) == (has_dsc, has_second)


@pytest.mark.parametrize(
    ("number", "has_dsc", "has_second"),
    [(3, False, False), (4, False, True), (5, True, False), (6, True, True)],
)
def test_standard_telegrams(number: int, has_dsc: bool, has_second: bool) -> None:
    """PROFIdrive 6.3.4: 5 and 6 have DSC, 4 and 6 two encoders."""
    telegram = words.telegrams()[number]
    assert (telegram.has_dsc, telegram.has_second) == (has_dsc, has_second)
