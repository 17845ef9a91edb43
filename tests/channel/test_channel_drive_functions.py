"""#DRIVE in a running channel: what reaches the drive, when, and what the program waits for."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

from axisrig.bench.bus.can.faults import Drop, FrameFault
from axisrig.kernel.drives.canopen.startup_steps import StartUpSettings
from axisrig.kernel.drives.functions import DriveFunction
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS, S

Make = Callable[..., Any]
SDO_REQUEST, SDO_ANSWER = 0x601, 0x581
TORQUE = DriveFunction(
    "TORQUE_LIMIT", "ACYCLIC", 0x6072, 0, 0x6072, 0, "UNS16", None, 10.0, -1e199, 1e199, None
)
WINDOW = DriveFunction(
    "MON_WINDOW", "ACYCLIC", 0x6065, 0, 0x6065, 0, "UNS32", None, 1.0, 0.0, 4294967295.0, None
)


def _bench(channel_bench: Make, words: Any, *functions: DriveFunction, torque: int = 65535) -> Any:
    """A channel with the functions; torque: 6072 of the drive at the start."""
    start_up = StartUpSettings(writes=[(0x6072, 0, torque)])
    declared = {f.key: f for f in functions or (TORQUE, WINDOW)}
    return channel_bench(words.axis("Z"), start_up=start_up, functions=declared)


def _write(
    words: Any, number: int, key: str, value: float, *, waits: bool = True
) -> canon.DriveWrite:
    return canon.DriveWrite(words.end(number).block, "Z", key, value, waits)


def _requests(bench: Any) -> list[tuple[int, bytes]]:
    """SDO requests behind the start-up."""
    start_ns = bench.channel.start_ns
    return [(t, d) for t, can_id, d in bench.frames if can_id == SDO_REQUEST and t > start_ns]


def test_the_printed_values_reach_the_drive(channel_bench: Make, words: Any) -> None:
    """FCT-C4 7.3.2: torque limit 10 with factor 10 is 100 per mille, the window is switched off."""
    bench = _bench(channel_bench, words)
    bench.run(
        [
            _write(words, 1, "TORQUE_LIMIT", 10),
            _write(words, 2, "MON_WINDOW", 4294967295),
            words.end(),
        ]
    )
    assert bench.alarm_ids == []
    frames = [data for _, data in _requests(bench)]
    # CiA 301: expedited download of 2 and of 4 bytes
    assert frames == [bytes.fromhex("2b72600064000000"), bytes.fromhex("23656000ffffffff")]
    assert bench.nodes["Z"].image.max_torque == 100
    assert bench.nodes["Z"].image.following_window == 0xFFFFFFFF


def test_a_value_acts_when_the_machining_has_got_there(channel_bench: Make, words: Any) -> None:
    """SYN: behind the move before it, not when it was decoded."""
    bench = _bench(channel_bench, words)
    bench.run([words.move(1, 3000.0, Z=5.0), _write(words, 2, "TORQUE_LIMIT", 50), words.end()])
    ((sent_ns, _),) = _requests(bench)
    (arrived_ns,) = [s.time_ns for s in bench.samples if s.set_mm == (5.0,)][:1]
    assert arrived_ns <= sent_ns <= arrived_ns + 3 * MS


def _gap_ns(bench: Any, words: Any, *, waits: bool) -> int:
    """From the request to the first set position of the move behind it."""
    bench.run(
        [
            _write(words, 1, "TORQUE_LIMIT", 50, waits=waits),
            words.move(2, 3000.0, Z=5.0),
            words.end(),
        ]
    )
    ((sent_ns, _),) = _requests(bench)
    return next(s.time_ns for s in bench.samples if s.set_mm[0] > 0) - sent_ns


@pytest.mark.long
def test_wait_holds_the_program_until_the_drive_has_taken_it(
    channel_bench: Make, words: Any
) -> None:
    """Without WAIT the move begins in the cycle of the write, with it in one after the answer."""
    assert abs(_gap_ns(_bench(channel_bench, words), words, waits=False)) < MS
    bench = _bench(channel_bench, words)
    assert _gap_ns(bench, words, waits=True) >= MS / 2
    answer_ns = max(t for t, can_id, _ in bench.frames if can_id == SDO_ANSWER)
    assert next(s.time_ns for s in bench.samples if s.set_mm[0] > 0) > answer_ns


def test_drive_wait_holds_until_all_writes_are_taken(channel_bench: Make, words: Any) -> None:
    bench = _bench(channel_bench, words)
    bench.run(
        [
            _write(words, 1, "TORQUE_LIMIT", 50, waits=False),
            _write(words, 2, "MON_WINDOW", 5000, waits=False),
            canon.DriveWait(words.end(3).block, "Z"),
            words.move(4, 3000.0, Z=5.0),
            words.end(),
        ]
    )
    answers = [t for t, can_id, _ in bench.frames if can_id == SDO_ANSWER]
    moved_ns = next(s.time_ns for s in bench.samples if s.set_mm[0] > 0)
    assert moved_ns > answers[-1]
    assert len(_requests(bench)) == 2


def test_the_program_ends_only_when_the_drive_has_taken_everything(
    channel_bench: Make, words: Any
) -> None:
    bench = _bench(channel_bench, words)
    bench.run([_write(words, 1, "TORQUE_LIMIT", 50, waits=False), words.end()])
    assert bench.nodes["Z"].image.max_torque == 500


def test_reading_gives_the_value_in_the_units_of_the_program(
    channel_bench: Make, words: Any
) -> None:
    bench = _bench(channel_bench, words, torque=250)
    bench.run([canon.DriveRead(words.end(1).block, "Z", "TORQUE_LIMIT"), words.end()])
    assert bench.channel.drive_value("Z", "torque_limit") == 25.0


def test_the_cycle_goes_on_while_a_drive_is_written(channel_bench: Make, words: Any) -> None:
    bench = _bench(channel_bench, words)
    bench.segment.add_fault(_late(bench))
    bench.run([_write(words, 1, "TORQUE_LIMIT", 50), words.end()])
    syncs = bench.sync_ns()
    assert max(b - a for a, b in pairwise(syncs)) < 1.2 * MS


def _late(bench: Any) -> Any:
    """Lose the first answer behind the start-up, so that the request is repeated."""
    lost = []

    def hook(frame: Any, _port: Any, _attempt: int) -> Any:
        if frame.arbitration_id == SDO_ANSWER and bench.channel.start_ns and not lost:
            lost.append(frame)
            return Drop()
        return None

    return hook


@pytest.mark.provokes(900032, 4, axis="Z", key="MODE")
def test_900032_when_the_drive_refuses(channel_bench: Make, words: Any) -> None:
    """6060 = 77 is no mode of any drive."""
    mode = replace(TORQUE, key="MODE", index=0x6060, data_type="SGN08", factor=1.0)
    bench = _bench(channel_bench, words, mode)
    bench.run([_write(words, 7, "MODE", 77), words.move(8, 3000.0, Z=5.0), words.end()])
    (alarm,) = bench.channel.alarms
    assert alarm.id == 900032
    assert alarm.values["object"] == "0x6060:0"
    assert str(alarm.values["answer"]).startswith("abort 0x0609003")
    assert "N70" in str(alarm)
    assert bench.final_mm("Z") == 0.0


def test_900032_when_the_drive_is_silent_and_the_program_does_not_hang(
    channel_bench: Make, words: Any
) -> None:
    bench = _bench(channel_bench, words)
    bench.prepare([_write(words, 1, "TORQUE_LIMIT", 50), words.end()])
    bench.scheduler.run_while(lambda: bench.channel.start_ns is None, S)
    bench.segment.add_fault(FrameFault(SDO_ANSWER))
    bench.finish()
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.values["answer"]) == (900032, "no answer")


@pytest.mark.parametrize(
    ("key", "value", "alarm_id"),
    [("POWER", 1, 900110), ("TORQUE_LIMIT", 2.5, 900111), ("TORQUE_LIMIT", 6554, 900112)],
)
@pytest.mark.provokes(900110, 2, axis="Z", key="POWER")
@pytest.mark.provokes(900111, 2, value=2.5)
@pytest.mark.provokes(900112, 2, value=65540, data_type="UNS16")
def test_what_cannot_be_written_ends_the_program(
    channel_bench: Make, words: Any, key: str, value: float, alarm_id: int
) -> None:
    bench = _bench(channel_bench, words)
    bench.run([_write(words, 7, key, value), words.end()])
    (alarm,) = bench.channel.alarms
    assert alarm.id == alarm_id
    assert "N70" in str(alarm)
    assert _requests(bench) == []


def test_a_mask_leaves_the_other_bits(channel_bench: Make, words: Any) -> None:
    masked = replace(TORQUE, mask=0x00F0, factor=1.0)
    bench = _bench(channel_bench, words, masked, torque=0x1234)
    bench.run([_write(words, 1, "TORQUE_LIMIT", 0xFFFF), words.end()])
    assert bench.nodes["Z"].image.max_torque == 0x12F4


def test_ignore_sends_nothing(channel_bench: Make, words: Any) -> None:
    bench = _bench(channel_bench, words, replace(TORQUE, communication="IGNORE"))
    bench.run([_write(words, 1, "TORQUE_LIMIT", 10), words.end()])
    assert bench.alarm_ids == []
    assert _requests(bench) == []
