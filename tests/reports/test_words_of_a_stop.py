"""A run to a fixed stop in words: criteria, forces, what was missing, what became of it."""

from dataclasses import replace
from typing import Any

import pyarrow as pa
import pytest
from tests.reports.short_stops import LIMITS, at, during, fields_of, stop, trace
from tests.reports.stops import MS

from axisrig.bench.judge.fixed_stop.stop_findings import (
    BrokenContact,
    Decision,
    StopFindings,
    StopLimits,
)
from axisrig.bench.judge.fixed_stop.values import Value
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.reports.fixed_stop.section import sections
from axisrig.reports.fixed_stop.signals import Stop, with_changes
from axisrig.reports.fixed_stop.words import answers, length, state


def answers_of(found: Stop, table: pa.Table | None = None) -> dict[str, str]:
    return dict(answers(found, [], table))


@pytest.mark.parametrize(
    ("beyond_ms", "still_ms", "last"),
    [(120, 139, "lag"), (120, 141, "window"), (120, 140, "window")],
)
def test_the_criterion_that_came_last_is_reported(beyond_ms: int, still_ms: int, last: str) -> None:
    """The lag has to last for 20 ms more, the window has lasted."""
    found = stop(at("beyond", beyond_ms, "Z"), at("window", still_ms, "Z"))
    assert answers_of(found)["why here"] == (
        f"Z: lag above 1 mm for 20 ms and moved no more than 10 µm in 20 ms; the {last} came last"
    )
    alone = stop(at("beyond", beyond_ms, "Z2"), at("window", still_ms, "Z"))
    assert "came last" not in answers_of(alone)["why here"]


def test_the_way_in_degrees_and_force_in_newton_metres_of_an_axis_that_turns() -> None:
    rows = [Value("stop_force_max", "", "N.m", "C", -5.0, None, None, None, ""),
            Value("stop_force_end", "", "N.m", "C", None, None, None, None, "")]  # fmt: skip
    found = stop(
        watched=["C"], decided_by=Decision("C", "lag"), rotary={"C": True}, values=rows,
        limits={"C": StopLimits(0.02, None, 20.0, None)}, signals={"C": {"stop_force_n": "C.t"}},
    )  # fmt: skip
    answer = answers_of(found, trace(C__t=during(3.25, 0, 250)))
    assert answer["why here"] == "C: lag above 0.02° for 20 ms"
    assert answer["pressed with"] == "at most -5 N.m, 3.25 N.m at the end"


@pytest.mark.parametrize(
    ("forces", "words"),
    [
        ({"Z": 0.0, "Z2": 0.0}, "nothing: no force at the stop"),
        ({"Z": 5.0, "Z2": 0.0}, "Z: at most 5 N, 5 N at the end; Z2: nothing"),
        (
            {"Z": 5.0, "Z2": -7.0},
            "Z: at most 5 N, 5 N at the end; Z2: at most 7 N, -7 N at the end",
        ),
        ({"Z": 5.0}, "Z: at most 5 N, 5 N at the end"),
        ({}, "not known: no plant gives the force"),
    ],
)
def test_what_each_axis_pressed_with(forces: dict[str, float], words: str) -> None:
    """From the trace where the bench gives no values."""
    table = trace(**{f"{axis}__stop_force_n": [force] * 300 for axis, force in forces.items()})
    signals = {axis: {"stop_force_n": f"{axis}.stop_force_n"} for axis in forces}
    assert answers_of(stop(signals=signals), table)["pressed with"] == words


@pytest.mark.parametrize(
    ("is_found", "marks", "broken", "trouble", "expected"),
    [
        (True, (at("contact", 150, "Z"),), {}, 0, "found"),
        (True, (), {}, 1, "false"),
        (True, (at("contact", 150, "Z"),), {"Z": BrokenContact(0, None, 9)}, 0, "false"),
        (True, (at("contact", 150, "Z"),), {"Z": BrokenContact(0, 160 * MS, 9)}, 0, "found"),
        (True, (at("contact", 150, "Z"),), {"Z2": BrokenContact(0, None, 9)}, 0, "found"),
        (False, (at("contact", 150, "Z"),), {}, 0, "missed"),
        (False, (), {}, 1, "ended"),
    ],
)
def test_what_became_of_a_run(
    is_found: bool, marks: Any, broken: Any, trouble: int, expected: str
) -> None:
    found = stop(*marks, is_found=is_found, broken_contacts=broken)
    assert state(found, [at("alarm", 160)] * trouble) == expected


def test_a_plant_without_a_contact_makes_no_trigger_false() -> None:
    assert state(stop(signals={"Z": {"cnc_lag_mm": "Z.cnc_lag_mm"}}), []) == "found"


@pytest.mark.parametrize(
    ("mm", "words"),
    [(0.0999, "99.9 µm"), (0.1, "0.1 mm"), (-0.05, "50 µm"), (0.0, "0 µm"), (-2.5, "2.5 mm"),
     (0.0123456, "12.346 µm"), (0.03, "30 µm")],
)  # fmt: skip
def test_lengths_below_a_tenth_are_in_micrometres(mm: float, words: str) -> None:
    assert length(mm) == words


def test_what_was_missing_of_each_axis() -> None:
    """Below the limit there is no time; without signals the limits alone; both off is named."""
    found = stop(at("armed", 101), is_found=False, decided_by=None)
    lag = trace(Z__cnc_lag_mm=during(1.5, 120, 130), Z2__cnc_lag_mm=during(0.5, 120, 130))
    assert answers_of(found, lag)["what was missing"] == (
        "Z: largest lag 1.5 mm of 1 mm, above it for 10 of 20 ms, window 10 µm;"
        " Z2: largest lag 0.5 mm of 1 mm, window 10 µm"
    )
    assert answers_of(found)["what was missing"].startswith("Z: lag limit 1 mm, window 10 µm; Z2:")
    off = replace(found, watched=["Z"], limits={"Z": StopLimits(None, None, 20.0, None)})
    assert answers_of(off)["what was missing"] == "Z: both criteria are off"
    never = replace(found, marks=(), limits={"Z": LIMITS, "Z2": replace(LIMITS, arming_mm=0.05)})
    assert answers_of(never)["what was missing"] == (
        "the criteria are armed after 50 µm or 0.5 mm of the path only"
    )


@pytest.mark.parametrize(
    ("event", "is_shown"),
    [
        (Event(99 * MS, "alarm", "A"), False),
        (Event(100 * MS, "alarm", "A"), True),
        (Event(150 * MS, "alarm", "A", is_warning=True), False),
        (Event(150 * MS, "fault", "A"), True),
        (Event(150 * MS, "edge", "A"), False),
        (Event(290 * MS, "alarm", "A"), False),
    ],
)
def test_trouble_is_of_the_run(event: Event, is_shown: bool) -> None:
    fields = fields_of(stop(is_found=False))
    (shown,) = sections(
        RunFindings(events=[event], of_topics=[StopFindings(**fields)]), None, "r", {"A": "why"}
    )
    assert (("ended by", "A: why") in shown["answers"]) is is_shown
    assert (shown["state"] == "ended") is is_shown


@pytest.mark.parametrize(
    ("measured_ms", "words"),
    [
        (None, "not known: no plant gives a contact"),
        (150, "yes: in contact for 10.0 ms when detected"),
    ],
)
def test_a_contact_that_is_expected_and_not_measured_is_none(
    measured_ms: float | None, words: str
) -> None:
    """The closed form has an instant of it; no signal of a force says that a plant gives one."""
    mark = at("contact", measured_ms, "Z", oracle_ns=150 * MS)
    found = stop(mark, at("detected", 160), signals={"Z": {"cnc_lag_mm": "Z.cnc_lag_mm"}})
    assert state(found, []) == "found"
    assert answers_of(found)["real stop"] == words


def test_how_far_an_axis_moved_is_in_its_own_unit() -> None:
    """1 um each ms are 20 um in 20 ms; of a rotary axis 1 mdeg each ms is 0.02 degrees."""
    limits = {"Z": StopLimits(None, 0.01, 20.0, None)}
    found = stop(
        at("armed", 101), is_found=False, decided_by=None, watched=["Z"], limits=limits,
        signals={"Z": {"set_mm": "Z.set_mm"}},
    )  # fmt: skip
    way = [0.001 * row for row in range(300)]
    table = with_changes(trace(Z__set_mm=way, Z__actual_mm=way), [found])
    missing = answers_of(found, table)["what was missing"]
    assert missing == "Z: moved 20 µm or more in 20 ms, window 10 µm"


@pytest.mark.parametrize(
    ("decided", "touched", "words"),
    [("Z", "Z", "yes: in contact"), ("Z2", "Z2", "yes: in contact"),
     ("Z", "Z2", "yes: Z2 in contact"), ("Z2", "Z", "yes: Z in contact")],
)  # fmt: skip
def test_the_axis_in_contact_is_named_where_another_one_decided(
    decided: str, touched: str, words: str
) -> None:
    """Whichever of the two is the main axis."""
    found = stop(
        at("contact", 150, touched), at("detected", 180), decided_by=Decision(decided, "lag")
    )
    assert answers_of(found)["real stop"] == f"{words} for 30.0 ms when detected"


def test_what_is_left_after_relaxing_is_that_of_the_end_of_the_run() -> None:
    """Its mark at 170 ms, where there is one; else where its recording ends, at 200 ms."""
    table = trace(
        Z__cnc_lag_mm=during(0.5, 165, 175, rest=0.25),
        Z__stop_force_n=during(7.0, 165, 175, rest=3.0),
    )
    marks = at("relax_begin", 155), at("relax_end", 160)
    with_mark = stop(*marks, at("end", 170))
    assert answers_of(with_mark, table)["left after relaxing"] == "lag 0.5 mm, 7 N"
    assert answers_of(stop(*marks), table)["left after relaxing"] == "lag 0.25 mm, 3 N"


@pytest.mark.parametrize(("count", "numbers"), [(1, [""]), (2, [1, 2]), (3, [1, 2, 3])])
def test_several_runs_to_a_stop_are_numbered(count: int, numbers: list[Any]) -> None:
    fields = fields_of(stop(at("contact", 150, "Z")))
    found = [StopFindings(**fields | {"number": number}) for number in range(1, count + 1)]
    shown = sections(RunFindings(events=[], of_topics=found), None, "r", {})
    assert [one["number"] for one in shown] == numbers


@pytest.mark.parametrize(
    ("value", "text"),
    [(1234.56789, "1234.568"), (-1234.56789, "-1234.568"), (100.0, "100"), (-100.0000001, "-100"),
     (99.123456789, "99.123457"), (-99.123456789, "-99.123457"), (-0.0000001, "0"), (0.5, "0.5")],
)  # fmt: skip
def test_a_value_has_the_same_digits_on_both_sides_of_0(value: float, text: str) -> None:
    """Seven of them from 100 on, six decimals below."""
    row = Value("way", "way", "um", "Z", value)
    fields = fields_of(stop(values=[row]))
    (shown,) = sections(RunFindings(events=[], of_topics=[StopFindings(**fields)]), None, "r", {})
    assert shown["values"][0]["measured"] == text
