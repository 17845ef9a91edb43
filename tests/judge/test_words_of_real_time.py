"""What log and notes of a program say of real time: each number in its own sentence."""

from dataclasses import replace

import pytest
from tests.recordings import facts

from axisrig.bench.judge.program.findings import log_lines, program_notes
from axisrig.bench.record.bus import RealTime, Spread
from axisrig.bench.record.facts import AlarmRecord, Fault, Note, PlcNote
from axisrig.kernel.time.clock import MS

KEPT = RealTime(
    period_us=1250.0,
    late_us=250.0,
    cycles=400,
    late_cycles=3,
    lateness_us=Spread(0.25, 12.4, 310.0, 1234.0),
    interval_us=None,
    bins_us=(),
    histogram=(),
    slips=0,
    slipped_ms=0.0,
    waits=0,
    waited_ms=0.0,
    send_errors=0,
)
SYNCS = (
    "real time: 400 SYNCs, 3 of them more than 250 us late; lateness median 12 us, p99 310 us,"
    " max 1234 us"
)
INTERVAL = "real time: SYNC interval 640 .. 9876 us, median 1251 us for 1250 us"
SLIPS = "real time: the plan moved 3 times, by 7.250 ms in all, because this computer came too late"
WAITS = "real time: 5 cycles waited for the answers of the drives, 0.125 ms in all"
REFUSED = "real time: the interface did not take 9 frames"
OF_INTERVAL = {"interval_us": Spread(640.0, 1251.0, 1400.0, 9876.0)}


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        ({}, []),
        (OF_INTERVAL, [INTERVAL]),
        ({"slips": 3, "slipped_ms": 7.25}, [SLIPS]),
        ({"waits": 5, "waited_ms": 0.125}, [WAITS]),
        ({"send_errors": 9}, [REFUSED]),
        (
            {
                **OF_INTERVAL,
                **{"slips": 3, "slipped_ms": 7.25, "waits": 5, "waited_ms": 0.125},
                "send_errors": 9,
            },
            [INTERVAL, SLIPS, WAITS, REFUSED],
        ),
    ],
)
def test_each_figure_of_real_time_has_its_sentence(
    changes: dict[str, object], lines: list[str]
) -> None:
    left = facts(real_time=replace(KEPT, **changes))  # type: ignore[arg-type]
    assert log_lines(left) == [SYNCS, *lines]
    assert [*program_notes(left)] == [(line, False) for line in [SYNCS, *lines]]


@pytest.mark.parametrize("kept", [None, replace(KEPT, cycles=0, lateness_us=None, send_errors=9)])
def test_without_a_cycle_in_real_time_there_is_no_sentence(kept: RealTime | None) -> None:
    left = facts(real_time=kept)
    assert log_lines(left) == []
    assert [*program_notes(left)] == []


def test_real_time_comes_last_in_the_log_and_before_the_plc_in_the_notes() -> None:
    left = facts(
        real_time=KEPT,
        notes=(Note("plc", "of the PLC"), Note("printed", "of the program")),
        faults=(Fault("Z", "wire cut"),),
        alarms=(AlarmRecord(2 * MS, 7, 4, True, "text of 7"),),
        plc=(PlcNote(2_345_600_000, "moved", "line 3"), PlcNote(4_000_000_000, "ended", "line 4")),
    )
    assert log_lines(left) == ["of the program", "text of 7", "wire cut", "of the PLC", SYNCS]
    assert [text for text, _ in program_notes(left)] == [
        "of the program",
        SYNCS,
        *("2.346 s: moved (line 3)", "4.000 s: ended (line 4)", "of the PLC"),
        "text of 7",
    ]


@pytest.mark.parametrize("is_further", [False, True])
def test_a_note_of_an_alarm_says_whether_that_alarm_ended_the_program(is_further: bool) -> None:
    alarms = tuple(
        AlarmRecord(number * MS, number, 4, ends, f"text {number}", is_further=is_further)
        for number, ends in ((3, False), (1, True), (2, False))
    )
    besides = "besides: " if is_further else ""
    assert [*program_notes(facts(alarms=alarms))] == [
        (f"{besides}text 3", False),
        (f"{besides}text 1", True),
        (f"{besides}text 2", False),
    ]
