"""A run to a fixed stop of an axis that turns beside one that slides: each in its own units."""

from typing import Any

import pytest
from tests.reports.short_stops import at, during, stop, trace
from tests.reports.test_words_of_a_stop import answers_of

from axisrig.bench.judge.fixed_stop.stop_findings import Decision, StopLimits
from axisrig.bench.judge.fixed_stop.values import Value
from axisrig.kernel.time.clock import MS
from axisrig.reports.fixed_stop.signals import Stop

LIMITS = {"X": StopLimits(1.0, 0.01, 20.0, 0.5), "C": StopLimits(2.0, 0.03, 40.0, 0.02)}
SIGNALS = {
    "X": {"cnc_lag_mm": "X.cnc_lag_mm", "stop_force_n": "X.stop_force_n"},
    "C": {"cnc_lag_mm": "C.cnc_lag_deg", "stop_force_n": "C.stop_torque_nm"},
}
RISING = [float(row) for row in range(300)]
TRACE = trace(
    X__cnc_lag_mm=during(1.5, 120, 130), C__cnc_lag_deg=during(2.5, 120, 135),
    X__change_um=during(15.0, 0, 300), C__change_mdeg=during(60.0, 0, 300),
    X__set_mm=RISING, C__set_deg=RISING,
)  # fmt: skip
SHORT = {
    "X": "X: largest lag 1.5 mm of 1 mm, above it for 10 of 20 ms,"
    " moved 15 µm or more in 20 ms, window 10 µm",
    "C": "C: largest lag 2.5° of 2°, above it for 15 of 40 ms,"
    " moved 0.06° or more in 40 ms, window 0.03°",
}


def both(*marks: Any, order: str = "XC", main: str | None = "X", **more: Any) -> Stop:
    fields = {
        "axes": list(order), "watched": list(order), "main_axis": main, "rotary": {"C": True},
        "limits": {axis: LIMITS[axis] for axis in order}, "signals": SIGNALS, "is_found": False,
        "decided_by": None, **more,
    }  # fmt: skip
    return stop(*marks, **fields)


@pytest.mark.parametrize("main", ["X", "C", None])
@pytest.mark.parametrize("order", ["XC", "CX"])
def test_what_was_missing_of_each_axis_is_in_its_own_unit(order: str, main: str | None) -> None:
    """Whichever axis the run is named by, and in the order in which they are watched."""
    found = answers_of(both(at("armed", 101), order=order, main=main), TRACE)
    assert found["what was missing"] == "; ".join(SHORT[axis] for axis in order)


@pytest.mark.parametrize("main", ["X", "C"])
def test_limits_without_signals_are_in_the_unit_of_their_axis(main: str) -> None:
    found = answers_of(both(at("armed", 101), main=main))
    assert found["what was missing"] == (
        "X: lag limit 1 mm, window 10 µm; C: lag limit 2°, window 0.03°"
    )


@pytest.mark.parametrize(("main", "way"), [("X", "20 µm or 0.5 mm"), ("C", "0.02° or 0.5°"),
                                           (None, "20 µm or 0.5 mm")])  # fmt: skip
def test_the_path_before_the_criteria_is_that_of_the_main_axis(main: str, way: str) -> None:
    found = answers_of(both(main=main), TRACE)
    assert found["what was missing"] == f"the criteria are armed after {way} of the path only"


@pytest.mark.parametrize("main", ["X", "C"])
@pytest.mark.parametrize(
    ("axis", "words"),
    [
        ("X", "X: lag above 1 mm for 20 ms and moved no more than 10 µm in 20 ms"),
        ("C", "C: lag above 2° for 40 ms and moved no more than 0.03° in 40 ms"),
    ],
)
def test_why_a_stop_was_found_is_in_the_unit_of_the_axis_that_decided(
    axis: str, words: str, main: str
) -> None:
    found = both(main=main, is_found=True, decided_by=Decision(axis, "lag"))
    assert answers_of(found)["why here"] == words


@pytest.mark.parametrize(
    ("axis", "beyond_ms", "still_ms", "last"),
    [("X", 120, 141, "window"), ("C", 120, 141, "lag"), ("C", 120, 161, "window"),
     ("X", 120, 139, "lag")],
)  # fmt: skip
def test_which_criterion_came_last_is_asked_of_the_axis_that_decided(
    axis: str, beyond_ms: int, still_ms: int, last: str
) -> None:
    """By its own minimum time: 20 ms of X, 40 ms of C; marks of the other axis do not count."""
    other = "C" if axis == "X" else "X"
    marks = (at("beyond", 10, other), at("window", 250, other), at("beyond", beyond_ms, axis),
             at("window", still_ms, axis))  # fmt: skip
    found = both(*marks, is_found=True, decided_by=Decision(axis, "lag"))
    assert answers_of(found)["why here"].endswith(f"; the {last} came last")


@pytest.mark.parametrize(("rotary", "unit"), [({"C": True}, "N.m"), ({"C": False}, "N"), ({}, "N")])
def test_what_an_axis_that_turns_presses_with_is_a_torque_where_its_arm_is_known(
    rotary: dict[str, bool], unit: str
) -> None:
    rows = [
        Value(key, "", "", axis, value, None, None, None, "")
        for axis, most, last in (("X", 7.0, 5.0), ("C", 3.0, 2.0))
        for key, value in (("stop_force_max", most), ("stop_force_end", last))
    ]
    found = answers_of(both(rotary=rotary, values=rows))
    assert found["pressed with"] == (
        f"X: at most 7 N, 5 N at the end; C: at most 3 {unit}, 2 {unit} at the end"
    )


@pytest.mark.parametrize(("main", "words"), [("X", "lag 0.25 mm, 8 N"), ("C", "lag 0.75°, 4 N.m")])
def test_what_is_left_after_relaxing_is_of_the_main_axis_when_the_run_is_over(
    main: str, words: str
) -> None:
    """Relaxed at 180 ms, the end at 190 ms: what is there then."""
    signals = trace(
        X__cnc_lag_mm=during(0.25, 190, 190, 9.0), X__stop_force_n=during(8.0, 190, 190, 9.0),
        C__cnc_lag_deg=during(-0.75, 190, 190, 9.0), C__stop_torque_nm=during(4.0, 190, 190, 9.0),
    )  # fmt: skip
    found = both(at("relax_end", 180), at("end", 190), main=main)
    assert answers_of(found, signals)["left after relaxing"] == words
    assert "left after relaxing" not in answers_of(both(at("end", 190), main=main), signals)


@pytest.mark.parametrize(
    ("marks", "end_ms", "words"),
    [
        ((at("end", 190),), 250, "lag 0.25 mm, 8 N"),  # the program went on with other blocks
        ((at("end", 190),), 190, "lag 0.25 mm, 8 N"),
        ((), 190, "lag 0.25 mm, 8 N"),  # nobody has noted its end: the one of the run
        ((), 250, "lag 1.25 mm, 3 N"),
    ],
)
def test_what_is_left_is_of_the_end_that_was_noted_else_of_that_of_the_run(
    marks: tuple[Any, ...], end_ms: int, words: str
) -> None:
    signals = trace(
        X__cnc_lag_mm=during(0.25, 190, 190, 1.25), X__stop_force_n=during(8.0, 190, 190, 3.0)
    )
    found = both(at("relax_end", 180), *marks, main="X", order="X", end_ns=end_ms * MS)
    assert answers_of(found, signals)["left after relaxing"] == words


@pytest.mark.parametrize(
    ("touched", "decided", "who"), [("X", "X", ""), ("X", "C", "X "), ("C", "C", ""),
                                    ("C", "X", "C ")],
)  # fmt: skip
def test_a_contact_of_another_axis_than_the_one_that_decided_has_its_name(
    touched: str, decided: str, who: str
) -> None:
    found = both(
        at("contact", 150, touched), at("detected", 180), is_found=True,
        decided_by=Decision(decided, "lag"),
    )  # fmt: skip
    assert answers_of(found)["real stop"] == f"yes: {who}in contact for 30.0 ms when detected"
