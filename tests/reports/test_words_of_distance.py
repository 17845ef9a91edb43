"""What each part of a distance control did, in words, from signals of round numbers."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.reports.distances import MS, law, limit

from axisrig.bench.judge.distance.control_findings import (
    DEGREE,
    MM,
    ControlFindings,
    DeadCycles,
    DistanceStretch,
    EndError,
    UsedLimit,
)
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.oracles.distance.lists import Control
from axisrig.bench.oracles.distance.loop import CONST_DIST
from axisrig.reports.distance.section import _limit, sections
from axisrig.reports.distance.words import happened, law_words, state

ACTIVE, CONST = "ACTIVE", "ACTIVE_CONST_DIST"
LAW = law(Control(kp=0.2, count=4), CONST_DIST)


def part(begin_ms: int, end_ms: int, name: str, by: str = "NC", **more: Any) -> DistanceStretch:
    values = {"is_dry_run": False, "set_mm": None, "set_end_mm": None, "law": None, **more}
    return DistanceStretch(begin_ms * MS, end_ms * MS, name, by, **values)


def control(*stretches: DistanceStretch, unit: str = MM, **more: Any) -> ControlFindings:
    return ControlFindings("Z", unit, "gap", 0.0, 1.0, 0, stretches, (), DeadCycles(1), **more)


def signals(**columns: Sequence[float]) -> pa.Table:
    """A row each ms; names of columns are those of axis Z."""
    rows = len(next(iter(columns.values())))
    return pa.table(
        {"time_ns": np.arange(rows, dtype=np.int64) * MS}
        | {f"Z.{name}": np.array(values, np.float64) for name, values in columns.items()}
    )


def sentences(found: ControlFindings, trace: pa.Table | None = None) -> list[str]:
    return [words for _, words in happened(found, [], trace, {})]


# Who did what


@pytest.mark.parametrize(
    ("name", "by", "more", "words"),
    [
        (ACTIVE, "NC", {}, "ON by the program: followed"),
        (CONST, "PLC", {}, "ON_CONST_DIST by the PLC: followed"),
        (ACTIVE, "NC", {"set_mm": 40.0, "set_end_mm": 40.0},
         "ON by the program, SET_POS 40 mm: followed"),
        (CONST, "NC", {"set_mm": 2.0, "set_end_mm": 2.5},
         "ON_CONST_DIST by the program, SET_DIST 2 mm to 2.5 mm: followed"),
        (CONST, "NC", {"set_mm": 0.0, "set_end_mm": None},
         "ON_CONST_DIST by the program, SET_DIST 0 mm: followed"),
        (ACTIVE, "PLC", {"is_dry_run": True}, "ON by the PLC: DRYRUN, the offset stays"),
        ("FREEZE", "PLC", {}, "FREEZE by the PLC: the offset is held"),
        ("ERROR", "NC", {}, "ERROR: the offset is held"),
        ("TURNING_OFF", "NC", {}, "OFF by the program: the offset runs out, 30 ms"),
    ],
)  # fmt: skip
def test_who_commanded_what(name: str, by: str, more: dict[str, Any], words: str) -> None:
    assert sentences(control(part(10, 40, name, by, **more))) == [words]


def test_off_at_once_is_reported_and_off_by_running_out_is_not() -> None:
    """The first INACTIVE is no event; behind TURNING_OFF it comes by itself."""
    on, off, out = (
        part(10, 20, ACTIVE),
        part(20, 30, "INACTIVE", "PLC"),
        part(20, 25, "TURNING_OFF"),
    )
    assert sentences(control(part(0, 10, "INACTIVE"))) == []
    assert sentences(control(on, off))[1:] == ["off at once, by the PLC or an error: nothing moves"]
    assert len(sentences(control(on, out, replace(off, begin_ns=25 * MS)))) == 2
    at_once = sentences(control(part(10, 20, "FREEZE"), off))
    assert at_once[1:] == ["off at once, by the PLC or an error: nothing moves"]


@pytest.mark.parametrize(
    ("before", "after", "is_same"),
    [
        (part(10, 20, ACTIVE), part(20, 30, ACTIVE), True),
        (part(10, 20, CONST), part(20, 30, ACTIVE), False),
        (part(10, 20, "FREEZE"), part(20, 30, ACTIVE), False),
        (part(10, 20, ACTIVE, is_dry_run=True), part(20, 30, ACTIVE), False),
        (part(10, 20, ACTIVE), part(20, 30, ACTIVE, is_dry_run=True), False),
        (part(10, 20, ACTIVE, is_dry_run=True), part(20, 30, ACTIVE, is_dry_run=True), False),
    ],
)
def test_the_same_state_again_is_a_change_of_parameters(
    before: DistanceStretch, after: DistanceStretch, is_same: bool
) -> None:
    words = sentences(control(before, after))[1]
    assert words.startswith("parameters changed: followed") is is_same


def test_alarms_come_last_with_their_words_and_instants() -> None:
    found = control(part(10, 40, ACTIVE))
    events = [Event(25_500_000, "alarm", "ID 7"), Event(40 * MS, "alarm", "ID 8")]
    lines = happened(found, events, None, {"ID 7": "too far"})
    assert lines[0][0] == "10.0 ms"
    assert lines[1:] == [("25.5 ms", "ID 7: too far"), ("40.0 ms", "ID 8")]


# What the signals show; rows 10 to 39 are of the stretch


def around(inside: Sequence[float], before: float = 9.0, after: float = 7.0) -> list[float]:
    return [before] * 10 + list(inside) + [after] * 10


STEP = [0.0] * 2 + [1.0] * 28


def test_the_offset_is_that_of_the_stretch_alone() -> None:
    trace = signals(offset_mm=around(STEP), error_mm=around([0.01] * 30))
    (words,) = sentences(control(part(10, 40, CONST)), trace)
    assert words == (
        "ON_CONST_DIST by the program: offset 0 mm to 1 mm, within 5 % of it after 2 ms;"
        " error at the end 0.01 mm"
    )


@pytest.mark.parametrize(
    ("inside", "words"),
    [
        ([0.0] * 2 + [-1.0] * 28, "offset 0 mm to -1 mm, within 5 % of it after 2 ms"),
        ([0.0] + [0.96] * 9 + [1.0] * 20, "offset 0 mm to 1 mm, within 5 % of it after 1 ms"),
        ([0.0] + [0.94] * 9 + [1.0] * 20, "offset 0 mm to 1 mm, within 5 % of it after 10 ms"),
        ([0.0] + [1.06] * 9 + [1.0] * 20, "offset 0 mm to 1 mm, within 5 % of it after 10 ms"),
        ([0.0] + [1.2] * 9 + [1.0] * 20,
         "offset 0 mm to 1 mm, between 0 mm and 1.2 mm, within 5 % of it after 10 ms"),
        ([0.0, -0.3] + [1.0] * 28,
         "offset 0 mm to 1 mm, between -0.3 mm and 1 mm, within 5 % of it after 2 ms"),
        ([0.0] * 2 + [0.0201] * 28, "offset 0 mm to 0.0201 mm, within 5 % of it after 2 ms"),
        ([0.0] * 2 + [0.0199] * 28, "offset 0 mm to 0.0199 mm"),
        ([0.0] * 2 + [-0.0199] * 28, "offset 0 mm to -0.0199 mm"),
        ([0.0] * 30, "offset 0 mm to 0 mm"),
    ],
)  # fmt: skip
def test_a_way_of_20_um_and_more_settles_within_5_per_cent(inside: list[float], words: str) -> None:
    """Of the way, to either side; extremes are named beyond 10 % of it and 2 um."""
    found = sentences(control(part(10, 40, ACTIVE)), signals(offset_mm=around(inside)))
    assert found == [f"ON by the program: {words}"]


def test_over_a_surface_that_moves_nothing_settles() -> None:
    """The surface may move by a tenth of what the offset does."""
    for way_mm, settles in ((0.09, True), (0.11, False)):
        surface = np.linspace(40.0, 40.0 + way_mm, 30)
        trace = signals(offset_mm=around(STEP), sensor_mm=around([-2.0] * 30),
                        distance_cnc_mm=around([2.0] * 30), actual_mm=around([50.0] * 30),
                        surface_cnc_mm=around(list(surface), 0.0, 99.0))  # fmt: skip
        (words,) = sentences(control(part(10, 40, ACTIVE)), trace)
        assert ("within 5 %" in words) is settles


def test_a_loop_beyond_its_limit_swings_by_half_of_its_span() -> None:
    """Of the last 20 rows; below 2 um nothing has excited it."""
    unstable = replace(LAW, kp=1.0)
    swing = [5.0] * 10 + [0.3, -0.1] * 10
    trace = signals(offset_mm=around(STEP), error_mm=around(swing))
    assert sentences(control(part(10, 40, CONST, law=unstable)), trace) == [
        "ON_CONST_DIST by the program: offset 0 mm to 1 mm; the error swings by ±0.2 mm at the end"
    ]
    calm = signals(offset_mm=around(STEP), error_mm=around([0.5] * 28 + [0.5015, 0.5]))
    for trace in (calm, signals(offset_mm=around(STEP))):
        (words,) = sentences(control(part(10, 40, CONST, law=unstable)), trace)
        assert words.endswith("offset 0 mm to 1 mm; nothing has excited the loop so far")
    stable = sentences(control(part(10, 40, CONST, law=LAW)), trace)
    assert "within 5 % of it after 2 ms" in stable[0]


def test_the_error_at_the_end_is_a_mean_of_20_rows() -> None:
    error = [9.0] * 10 + [0.1, 0.3] * 10
    trace = signals(offset_mm=around([0.0] * 30), error_mm=around(error))
    assert sentences(control(part(10, 40, CONST)), trace)[0].endswith("; error at the end 0.2 mm")


def test_a_frozen_offset_is_reported_with_what_the_sensor_saw() -> None:
    found = control(part(10, 40, "FREEZE"))
    held = around([0.5] * 30)
    assert sentences(found, signals(offset_mm=held)) == [
        "FREEZE by the program: the offset is held at 0.5 mm, bit for bit"
    ]
    drift = list(np.linspace(0.5, 0.4, 30))
    assert sentences(found, signals(offset_mm=around(drift))) == [
        "FREEZE by the program: the offset is held at 0.5 mm and moves by 0.1 mm"
    ]
    for way_mm, words in ((0.0021, "; the sensor goes from -2 mm to -1.9979 mm"), (0.0019, "")):
        sensor = around(list(np.linspace(-2.0, -2.0 + way_mm, 30)))
        (sentence,) = sentences(found, signals(offset_mm=held, sensor_mm=sensor))
        held_words = "FREEZE by the program: the offset is held at 0.5 mm, bit for bit"
        assert sentence == held_words + words


def test_an_error_holds_where_the_offset_ended_and_off_begins_where_it_was() -> None:
    trace = signals(offset_mm=around(list(np.linspace(1.0, 2.0, 30)), before=0.7))
    assert sentences(control(part(10, 40, "ERROR")), trace) == ["ERROR: the offset is held at 2 mm"]
    assert sentences(control(part(10, 40, "TURNING_OFF", "PLC")), trace) == [
        "OFF by the PLC: 0.7 mm run out, 30 ms"
    ]
    first = sentences(control(part(0, 40, "TURNING_OFF")), trace)
    assert first == ["OFF by the program: the offset runs out, 40 ms"]


def test_values_that_are_missing_do_not_count() -> None:
    inside = [np.nan] * 5 + [0.5] * 25
    found = control(part(10, 40, "FREEZE"), unit=DEGREE)
    (sentence,) = sentences(found, signals(offset_mm=around(inside)))
    assert sentence.endswith("held at 0.5 °, bit for bit")


@pytest.mark.parametrize(
    ("value", "words"),
    [(1.0, "1"), (-0.00001, "0"), (0.00004, "0"), (0.00006, "0.0001"), (10.0, "10"),
     (-2.5, "-2.5"), (100.0, "100")],
)  # fmt: skip
def test_lengths_have_a_tenth_of_a_micrometre(value: float, words: str) -> None:
    trace = signals(offset_mm=around([value] * 30))
    assert sentences(control(part(10, 40, "ERROR")), trace) == [
        f"ERROR: the offset is held at {words} mm"
    ]


# Law and state


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"kp_limit": None}, "kp 0.2 has no limit of stability"),
        ({"kp_limit": None, "kp_limit_unknown": "a filter of its own"},
         "the limit of kp is not known, a filter of its own: axisrig tune distance measures"),
        ({"kp": 0.5, "kp_limit": 0.5, "growth": 1.25},
         "kp 0.5 is above the limit 0.5 for 1 dead cycle and mean of 4: the loop oscillates,"
         " growing by 25 % per cycle"),
        ({"growth": 0.5}, "stable, an error is down to 5 % in 4 cycles"),  # ln 0.05/ln 0.5 = 4.3
        ({"growth": 0.01}, "stable, an error is down to 5 % in 1 cycles"),
        ({"growth": 0.0}, ": stable"),
        ({"growth": 1.0}, ": stable"),
    ],
)  # fmt: skip
def test_a_law_in_words(changes: dict[str, Any], words: str) -> None:
    found = law_words(replace(LAW, **changes))
    assert found.startswith(words) if words.startswith(("kp", "the")) else found.endswith(words)


@pytest.mark.parametrize(
    ("stretches", "expected"),
    [
        ((), ("dry", "not on")),
        ((part(0, 9, "INACTIVE"),), ("dry", "not on")),
        ((part(0, 9, ACTIVE), part(9, 20, CONST)), ("follows", "keeps the distance")),
        ((part(0, 9, CONST), part(9, 20, ACTIVE)), ("follows", "follows the surface")),
        ((part(0, 9, CONST), part(9, 20, "FREEZE")), ("follows", "keeps the distance")),
        ((part(0, 9, ACTIVE, is_dry_run=True),), ("dry", "dry run")),
        ((part(0, 9, ACTIVE), part(9, 20, ACTIVE, is_dry_run=True)),
         ("follows", "follows the surface")),
        ((part(0, 9, CONST, law=replace(LAW, kp=1.0)), part(9, 20, ACTIVE)),
         ("unstable", "above the limit of stability")),
    ],
)  # fmt: skip
def test_what_became_of_a_control(stretches: Any, expected: tuple[str, str]) -> None:
    key, _, word = state(control(*stretches), [])
    assert (key, word) == expected


def section(found: ControlFindings, *events: Event) -> dict[str, Any]:
    (shown,) = sections(RunFindings(events=list(events), of_topics=[found]), None, "r", {})
    return shown


@pytest.mark.parametrize(
    ("at_ms", "kind", "is_warning", "ends"),
    [
        (50, "alarm", False, True),
        (98, "alarm", False, True),
        (100, "alarm", False, True),
        (101, "alarm", False, True),  # in the cycle after it fell off
        (102, "alarm", False, True),
        (103, "alarm", False, False),
        (8, "alarm", False, True),
        (7, "alarm", False, False),
        (50, "alarm", True, False),
        (50, "fault", False, False),
    ],
)
def test_an_alarm_ends_a_control_that_is_on(
    at_ms: int, kind: str, is_warning: bool, ends: bool
) -> None:
    """On from 10 to 100 ms, cycles of 1 ms."""
    found = control(part(0, 10, "INACTIVE"), part(10, 100, ACTIVE), part(100, 200, "INACTIVE"))
    shown = section(found, Event(at_ms * MS, kind, "ID 7", is_warning=is_warning))
    assert (shown["state"] == "ended") is ends
    assert ("ID 7" in [words for _, words in shown["happened"]]) is ends


@pytest.mark.parametrize("period_ms", [0.5, 1.0, 4.0])
@pytest.mark.parametrize(("cycles", "ends"), [(-2, True), (0, True), (2, True), (2.25, False)])
@pytest.mark.parametrize("end_ms", [20, 100])
def test_an_alarm_may_come_two_cycles_after_the_control_fell_off(
    period_ms: float, cycles: float, ends: bool, end_ms: int
) -> None:
    """On from 10 to 20 and from 90 to 100 ms; cycles of the channel, and each time that it ends."""
    on = [part(10, 20, ACTIVE), part(90, 100, "FREEZE")]
    found = replace(control(*on), period_ms=period_ms)
    at_ns = round((end_ms + cycles * period_ms) * MS)
    shown = section(found, Event(at_ns, "alarm", "ID 7"))
    assert (shown["state"] == "ended") is ends


@pytest.mark.parametrize("kp_limit", [0.5, None])
def test_the_numbers_of_a_law(kp_limit: float | None) -> None:
    row = replace(LAW, tn_s=0.02, tv_s=0.0, kp=0.2, kp_limit=kp_limit, filter="mean of 1",
                  delay_cycles=-1e-12, noise_gain=0.12345)  # fmt: skip
    found = replace(control(part(0, 9, ACTIVE)), laws=(row,), dead=DeadCycles(2, 2))
    shown = section(found)["laws"][0]
    names = ("filter", "delay", "noise", "kp", "tn", "tv", "predicted", "measured", "dead_off")
    assert [shown[name] for name in names] == [
        "none",
        "0",
        "0.123",
        "0.2",
        "0.02 s",
        "off",
        2,
        2,
        False,
    ]
    expected = ("0.500", "2.50") if kp_limit else ("none", "")
    assert (shown["limit"], shown["margin"]) == expected
    assert bool(shown["bar"]) is bool(kp_limit)
    off = section(replace(found, laws=(replace(row, tn_s=0.0, tv_s=0.5),)))["laws"][0]
    assert (off["tn"], off["tv"]) == ("off", "0.5 s")
    unknown = replace(row, kp_limit=None, kp_limit_unknown="x")
    assert section(replace(found, laws=(unknown,)))["laws"][0]["limit"] == "not known"


def test_an_error_beside_its_closed_form_in_thousandths() -> None:
    """-12 um where -10 um are expected, with 0.5 um; of an axis that turns 0.001 degrees."""
    error = EndError(1234 * MS, "SET_POS", 12.5, -0.012, 0.0005, -0.010, "")
    shown = section(control(part(0, 9, ACTIVE), unit=DEGREE, errors=(error,)))
    assert (shown["unit"], shown["small"]) == ("°", "m°")
    row = shown["errors"][0]
    names = ("begin", "speed", "measured", "spread", "expected", "apart")
    assert [row[name] for name in names] == ["1234", "12.500", "-12.00", "0.50", "-10.00", "-2.00"]


@pytest.mark.parametrize(
    ("key", "value", "used", "word"),
    [
        ("max_pos", 8.0, 7.9, ""),
        ("max_pos", 8.0, 8.0, "reached"),
        ("max_pos", 8.0, 8.0 + 7e-6, "reached"),
        ("max_pos", 8.0, 8.0 - 7e-6, "reached"),
        ("max_pos", 8.0, 8.0 + 9e-6, "outside"),
        ("max_pos", 8.0, 8.0 - 9e-6, ""),
        ("min_pos", -8.0, -7.9, ""),
        ("min_pos", -8.0, -8.0, "reached"),
        ("min_pos", -8.0, -8.0 - 7e-6, "reached"),
        ("min_pos", -8.0, -8.1, "outside"),
        ("max_pos", -8.0, -8.0 + 7e-6, "reached"),
        ("max_pos", 0.0, 0.0, "reached"),
        ("max_pos", 0.0, 1e-6, "outside"),
        ("max_pos", 8.0, None, ""),
    ],
)
def test_a_limit_is_reached_within_a_millionth_of_it(
    key: str, value: float, used: float | None, word: str
) -> None:
    row: UsedLimit = replace(limit(key, 419, value, "mm", 0.0), used=used)
    shown = _limit(row)
    assert (shown["word"], shown["off"]) == (word, word == "outside")
    assert bool(shown["bar"]) is (used is not None)
    assert ("v-fail" in shown["bar"]) is (word == "outside")
    assert shown["used"] == ("–" if used is None else f"{used:.6g}")


@pytest.mark.parametrize(
    ("key", "value", "used", "title"),
    [
        ("v_max", 123.456, 98.7654, "v_max: 98.7654 of 123.456 mm"),
        ("max_pos", 8.0, 7.98765, "max_pos: 7.98765 of 8 mm"),
        ("min_pos", -12.3456, -1.23456789, "min_pos: -1.23457 of -12.3456 mm"),
    ],
)
def test_the_bar_of_a_limit_has_both_of_its_numbers_as_the_row_has_them(
    key: str, value: float, used: float, title: str
) -> None:
    """Six digits, as its cells."""
    shown = _limit(replace(limit(key, 419, value, "mm", 0.0), used=used))
    assert title in shown["bar"]
    assert f"{key}: {shown['used']} of {shown['value']} mm" == title
