"""When PDOs go and when they count: transmission types, timers, remote requests, lengths."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]

# of RPDO1, the second one of RPDO2: byte 3 has its number
SHORT, LONG, LATE = "1082110100000000", "2082110200000000", "5082110100000000"
GONE = "0000000000000000"
RPDO = "0600000000000000"


def tpdo4(drive: Any, kind: int, *, remote: bool = False, inhibit: int = 0, event: int = 0) -> None:
    """TPDO4 carries the statusword."""
    cob_id = 0x483 if remote else 0x4000_0483
    for index, sub, value, size in (
        (0x1A03, 1, 0x60410010, 4),
        (0x1A03, 0, 1, 1),
        (0x1803, 2, kind, 1),
        (0x1803, 3, inhibit, 2),
        (0x1803, 5, event, 2),
        (0x1803, 1, cob_id, 4),
    ):
        assert drive.write(index, sub, value, size) == 0


def said(drive: Any, seconds_ms: float, can_id: int = 0x483) -> list[str]:
    begin = len(drive.heard)
    drive.run_ms(seconds_ms)
    return [data for known, data in drive.heard[begin:] if known == can_id]


def ask(drive: Any, can_id: int = 0x483) -> list[str]:
    return [data for known, data in drive.after(can_id, remote=True) if known == can_id]


@pytest.mark.parametrize("count", [1, 2, 7, 240])
def test_types_1_to_240(stranger: Make, count: int) -> None:
    drive = stranger()
    tpdo4(drive, count)
    drive.nmt(1)
    hits = [
        n for n in range(1, 2 * count + 1) if 0x483 in [known for known, _ in drive.after(0x80)]
    ]
    assert hits == [count, 2 * count]


def test_type_0_goes_with_a_sync_after_a_change(stranger: Make) -> None:
    drive = stranger()
    tpdo4(drive, 0)
    drive.nmt(1)
    assert said(drive, 10) == []
    sent = []
    for word in ("", "", "0600", "", "0700"):
        if word:
            drive.after(0x603, "2b406000" + word + "0000")
        sent.append([data for known, data in drive.after(0x80) if known == 0x483])
    assert sent == [["5002"], [], ["3102"], [], ["3302"]]


def test_event_timer_repeats_what_has_not_changed(stranger: Make) -> None:
    drive = stranger()
    tpdo4(drive, 255, event=20)
    begin = drive.bench.scheduler.now_ns
    drive.nmt(1)
    drive.run_ms(69)
    assert [int(t) for t in drive.times_ms(0x483, begin)] == [0, 20, 40, 60]
    drive.write(0x6040, 0, 6, 2)  # a change starts the time anew
    drive.run_ms(19)
    assert drive.frames(0x483) == ["5002"] * 4 + ["3102"]
    drive.run_ms(2)
    assert len(drive.frames(0x483)) == 6


def test_event_timer_waits_for_the_inhibit_time(stranger: Make) -> None:
    drive = stranger()
    tpdo4(drive, 255, event=5, inhibit=80)
    begin = drive.bench.scheduler.now_ns
    drive.nmt(1)
    drive.run_ms(30)
    assert [int(t) for t in drive.times_ms(0x483, begin)] == [0, 8, 16, 24]


# Remote requests


@pytest.mark.parametrize("kind", [0, 1, 252, 253, 254, 255])
def test_no_remote_request_where_bit_30_says_so(stranger: Make, kind: int) -> None:
    drive = stranger()
    tpdo4(drive, kind, remote=False)
    drive.nmt(1)
    drive.after(0x80)
    assert ask(drive) == []


def test_type_252_is_sampled_at_the_sync(stranger: Make) -> None:
    drive = stranger()
    tpdo4(drive, 252, remote=True)
    drive.nmt(1)
    assert [known for known, _ in drive.after(0x80)] == [0x183, 0x283]
    drive.write(0x6040, 0, 6, 2)
    assert ask(drive) == ["5002"]
    drive.after(0x80)
    assert ask(drive) == ["3102"]


def test_type_253_is_sampled_at_the_request(stranger: Make) -> None:
    drive = stranger()
    tpdo4(drive, 253, remote=True)
    drive.nmt(1)
    drive.after(0x80)
    drive.write(0x6040, 0, 6, 2)
    assert said(drive, 10) == []
    assert ask(drive) == ["3102"]


@pytest.mark.parametrize("kind", [0, 1, 252, 253, 254, 255])
def test_only_a_type_of_syncs_answers_with_the_sample_of_its_sync(
    stranger: Make, fake_axis: Any, kind: int
) -> None:
    """6064 of an axis at 0.1 m/s, 1048.576 units in 0.1 ms; 0 to 252 are sampled at the SYNC.

    CiA 301, transmission types: 252 RTR-only synchronous, 253 RTR-only, 254 and 255 by event.
    """
    axis = fake_axis(motion=lambda time_s: 0.1 * time_s)
    drive = stranger(axis=axis)
    tpdo4(drive, kind, remote=True)
    for sub, value, size in ((0, 0, 1), (1, 0x60640020, 4), (0, 1, 1)):
        drive.write(0x1803, 1, 0xC000_0483, 4)
        assert drive.write(0x1A03, sub, value, size) == 0
    drive.write(0x1803, 1, 0x483, 4)
    drive.nmt(1)

    def asked_ms() -> list[float]:
        """Instants of the positions that the node has sent since the last call."""
        found = [
            int.from_bytes(bytes.fromhex(d), "little") / 10_485.76 for d in drive.frames(0x483)
        ]
        drive.heard.clear()
        return found

    asked_ms()
    synced = []
    for _ in range(2):
        begin_ms = drive.bench.scheduler.now_ns / MS
        drive.after(0x80, wait_ms=3)
        at_sync = asked_ms()
        # 47 us of SYNC, none where requests alone ask for it
        assert at_sync == pytest.approx([begin_ms + 0.047] * (kind not in (252, 253)), abs=2e-3)
        sync_ms, begin_ms = begin_ms + 0.047, drive.bench.scheduler.now_ns / MS
        drive.after(0x483, remote=True)
        (answer_ms,) = asked_ms()
        synced.append(answer_ms == pytest.approx(sync_ms, abs=2e-3))
        assert synced[-1] or answer_ms == pytest.approx(begin_ms + 0.05, abs=0.02)
    assert synced == [kind <= 252] * 2


@pytest.mark.parametrize("kind", [1, 252, 253, 254])
def test_a_window_is_of_synchronous_pdos_alone(stranger: Make, kind: int) -> None:
    """Asked within the 1 ms of 1007, answered on a bus that others have until past its end.

    CiA 301, 1007: what is synchronous may be taken back then; 253 and 254 are not. Type 1 sends
    that of the SYNC itself in time, which wins against the request of the same identifier.
    """
    drive = stranger()
    tpdo4(drive, kind, remote=True)
    drive.write(0x1007, 0, 1000, 4)
    drive.nmt(1)
    drive.after(0x80)
    begin, begin_ns = len(drive.heard), drive.bench.scheduler.now_ns
    drive.send(0x80)
    drive.send(0x483, remote=True)
    for _ in range(12):
        drive.send(0x90, "0000000000000000")
    drive.run_ms(3)
    pairs = zip(drive.times_ns[begin:], drive.heard[begin:], strict=True)
    is_in_window = [at_ns - begin_ns <= MS for at_ns, (can_id, _) in pairs if can_id == 0x483]
    assert is_in_window == {1: [True], 252: [], 253: [False], 254: [False]}[kind]


@pytest.mark.parametrize("kind", [0, 1, 254])
def test_other_types_answer_too(stranger: Make, kind: int) -> None:
    drive = stranger()
    tpdo4(drive, kind, remote=True)
    assert ask(drive) == []  # pre-operational
    drive.nmt(1)
    assert ask(drive) == ["5002"]


def test_what_is_asked_for_again_while_an_answer_waits_is_answered_once(stranger: Make) -> None:
    """Inhibit time 8 ms from the start on: three requests in it give one message at its end."""
    drive = stranger()
    tpdo4(drive, 255, remote=True, inhibit=80)
    begin = drive.bench.scheduler.now_ns
    drive.nmt(1)
    for _ in range(3):
        assert ask(drive) == []
    drive.write(0x6040, 0, 6, 2)
    drive.run_ms(50)
    assert drive.frames(0x483) == ["5002", "3102"]
    assert [int(t) for t in drive.times_ms(0x483, begin)] == [0, 8]


@pytest.mark.parametrize("command", [128, 2, 129, 130])
def test_what_waits_for_its_inhibit_time_is_gone_with_operational(
    stranger: Make, command: int
) -> None:
    drive = stranger()
    tpdo4(drive, 255, inhibit=200)
    drive.nmt(1)
    drive.write(0x6040, 0, 6, 2)
    assert len(drive.frames(0x483)) == 1
    drive.nmt(command)
    drive.run_ms(50)
    assert len(drive.frames(0x483)) == 1


def test_an_event_timer_samples_when_it_sends(stranger: Make, fake_axis: Any) -> None:
    """6064 of an axis at 0.1 m/s, 10485.76 units in 1 ms, every 20 ms without any SYNC."""
    drive = stranger(axis=fake_axis(motion=lambda time_s: 0.1 * time_s))
    tpdo4(drive, 255, event=20)
    drive.write(0x1803, 1, 0xC000_0483, 4)
    for sub, value, size in ((0, 0, 1), (1, 0x60640020, 4), (0, 1, 1)):
        assert drive.write(0x1A03, sub, value, size) == 0
    drive.write(0x1803, 1, 0x4000_0483, 4)
    drive.nmt(1)
    drive.run_ms(65)
    places = [int.from_bytes(bytes.fromhex(data), "little") for data in drive.frames(0x483)]
    late_ms = [
        at - place / 10_485.76 for at, place in zip(drive.times_ms(0x483), places, strict=True)
    ]
    assert len(late_ms) == 4
    assert all(0.0 <= late < 0.2 for late in late_ms)  # its own way on the bus


# What comes in


@pytest.mark.parametrize("kind", [1, 255])
def test_an_rpdo_counts_once_whatever_is_written_after_it(stranger: Make, kind: int) -> None:
    """SDO writes the target after the SYNC that took the RPDO: later ones do not bring it back."""
    drive = stranger()
    drive.write(0x1400, 1, 0x8000_0203, 4)
    drive.write(0x1400, 2, kind, 1)
    drive.write(0x1400, 1, 0x203, 4)
    drive.nmt(1)
    drive.after(0x203, "0600110000000000")
    drive.after(0x80)
    assert drive.node.image.target_position == 0x11
    assert drive.write(0x607A, 0, 0x22, 4) == 0
    for _ in range(2):
        drive.after(0x80)
        assert drive.node.image.target_position == 0x22
    drive.after(0x203, "0600330000000000")
    drive.after(0x203, "0600440000000000")
    drive.after(0x80)
    assert drive.node.image.target_position == 0x44


@pytest.mark.parametrize(
    ("data", "emergency", "counts"),
    [("", SHORT, False), ("0600000000000", SHORT, False), (RPDO, "", True)],
)
def test_length_of_an_rpdo(stranger: Make, data: str, emergency: str, counts: bool) -> None:
    drive = stranger()
    drive.nmt(1)
    drive.after(0x203, data[: len(data) // 2 * 2])
    drive.after(0x80)
    assert drive.frames(0x083) == ([emergency] if emergency else [])
    assert (drive.node.state is State.READY_TO_SWITCH_ON) == counts


def test_longer_rpdo_counts_and_is_told(stranger: Make) -> None:
    drive = stranger()
    for index, sub, value, size in (
        (0x1601, 1, 0x60400010, 4),
        (0x1601, 0, 1, 1),
        (0x1401, 1, 0x303, 4),
    ):
        assert drive.write(index, sub, value, size) == 0
    drive.nmt(1)
    drive.after(0x303, "060000")
    assert drive.frames(0x083) == [LONG]
    assert drive.node.state is State.READY_TO_SWITCH_ON
    drive.after(0x303, "070000")
    assert drive.frames(0x083) == [LONG]
    drive.after(0x303, "0600")
    assert drive.frames(0x083) == [LONG, GONE]


def test_errors_of_two_rpdos_are_one_until_both_are_gone(stranger: Make) -> None:
    drive = stranger()
    for index, sub, value, size in (
        (0x1601, 1, 0x60400010, 4),
        (0x1601, 0, 1, 1),
        (0x1401, 1, 0x303, 4),
    ):
        assert drive.write(index, sub, value, size) == 0
    drive.nmt(1)
    for can_id, data in ((0x203, "00"), (0x303, "00"), (0x203, RPDO)):
        drive.after(can_id, data)
    assert drive.frames(0x083) == [SHORT]
    drive.after(0x303, "0600")
    assert drive.frames(0x083) == [SHORT, GONE]


def test_deadline_of_an_rpdo(stranger: Make) -> None:
    """Event timer 5 ms: watched from the first message on; late = 8250, and the drive stops."""
    drive = stranger()
    drive.write(0x1400, 5, 5, 2)
    drive.nmt(1)
    drive.run_ms(100)
    assert drive.frames(0x083) == []
    drive.enable()
    for _ in range(3):
        drive.send(0x203, "0f00000000000000")
        drive.run_ms(4.9)
    assert drive.frames(0x083) == []
    drive.run_ms(0.5)
    assert drive.frames(0x083) == [LATE]  # one message: the fault of the drive has the same code
    assert drive.read(0x603F) == 0x8250
    assert drive.node.state is not State.OPERATION_ENABLED
    drive.after(0x203, RPDO)
    drive.run_ms(500)
    assert drive.frames(0x083) == [LATE]  # the fault stands until it is reset
    drive.send(0x203, "8000000000000000")
    drive.after(0x80, wait_ms=0.5)
    drive.after(0x80)
    assert drive.frames(0x083) == [LATE, GONE]


def test_a_pdo_that_is_taken_out_takes_its_error_along(stranger: Make) -> None:
    drive = stranger()
    drive.nmt(1)
    drive.after(0x203, "00")
    drive.write(0x1400, 1, 0x8000_0203, 4)
    assert drive.frames(0x083) == [SHORT, GONE]


def test_what_comes_by_an_event_is_not_late_for_a_sync(stranger: Make) -> None:
    """Window 200 us, the bus is taken for 0.3 ms: TPDO1 and TPDO2 are withdrawn, TPDO4 is not."""
    drive = stranger()
    tpdo4(drive, 255, event=20)
    drive.write(0x1007, 0, 200, 4)
    drive.nmt(1)
    sent_ms = drive.times_ms(0x483)[-1]
    drive.run_ms(sent_ms + 19.8 - drive.bench.scheduler.now_ns / MS)
    begin = len(drive.heard)
    drive.send(0x80)
    for _ in range(3):
        drive.send(0x90, "0000000000000000")
    drive.run_ms(1)
    assert [can_id for can_id, _ in drive.heard[begin:]] == [0x483]
