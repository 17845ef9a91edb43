"""Metrics, marks and words of a whole program, and the topics that judge it, from facts alone."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.topic import Topic
from axisrig.bench.judge.program.findings import log_lines, program_events, program_notes
from axisrig.bench.judge.run_findings import of_facts
from axisrig.bench.judge.topics import TOPICS, judged, observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord, Deflection, DriveState, ProbeRecord
from axisrig.bench.record.bus import BusChange, BusFigures, RealTime, Spread
from axisrig.bench.record.facts import AlarmRecord, DriveWrite, Facts, Fault, Note, PlcNote
from axisrig.bench.record.series import SeriesWriter
from axisrig.kernel.time.clock import MS

ROWS = 20
TIMES = np.arange(ROWS, dtype=np.int64) * MS


def seen(observed: Observed, metric: str) -> Observation:
    condition = "none" if "alarms" in metric else "> -1e9"
    return observe(observed, parse_check(metric, condition, ""))


def alarm(alarm_id: int, at_ms: int, *, ends: bool = True, further: bool = False) -> AlarmRecord:
    return AlarmRecord(at_ms * MS, alarm_id, 4 if ends else 1, ends, f"text of {alarm_id}",
                       is_further=further)  # fmt: skip


def bus(segment: str, overload: str = "", changes: tuple[BusChange, ...] = ()) -> BusFigures:
    return BusFigures(segment, 1_000_000, 1.0, 1.0, 1.0, 0, 0, overload, (), (), changes)


def recorded(columns: dict[str, Any] | None = None, **changes: Any) -> Observed:
    axes = changes.pop("axes", {name: AxisRecord("can1", 1, 1000.0) for name in "XZ"})
    changes = {"end_ns": int(TIMES[-1]), "axes": axes, **changes}
    return Observed(facts(**changes), kept(pa.table({"time_ns": TIMES, **(columns or {})})))


def test_alarms_are_named_apart_from_those_of_the_stop() -> None:
    observed = recorded(
        alarms=(alarm(3, 1, ends=False), alarm(2, 5), alarm(9, 6, further=True), alarm(1, 7))
    )
    assert seen(observed, "alarms").value == [3, 2, 1]
    assert seen(observed, "further_alarms").value == [9]


def test_a_program_lasts_from_its_first_enabled_cycle() -> None:
    assert seen(recorded(start_ns=4 * MS), "duration_s").value == pytest.approx(0.015)
    never = recorded(start_ns=None)
    for metric in ("duration_s", "set_acceleration_mm_s2_max", "set_jerk_mm_s3_max"):
        found = seen(never, metric)
        assert (found.value, found.note) == (None, "the drives were never enabled")


def test_a_bus_without_frames_has_no_wait() -> None:
    found = seen(recorded(buses=(bus("a"),)), "queueing_us_max")
    assert (found.value, found.note) == (None, "nothing was sent")


@pytest.mark.parametrize("end_row", [9, 12, 19])
def test_a_lag_counts_up_to_the_end_of_the_program(end_row: int) -> None:
    """X lags by -0.02 mm a row, Z by 0.01: what comes after the end counts nowhere."""
    rows = np.arange(ROWS)
    columns = {"X.cnc_lag_mm": -0.02 * rows, "Z.cnc_lag_mm": 0.01 * rows}
    observed = recorded(columns, end_ns=int(TIMES[end_row]))
    found = [seen(observed, f"lag_mm_max{of}").value for of in ("", ":X", ":Z")]
    assert found == pytest.approx([0.02 * end_row, 0.02 * end_row, 0.01 * end_row])


def test_before_the_first_cycle_there_is_no_lag() -> None:
    nothing = {"Z.cnc_lag_mm": np.empty(0)}
    empty = Observed(facts(axes={"Z": AxisRecord("can1", 1, 1000.0)}),
                     kept(pa.table({"time_ns": TIMES[:0], **nothing})))  # fmt: skip
    found = seen(empty, "lag_mm_max")
    assert (found.value, found.note) == (None, "the program ended before its first cycle")


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_with_no_delay_cycle_the_lag_is_judged_before_the_set_position_is_made(
    sign: float,
) -> None:
    """0.1 mm a cycle, recorded 0.25 mm behind: judged are 0.15, of the first row the whole."""
    set_mm = sign * 0.1 * np.arange(ROWS)
    lag_mm = np.full(ROWS, sign * 0.25)
    lag_mm[0] = 0.0
    columns = {"Z.set_mm": set_mm, "Z.cnc_lag_mm": lag_mm}
    for delay, wanted in ((0, 0.15), (1, 0.25), (None, 0.25)):
        written = {} if delay is None else {"antr.nbr_delay_cycles": delay}
        observed = recorded(columns, axes={"Z": AxisRecord("can1", 1, 1000.0, written=written)})
        assert seen(observed, "lag_mm_max").value == pytest.approx(wanted)
    leading = {**columns, "Z.cnc_lag_mm": np.zeros(ROWS)}
    axes = {"Z": AxisRecord("can1", 1, 1000.0, written={"antr.nbr_delay_cycles": 0})}
    assert seen(recorded(leading, axes=axes), "lag_mm_max").value == 0.0


# Marks and words


def test_marks_of_a_program_have_their_kind_axis_and_words() -> None:
    states = ("SWITCHED_ON", "OPERATION_ENABLED", "QUICK_STOP_ACTIVE", "SWITCH_ON_DISABLED",
              "SWITCHED_ON", "OPERATION_ENABLED")  # fmt: skip
    changes = (BusChange(1 * MS, "Z", "BUS_OFF", False), BusChange(2 * MS, "Z", "ACTIVE", True),
               BusChange(3 * MS, "kernel", "PASSIVE", False))  # fmt: skip
    axes = {
        "X": AxisRecord("can1", 1, 1000.0, homed_ns=(8 * MS, 9 * MS)),
        "Z": AxisRecord("can1", 2, 1000.0, states=tuple(
            DriveState((10 + n) * MS, state, "STOP" in state) for n, state in enumerate(states)
        )),
    }  # fmt: skip
    observed = recorded(
        axes=axes,
        buses=(bus("can1", changes=changes),),
        alarms=(alarm(7, 4), alarm(8, 5, ends=False), alarm(9, 6, further=True),
                alarm(10, 7, ends=False, further=True)),
        faults=(Fault("Z", "whole", ((14 * MS, "wire cut"), (15 * MS, "wire back"))),
                Fault("", "whole", ((16 * MS, "all"),))),
        drive_writes=(DriveWrite(17 * MS, "X", "torque limit 50 %"),),
    )  # fmt: skip
    found = [
        (e.time_ns // MS, e.kind, e.label, e.axis, e.is_warning) for e in program_events(observed)
    ]
    assert found == [
        (1, "fault", "can1: Z BUS_OFF", "Z", False),
        (2, "mark", "can1: Z ACTIVE", "Z", False),
        (3, "fault", "can1: kernel PASSIVE", None, False),
        (4, "alarm", "ID 7", None, False),
        (5, "alarm", "ID 8 (warning)", None, True),
        (6, "alarm", "besides: ID 9", None, False),
        (7, "alarm", "besides: ID 10", None, False),
        (8, "mark", "X: homed", "X", False),
        (9, "mark", "X: homed", "X", False),
        (14, "fault", "wire cut", "Z", False),
        (15, "fault", "wire back", "Z", False),
        (16, "fault", "all", None, False),
        (12, "fault", "Z: quick stop active", "Z", False),
        (13, "mark", "Z: switch on disabled", "Z", False),
        (14, "mark", "Z: switched on", "Z", False),
        (15, "mark", "Z: operation enabled", "Z", False),
        (17, "mark", "torque limit 50 %", "X", False),
    ]


def _talkative(**changes: Any) -> Facts:
    sources = ("plc", "printed", "plant", "lacking", "latch", "distance", "rig")
    return facts(
        notes=tuple(Note(source, f"{source} {n}") for n in (1, 2) for source in sources),  # type: ignore[arg-type]
        buses=(bus("a"), bus("b", "SYNC does not fit")),
        probes={
            "probe": ProbeRecord(True, 1.0, deflections=(
                Deflection(0.1, 0.0), Deflection(2.0, 0.1, MS, "probe: 2 mm of 1 mm"),
            )),
        },
        alarms=(alarm(9, 6, further=True), alarm(7, 4, ends=False), alarm(8, 5)),
        faults=(Fault("Z", "wire cut for 2 ms"),),
        plc=(PlcNote(1_500 * MS, "latch asked", "probe.py:3"),),
        **changes,
    )  # fmt: skip


def test_a_log_has_its_order() -> None:
    assert log_lines(_talkative()) == [
        "segment b is overloaded: SYNC does not fit",
        *(
            f"{source} {n}"
            for source in ("rig", "distance", "latch", "lacking", "plant")
            for n in (1, 2)
        ),
        "probe: 2 mm of 1 mm",
        *("printed 1", "printed 2"),
        *("text of 7", "text of 8", "besides: text of 9", "wire cut for 2 ms", "plc 1", "plc 2"),
    ]


def test_of_one_program_the_alarms_come_last_and_say_whether_they_ended_it() -> None:
    found = [*program_notes(_talkative())]
    assert found == [
        *((f"{source} {n}", False) for source in ("rig", "distance", "latch") for n in (1, 2)),
        ("segment b is overloaded: SYNC does not fit", False),
        *(("plant 1", False), ("plant 2", False)),
        ("probe: 2 mm of 1 mm", False),
        *(("printed 1", False), ("printed 2", False)),
        ("1.500 s: latch asked (probe.py:3)", False),
        *(("plc 1", False), ("plc 2", False)),
        *(("text of 7", False), ("text of 8", True), ("besides: text of 9", True)),
    ]


def test_real_time_is_in_the_words_where_there_is_any() -> None:
    late = Spread(1.0, 20.0, 80.0, 150.0)
    real = RealTime(1000.0, 100.0, 500, 3, late, None, (), (), 0, 0.0, 0, 0.0, 0)
    for words in (log_lines, lambda left: [text for text, _ in program_notes(left)]):
        plain, timed = words(facts()), words(facts(real_time=real))
        assert plain == []
        assert len(timed) == 1
        assert "500 SYNCs, 3 of them more than 100 us late" in timed[0]


# Lag of the drive and speed


PLACE_MM, SPEED_MM_S = np.arange(ROWS) / 128, np.full(ROWS, 1000 / 128)


def driven(peaks_mm: Any, actual_mm: Any = PLACE_MM, **changes: Any) -> Observed:
    columns = {
        "Z.drive_lag_peak_mm": peaks_mm, "Z.actual_mm": actual_mm, "Z.truth_mm": PLACE_MM,
        "Z.velocity_mm_s": SPEED_MM_S, "X.drive_lag_peak_mm": np.full(ROWS, 0.01),
        "X.actual_mm": PLACE_MM, "X.truth_mm": -2 * PLACE_MM, "X.velocity_mm_s": -2 * SPEED_MM_S,
    }  # fmt: skip
    return recorded(columns, **changes)


def peaks(*values: tuple[int, float]) -> Any:
    found = np.full(ROWS, 0.1)
    for row, value in values:
        found[row] = value
    return found


def test_the_lag_of_a_drive_is_its_largest_until_the_end() -> None:
    observed = driven(peaks((10, 0.5), (15, 0.9)), end_ns=12 * MS)
    for of, wanted in (("", 0.5), (":Z", 0.5), (":X", 0.01)):
        found = seen(observed, f"drive_lag_mm_max{of}")
        assert (found.value, found.uncertainty, found.note) == (wanted, 0.0, "")


@pytest.mark.parametrize(
    ("row", "weight"),
    [(3, 0), (5, 0), (6, 1), (7, 4), (8, 6), (9, 6), (10, 6), (11, 6), (12, 4), (13, 1), (14, 0)],
)
def test_what_the_encoder_does_around_a_step_puts_its_lag_in_doubt(row: int, weight: int) -> None:
    """1/16 of the fourth difference, of five rows: one that is off by e makes 1, 4 or 6 e of it.

    The step into row 10 is in the four differences that have rows 9 and 10 in them: those that
    begin in rows 6 to 9. Each is of positions in whole increments, 1 um: sqrt(1 + 16 + 36 + 16 + 1)
    times the 1/sqrt(12) of one.
    """
    actual = PLACE_MM.copy()
    actual[row] += 0.016
    found = seen(driven(peaks((10, 0.5)), actual), "drive_lag_mm_max:Z")
    assert found.value == 0.5
    rounding = 0.001 * (70 / 12) ** 0.5 / 16 if weight else 0.0
    assert found.uncertainty == pytest.approx(0.001 * weight + rounding, abs=1e-12)


def test_a_smaller_lag_in_more_doubt_may_be_the_largest() -> None:
    """0.49 mm known to 0.06 and 1/16 of 2.415 increments of 1 um: up to 0.55."""
    actual = PLACE_MM.copy()
    actual[15] += 0.16
    found = seen(driven(peaks((5, 0.5), (15, 0.49)), actual), "drive_lag_mm_max:Z")
    assert found.value == 0.5
    assert found.uncertainty == pytest.approx(0.05 + 0.002415 / 16, abs=1e-6)
    assert found.note == "what a cubic between two SYNCs does not see"


def test_the_largest_speed_is_that_of_either_direction() -> None:
    for of, wanted in (("", 15.625), (":X", 15.625), (":Z", 7.8125)):
        assert seen(driven(peaks()), f"velocity_mm_s_max{of}").value == pytest.approx(wanted)


def test_each_drive_has_marks_from_its_own_start_on() -> None:
    """X, Y and Z start one after the other; Z never gets on; only what came later is a mark."""
    start = ("SWITCH_ON_DISABLED", "READY_TO_SWITCH_ON", "SWITCHED_ON", "OPERATION_ENABLED")
    after = {"X": ("SWITCHED_ON", "OPERATION_ENABLED"), "Y": ("FAULT",), "Z": ()}
    gone = {"X": start + after["X"], "Y": start + after["Y"], "Z": start[:3]}
    axes = {
        axis: AxisRecord("can1", 1, 1000.0, states=tuple(
            DriveState((100 * n + row) * MS, state, state == "FAULT")
            for row, state in enumerate(states)
        ))
        for n, (axis, states) in enumerate(gone.items())
    }  # fmt: skip
    wanted = [
        (4, "mark", "X: switched on", "X"),
        (5, "mark", "X: operation enabled", "X"),
        (104, "fault", "Y: fault", "Y"),
    ]
    for names in ("XYZ", "ZYX", "YZX"):
        observed = recorded(axes={axis: axes[axis] for axis in names})
        found = [(e.time_ns // MS, e.kind, e.label, e.axis) for e in program_events(observed)]
        assert sorted(found) == wanted


def test_checks_are_judged_by_the_topics_that_are_given() -> None:
    """One topic in the place of all: its metric has another value, and no mark is another's."""
    mine = Topic("mine", {"duration_s": lambda _o, _a: Observation(42.0, 0.5)}, lambda _: [])
    observed = recorded(start_ns=0)
    check = parse_check("duration_s", "40 .. 44", "")
    for topics, value, verdict in (
        ((mine,), 42.0, Verdict.PASS), ((mine, *TOPICS), 42.0, Verdict.PASS),
        (TOPICS, 0.019, Verdict.FAIL),
    ):  # fmt: skip
        found, (result,) = judged(observed, [check], topics)
        assert (found, result.value) == (verdict, pytest.approx(value))


def test_all_alarms_of_a_run_are_among_its_findings() -> None:
    given = (alarm(3, 1, ends=False), alarm(2, 5), alarm(9, 6, further=True))
    assert list(of_facts(recorded(alarms=given).facts).alarms) == list(given)


@pytest.mark.parametrize("start_row", [0, 3, 8])
@pytest.mark.parametrize("metric", ["set_acceleration_mm_s2_max:Z", "set_jerk_mm_s3_max:Z"])
def test_what_the_set_positions_did_before_the_drives_were_on_counts_nowhere(
    metric: str, start_row: int
) -> None:
    """A step of 1 mm at row 4, taken over before the drives are enabled; 0.01 mm at row 14."""
    k = np.arange(ROWS)
    set_mm = np.where(k >= 4, 1.0, 0.0) + np.where(k >= 14, 0.01, 0.0)
    found = seen(recorded({"Z.set_mm": set_mm}, start_ns=start_row * MS), metric)
    step_mm = 1.0 if start_row <= 4 else 0.01
    order = 2 if "acceleration" in metric else 3
    factor = 1.0 if order == 2 else 2.0  # third differences of a step: 1, -2, 1
    assert found.value == pytest.approx(factor * step_mm * 1e3**order)


@pytest.mark.parametrize("row", [5, 9, 10, 11, 13])
@pytest.mark.parametrize("size", [1, 9, 10, 11, 12])
def test_the_doubt_of_a_lag_is_the_same_wherever_a_block_ends(
    row: int, size: int, tmp_path: Path
) -> None:
    """An encoder that is off around the largest lag, in row 10."""
    actual = PLACE_MM.copy()
    actual[row] += 0.016
    whole = driven(peaks((10, 0.5)), actual)
    table, writer = whole.series.table(), SeriesWriter(tmp_path / "a.parquet")
    for part in (table.slice(0, size), table.slice(size)):
        writer.add({name: part[name].combine_chunks() for name in part.column_names})
    parts = Observed(whole.facts, writer.close())
    one, other = (seen(each, "drive_lag_mm_max:Z") for each in (whole, parts))
    assert (other.value, other.note) == (one.value, one.note)
    assert other.uncertainty == pytest.approx(one.uncertainty)
