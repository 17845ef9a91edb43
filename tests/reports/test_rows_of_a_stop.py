"""The rows of a run to a fixed stop: what lasts, the closed form beside it, values and trouble."""

from typing import Any

import pytest
from tests.reports.short_stops import at, stop
from tests.reports.stops import MS

from axisrig.bench.judge.fixed_stop.stop_findings import KERNEL, Mark
from axisrig.bench.judge.fixed_stop.values import Value
from axisrig.bench.judge.observed.event import Event
from axisrig.reports.fixed_stop import section
from axisrig.reports.fixed_stop.signals import span

ORIGIN = 100 * MS
OFF, ON = at("monitoring_off", 120), at("monitoring_on", 160)
DETECTED, RELAX = at("detected", 140), at("relax_begin", 175)


def test_what_lasts_begins_or_ends_at_its_mark() -> None:
    """The minimum time is 20 ms of Z and 40 ms of Z2, the end of the run is at 100 ms."""
    for row, others, lasts in (
        (at("beyond", 130, "Z"), (), (30.0, 50.0)), (at("beyond", 130, "Z2"), (), (30.0, 70.0)),
        (at("window", 150, "Z"), (), (30.0, 50.0)), (at("window", 150, "Z2"), (), (10.0, 50.0)),
        (OFF, (ON,), (20.0, 60.0)), (OFF, (), (20.0, 100.0)),
        (at("stands", 170, "Z"), (DETECTED,), (40.0, 70.0)),
        (at("stands", 170, "Z"), (at("detected", 140, "Z2"), at("detected", 150, "Z")),
         (50.0, 70.0)),
        (at("relax_end", 190), (DETECTED, RELAX), (75.0, 90.0)),
        (at("stands", 170, "Z"), (RELAX,), None), (at("relax_end", 190), (DETECTED,), None),
        (DETECTED, (at("beyond", 110),), None), (at("beyond", None, "Z"), (), None),
        (at("beyond", 130, "X"), (), None), (at("stands", 140, "Z"), (DETECTED,), None),
    ):  # fmt: skip
        found = section._stretch(row, stop(row, *others), ORIGIN)
        assert found == (None if lasts is None else pytest.approx(lasts)), (row.key, row.axis)


def row_of(**more: Any) -> dict[str, Any]:
    """A detection at 130 ms, from the contact at 100 ms on."""
    mark = Mark("detected", "stop detected", **{"axis": "Z", "measured_ns": 130 * MS,
                "source": KERNEL, **more})  # fmt: skip
    made = stop(mark)
    return section._row(mark, made, ORIGIN, span(made), "grid")


def test_a_measured_instant_is_beside_that_of_the_closed_form() -> None:
    """29.5 ms with a band of -1.5 to 1 ms; one outside is a fail."""
    band = {"oracle_ns": round(129.5 * MS), "low_ns": 128 * MS, "high_ns": round(130.5 * MS)}
    for measured_ns, apart, verdict in (
        (130 * MS, "+0.50", "pass"), (128 * MS, "-1.50", "pass"), (131 * MS, "+1.50", "fail"),
        (127 * MS, "-2.50", "fail"), (None, "", ""),
    ):  # fmt: skip
        row = row_of(**band, measured_ns=measured_ns)
        assert (row["form"], row["band"], row["apart"]) == ("29.50", "-1.50 … +1.00", apart)
        assert (f"v-{verdict}" in row["bar"]) is bool(verdict)
        assert bool(row["bar"]) is bool(verdict)
    never = row_of(measured_ns=None, note="why")
    assert (never["at"], never["form"], never["bar"], never["note"]) == ("never", "", "", "why")
    assert "stop detected · Z: never" in never["lane"]
    plain = row_of(is_inside=True, axis=None)
    assert (plain["at"], plain["label"], plain["kind"]) == ("30.00", "stop detected", "latch")
    assert plain["is_inside"] is True
    half = row_of(oracle_ns=129 * MS, low_ns=None, high_ns=131 * MS)
    assert (half["form"], half["band"]) == ("", "")


def value_of(measured: float | None, unit: str = "N", **more: Any) -> dict[str, Any]:
    return section._value(Value("key", "force", unit, "Z", measured, **more))


def test_a_value_is_held_to_the_bounds_that_there_are() -> None:
    for measured, low, high, is_inside, band in (
        (5.0, 4.0, 6.0, True, "4 … 6"), (3.0, 4.0, 6.0, False, "4 … 6"),
        (7.0, 4.0, 6.0, False, "4 … 6"), (7.0, 4.0, None, True, "≥4"),
        (3.0, 4.0, None, False, "≥4"), (3.0, None, 4.0, True, "≤4"),
        (5.0, None, 4.0, False, "≤4"), (5.0, None, None, None, ""), (5.0, 5.0, 5.0, None, ""),
        (None, 4.0, 6.0, None, "4 … 6"), (4.0000004, None, 4.0, True, "≤4"),
    ):  # fmt: skip
        found = value_of(measured, low=low, high=high)
        assert (found["is_inside"], found["band"]) == (is_inside, band), (measured, low, high)
        verdict = {True: "v-pass", False: "v-fail", None: ""}[is_inside]
        assert verdict in found["bar"]
        assert bool(found["bar"]) is (is_inside is not None)


def test_a_value_less_what_was_expected_has_its_unit_and_lengths_are_in_um() -> None:
    for measured, expected, unit, texts in (
        (100.0025, 100.0, "mm", ("100.0025", "100", "+2.500 µm")),
        (99.5, 100.0, "N", ("99.5", "100", "-0.5 N")),
        (-99.5, -100.0025, "mm", ("-99.5", "-100.0025", "+502.500 µm")),
        # An angle is no length
        (30.5, 30.0, "deg", ("30.5", "30", "+0.5 deg")),
        (30.0, 30.0025, "mm", ("30", "30.0025", "-2.500 µm")),
        (-1234.56789, 0.0, "N", ("-1234.568", "0", "-1235 N")),
        (-0.0000001, None, "N.m", ("0", "", "")), (None, 3.0, "N", ("", "3", "")),
        (1234.56789, 0.1234567, "ms", ("1234.568", "0.123457", "+1234 ms")),
    ):  # fmt: skip
        found = value_of(measured, unit, expected=expected)
        assert (found["measured"], found["expected"], found["apart"]) == texts


def test_trouble_of_a_run_is_what_ended_a_program_in_it_or_right_after() -> None:
    """From 100 to 200 ms, and 20 ms more; each with what its alarm says."""
    events = [
        Event(99 * MS, "alarm", "ID 1"), Event(100 * MS, "fault", "drop"),
        Event(150 * MS, "alarm", "ID 2"), Event(150 * MS, "alarm", "ID 3", is_warning=True),
        Event(150 * MS, "edge", "edge"), Event(220 * MS, "alarm", "ID 4"),
        Event(221 * MS, "alarm", "ID 5"),
    ]  # fmt: skip
    found = section._trouble(stop(), events, {"ID 2": "what it says"})
    assert [(one.key, one.label, one.measured_ns, one.note) for one in found] == [
        ("fault", "drop", 100 * MS, ""),
        ("alarm", "ID 2", 150 * MS, "what it says"),
        ("alarm", "ID 4", 220 * MS, ""),
    ]


def test_what_ended_a_run_comes_before_its_end() -> None:
    """Marks of the monitoring and the end are the last rows."""
    made = stop(at("contact", 110, "Z"), at("detected", 140), at("monitoring_on", 190),
                at("end", 195), is_found=True)  # fmt: skip
    (trouble,) = section._trouble(made, [Event(150 * MS, "alarm", "ID 2")], {})
    view = section._timeline(made, [trouble], None, "run-1")
    keys = ["contact", "detected", "alarm", "monitoring_on", "end"]
    assert [row["key"] for row in view["rows"]] == keys
    assert (view["state"], view["word"], view["origin"]) == (
        "found", "stop found, then ID 2", "contact",
    )  # fmt: skip
    missed = section._timeline(stop(is_found=False, decided_by=None), [trouble], None, "run-1")
    assert (missed["state"], missed["word"], missed["origin"]) == (
        "ended", "ended by ID 2", "begin",
    )  # fmt: skip
    assert [row["key"] for row in missed["rows"]] == ["alarm"]
