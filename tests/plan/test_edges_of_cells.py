"""Cells at the edges of what they may hold, and what a refusal of them names."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.plan import expansion, series
from axisrig.bench.plan.assignment import (
    number,
    parse_assignment,
    parse_column,
    scaled_suffixes,
    suffixes_of,
)
from axisrig.bench.plan.checks import (
    CONDITION_FORMS,
    Metric,
    judge,
    parse_check,
    parse_condition,
    rotary_twin,
)
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError, catalogue

PlanWriter = Callable[..., Path]


def refused(function: Callable[..., object], *arguments: Any) -> UserError:
    with pytest.raises(UserError) as caught:
        function(*arguments)
    return caught.value


# Conditions


@pytest.mark.parametrize("u", [0.25, 4.0])
@pytest.mark.parametrize(
    ("room", "verdict"),
    [
        (-1.01, Verdict.FAIL),
        (-1.0, Verdict.INCONCLUSIVE),
        (1.0, Verdict.INCONCLUSIVE),
        (1.01, Verdict.MARGINAL),
        (2.0, Verdict.MARGINAL),
        (2.01, Verdict.PASS),
    ],
)
def test_a_guard_band_grows_with_the_uncertainty(u: float, room: float, verdict: Verdict) -> None:
    """room: distance inside the limit, in uncertainties."""
    for text, value in ((">= 64", 64 + room * u), ("<= 64", 64 - room * u)):
        assert parse_condition(text, "number").judge(value, u) is verdict


TOO_LARGE = "the limit of the condition is too large to be a limit"


@pytest.mark.parametrize(
    "text",
    [
        "<= 1e999", "> -1e999", "== 1e400", "!= 1e999", "0 .. 1e999", "-1e999 .. 0",
        "100 +- 1e999", "1e999 +- 1", "0 .. 1e99999999999999999999",
        "1e-99999999999999999999 .. 1", "5 +- 1e99999999999999999999",
        "1e99999999 +- 1e-99999999",
    ],
)  # fmt: skip
def test_a_limit_is_a_number_that_a_computer_has(text: str) -> None:
    for type_ in ("number", "any"):
        error = refused(parse_condition, text, type_)
        assert (error.message, error.value) == (TOO_LARGE, text)


def test_what_cannot_be_a_condition_names_the_forms() -> None:
    plain, comma = (refused(parse_condition, text, "number") for text in ("about 3", "<= 0,5"))
    for error, value, hint in ((plain, "about 3", None), (comma, "<= 0,5", "a decimal point")):
        assert (error.value, error.allowed) == (value, CONDITION_FORMS)
        assert (error.hint or "").startswith(hint or "")
        assert bool(error.hint) == bool(hint)
    turned = refused(parse_condition, "5 .. 4", "number")
    assert turned.value == "5 .. 4"
    assert turned.hint == "write the smaller number first; a tolerance is positive"
    assert refused(parse_condition, "5 +- -1", "number").message == turned.message
    for text in ("contains", "contains none", "== 50059 x", "one of", "one of x"):
        assert refused(parse_condition, text, "alarms").message == "not a condition"


def test_an_unknown_alarm_names_it_and_what_is_near() -> None:
    unknown = "500590"
    assert int(unknown) not in catalogue()
    for text in (unknown, f"!= 50059 {unknown}", f"one of none {unknown}"):
        error = refused(parse_condition, text, "alarms")
        assert (error.value, error.hint) == (unknown, "`axisrig errors` lists them all")
        assert error.allowed is not None
        assert "50059" in error.allowed
    far = refused(parse_condition, "77777777777777", "alarms")
    assert far.allowed is None


def test_a_metric_of_ones_own_is_taken_beside_those_of_the_table() -> None:
    own = {"wobble_um": Metric("wobble_um", "run", "number", "um", "", "", "", "", "", "")}
    mine = parse_check("wobble_um", "<= 1", "here", own)
    assert mine.defined is own["wobble_um"]
    assert mine.unit == "um"
    assert parse_check("latch_mm", "<= 1", "here", own).defined is None
    unknown = refused(parse_check, "wobbel_um", "<= 1", "here", own)
    assert (unknown.value, unknown.hint) == ("wobbel_um", "`axisrig metrics` lists them all")
    assert "wobble_um" in str(unknown.allowed)
    axis = refused(parse_check, "wobble_um:X", "<= 1", "here", own)
    assert (axis.value, axis.allowed) == ("wobble_um:X", "wobble_um")
    indexed = refused(parse_check, "latch_mm:X.2", "<= 1", "here")
    assert indexed.allowed == "latch_mm, latch_mm:X"
    block = refused(parse_check, "msg:30", "<= 1", "here")
    assert (block.value, block.allowed) == ("msg:30", "msg:N30, msg:N30.2")
    assert parse_check("msg:N30", "<= 1", "here").block == ("N30", 1)
    assert parse_check("msg:N30.2", "<= 1", "here").block == ("N30", 2)


def test_a_linear_metric_has_its_rotary_twin() -> None:
    assert rotary_twin("latch_mm") == "latch_deg"
    assert rotary_twin("latch_deg") is None
    assert rotary_twin("duration_s") is None


@pytest.mark.parametrize(
    ("value", "hidden", "verdict"),
    [
        (None, True, Verdict.INCONCLUSIVE),
        (None, False, Verdict.FAIL),
        (0.5, True, Verdict.PASS),
        (2.0, True, Verdict.FAIL),
    ],
)
def test_only_a_value_that_is_missing_can_be_hidden(
    value: float | None, hidden: bool, verdict: Verdict
) -> None:
    found = judge(parse_check("latch_mm", "<= 1", "here"), value, note="why", is_hidden=hidden)
    assert (found.verdict, found.note) == (verdict, "why")


# Inputs


@pytest.mark.parametrize("text", ["٣", "1_000", "nan", "inf", "1e999", "-1e99999999999999999999"])
def test_a_number_has_plain_digits_and_an_end(text: str) -> None:
    for unit in ("", "mm"):
        error = refused(number, "plant:probe.stroke", text, unit)
        assert (error.message, error.value) == ("plant:probe.stroke: not a number", text)


@pytest.mark.parametrize(
    ("column", "text", "unit", "hint"),
    [
        ("plant:p.stroke", "0,5", "", "a decimal point, not a comma: 0.5"),
        ("plant:p.stroke", "1 2", "", "several values are a list with bars: [1 | 2]"),
        ("plant:p.stroke", "5 mm", "", "write 5; the unit ends the header: plant:p.stroke_mm"),
        ("plant:p.speed", "5 mm/s", "", "write 5; the unit ends the header: plant:p.speed_mm_s"),
        ("plant:p.a", "5 mm/s²", "", "write 5; the unit ends the header: plant:p.a_mm_s2"),
        ("plant:p.gain", "5 %", "", "write 5; the unit ends the header: plant:p.gain_<unit>"),
        ("plant:p.stroke_mm", "5 um", "mm", "write 5, in the unit of the header (mm)"),
        ("plant:p.stroke_mm", "5 MM", "mm", "write 5, in the unit of the header (mm)"),
        ("plant:p.stroke_mm", "5 N", "mm", "write 5, in the unit of the header (mm)"),
        ("plant:p.stroke_mm", "5 %", "mm", "write 5, in the unit of the header (mm)"),
        ("plant:p.stroke_mm", "1,5", "mm", "a decimal point, not a comma: 1.5"),
        ("drive:d.key", "5 um", "", "write 5 without a unit"),
        ("plant:p.x", "5 \u00b5m", "", "write 5; the unit ends the header: plant:p.x_um"),
        ("plant:p.x", "5\u03bcs", "", "write 5; the unit ends the header: plant:p.x_us"),
        ("plant:p.x", "5 N/\u00b5m", "", "write 5; the unit ends the header: plant:p.x_n_um"),
        ("distance:max_mm", "5 MM", "", "write 5 without a unit"),
        (
            "plant:p.stroke",
            "-1.5e3UM",
            "",
            "write -1.5e3; the unit ends the header: plant:p.stroke_um",
        ),
        ("plant:p.stroke", "+.5 Mm.", "", "write +.5; the unit ends the header: plant:p.stroke_mm"),
        (
            "plant:p.stroke",
            "5 INCH",
            "",
            "write 5; the unit ends the header: plant:p.stroke_<unit>",
        ),
        ("plant:p.stroke", "-0,5", "", "a decimal point, not a comma: -0.5"),
        ("plant:p.stroke", "0,5 mm", "", None),
        ("plant:p.stroke", "fast", "", None),
    ],
)
def test_a_number_that_is_none_says_how_to_write_it(
    column: str, text: str, unit: str, hint: str | None
) -> None:
    assert refused(number, column, text, unit).hint == hint


@pytest.mark.parametrize(
    ("unit", "suffix"),
    [
        ("m", "m"), ("mm", "mm"), ("um", "um"), ("nm", "nm"), ("m/s", "m_s"), ("mm/s", "mm_s"),
        ("m/min", "m_min"), ("mm/min", "mm_min"), ("m/s²", "m_s2"), ("mm/s2", "mm_s2"), ("s", "s"),
        ("ms", "ms"), ("us", "us"), ("ns", "ns"), ("N", "n"), ("kN", "kn"), ("N/m", "n_m"),
        ("N/um", "n_um"), ("N.s/m", "n_s_m"), ("kg", "kg"), ("Hz", "hz"), ("rad", "rad"),
        ("deg", "deg"), ("percent", "percent"),
    ],
)  # fmt: skip
def test_a_unit_of_a_cell_belongs_to_the_header_in_whatever_letters(unit: str, suffix: str) -> None:
    """As the unit is written, in small letters and in capitals."""
    for written in (unit, unit.lower(), unit.upper()):
        error = refused(number, "plant:p.x", f"20 {written}")
        assert error.hint == f"write 20; the unit ends the header: plant:p.x_{suffix}"
        assert parse_column(f"plant:p.x_{suffix}", "20").unit == suffix


def test_suffixes_are_those_of_a_unit_and_a_single_one_scales_nothing() -> None:
    assert suffixes_of(["m"]) == scaled_suffixes(["m"]) == ["m", "mm", "um", "nm"]
    assert suffixes_of(["Hz", "kg"]) == ["kg", "hz"]
    assert scaled_suffixes(["Hz"]) == scaled_suffixes(["furlong"]) == []
    # Of several quantities too, each with one unit: a value counts in each as it is
    assert scaled_suffixes(["Hz", "kg"]) == []
    assert scaled_suffixes(["Hz", "N"]) == ["n", "kn", "hz"]


@pytest.mark.parametrize(
    ("column", "kind", "target", "name", "unit"),
    [
        ("plant:probe.speed_mm_s", "plant", "probe", "speed", "mm_s"),
        ("plant:probe.speed", "plant", "probe", "speed", ""),
        ("set:Z.kenngr.some_mm", "set", "Z", "kenngr.some_mm", ""),  # a path has no unit
        ("drive:servo.window_mm", "drive", "servo", "window_mm", ""),
    ],
)
def test_only_a_plant_has_a_unit_at_the_end(
    column: str, kind: str, target: str, name: str, unit: str
) -> None:
    found = parse_column(column, "1")
    assert (found.kind, found.target, found.name, found.unit) == (kind, target, name, unit)


@pytest.mark.parametrize(
    ("column", "allowed"),
    [
        ("plnt:probe.speed", "plant:probe.speed"),
        ("kenngr.measure.edge", None),
        ("V.E.FEED", "plc:V.E.FEED"),
        ("title", None),
    ],
)
def test_a_column_that_is_no_input_is_named(column: str, allowed: str | None) -> None:
    error = refused(parse_assignment, f"{column}=1")
    assert (error.message, error.value) == ("not an input column", column)
    if allowed is not None:
        assert error.allowed == allowed
    else:  # no other column is near: all inputs, and no column that is none
        assert error.allowed
        assert "requirement" not in error.allowed


@pytest.mark.parametrize("text", ["set:Z.kenngr.measure.edge", "set:Z.kenngr.measure.edge= ", "=1"])
def test_an_assignment_that_lacks_a_part_shows_itself(text: str) -> None:
    error = refused(parse_assignment, text)
    assert error.value == (text if text != "=1" else "")


# Cells that stand for several

HEAD, ROW = "case,program,rig", "probe.nc,machine.toml"


def _read(write_plan: PlanWriter, cells: str, head: str = "plc:V.E.A") -> list[str]:
    plan = read_plan(write_plan(f"{HEAD},{head}\na,{ROW},{cells}\n"))
    return [case.run for case in plan.cases]


@pytest.mark.parametrize(
    "cell",
    [
        "0 .. 1e99999999999999999999 step 1",
        "0 .. 1 step 1e-99999999999999999999",
        "0 .. 1e999999 step 1e-999999",
        '"log(1e-99999999999999999999, 1, 3)"',
    ],
)
def test_a_number_that_no_decimal_holds_is_refused_with_its_place(
    write_plan: PlanWriter, cell: str
) -> None:
    error = refused(_read, write_plan, cell)
    assert (error.line, error.column) == (2, 4)
    assert "a number is too large or too small" in error.message


def test_as_many_runs_as_are_allowed_and_one_more(
    write_plan: PlanWriter, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (expansion, series):
        monkeypatch.setattr(module, "RUNS_MAX", 4)
    for cell in ("1 .. 4 step 1", '"log(1, 8, 4)"', "[1 | 2 | 3 | 4]"):
        assert len(_read(write_plan, cell)) == 4
    for cell in ("1 .. 5 step 1", "[1 | 2 | 3 | 4 | 5]"):
        assert "5 runs are more than 4" in refused(_read, write_plan, cell).message
    assert "2 or more" in refused(_read, write_plan, '"log(1, 8, 5)"').message
    assert "6 runs are more than 4" in (
        refused(_read, write_plan, "[1 | 2],[1 | 2 | 3]", "plc:V.E.A,plc:V.E.B").message
    )


@pytest.mark.parametrize(
    ("cell", "value", "hint"),
    [
        ("[1 | 2", "[1 | 2", "[[ writes a bracket"),
        ("1 | 2]", None, None),  # a text
        ("[ | ]", "[ | ]", None),
        ("[1 | ]", "[1 | ]", "- leaves the cell empty"),
        ("[1 | [2]", "[2", None),
        ("[1 | 2..3 step 1]", "2..3 step 1", None),
        ('"[1 | log(1, 2, 3)]"', "log(1, 2, 3)", None),
        ("[1 | 2 | 3 | 2 | 3]", "2", None),
        ("1 .. 3", "1 .. 3", "1 .. 3 step ...; without it it is a condition"),
        ("1 .. 3 setp 1", "1 .. 3 setp 1", None),
        ("3 .. 1 step 1", "3 .. 1 step 1", None),
        ("1 .. -1 step -0.75", "1 .. -1 step -0.75", "the last step before it ends at -0.5"),
        ('"log(5, 5, 3)"', "log(5, 5, 3)", None),
        ('"log(5, 0, 3)"', "log(5, 0, 3)", None),
        ('"log(5, 6, 1)"', "log(5, 6, 1)", None),
        ('"normal(1e999, 1)"', "normal(1e999, 1)", None),
        ('"lhs(0, 1e999)"', "lhs(0, 1e999)", None),
        ('"normal(0, -1)"', "normal(0, -1)", None),
        ('"sobol(1, 1)"', "sobol(1, 1)", None),
        ('"sobol(1)"', "sobol(1)", None),
    ],
)
def test_a_cell_that_stands_for_nothing_shows_what_is_wrong(
    write_plan: PlanWriter, cell: str, value: str | None, hint: str | None
) -> None:
    if value is None:
        assert len(_read(write_plan, cell)) == 1
        return
    error = refused(_read, write_plan, cell)
    assert (error.line, error.column, error.value) == (2, 4, value)
    assert (error.hint or "").startswith(hint or "")
    assert bool(error.hint) == bool(hint)


def test_samples_need_a_seed_that_is_one_number(write_plan: PlanWriter) -> None:
    head = "plc:V.E.A,samples,seed"
    for cells, place, hint in (
        ('"lhs(0, 1)",,7', "plc:V.E.A", "samples is missing"),
        ('"lhs(0, 1)",2,', "plc:V.E.A", "seed is missing"),
        ('"lhs(0, 1)",2,[7 | 8]', "seed", None),
        ("1,2,7", "samples", None),
    ):
        error = refused(_read, write_plan, cells, head)
        assert f"(column '{place}')" in error.message
        assert error.hint == hint
    assert len(_read(write_plan, '"lhs(0, 1)",2,7', head)) == 2


def test_values_of_no_spread_are_the_mean(write_plan: PlanWriter) -> None:
    """normal(0.25, 0) is drawn, and is 0.25 in every run; with a spread it is on both sides."""
    path = write_plan(f'{HEAD},plc:V.E.A,repeats\na,{ROW},"normal(0.25, 0)",3\n')
    runs = read_plan(path).cases
    assert [case.inputs["plc:V.E.A"] for case in runs] == ["0.25"] * 3
    path = write_plan(f'{HEAD},plc:V.E.A,repeats\na,{ROW},"normal(100, 1)",20\n')
    values = [float(case.inputs["plc:V.E.A"]) for case in read_plan(path).cases]
    assert min(values) < 100.0 < max(values)
    assert all(abs(value - 100.0) < 6.0 for value in values)
    assert len(set(values)) == 20


def test_lists_that_go_together_are_counted_once(write_plan: PlanWriter) -> None:
    head = "plc:V.E.A,plc:V.E.B,expand,repeats"
    assert len(_read(write_plan, "[1 | 2 | 3],[4 | 5 | 6],zip,2", head)) == 6
    assert len(_read(write_plan, "[1 | 2 | 3],[4 | 5 | 6],product,2", head)) == 18
    error = refused(_read, write_plan, "[1 | 2 | 3],[4 | 5],zip,1", head)
    assert "the list has 2 values and that of plc:V.E.A 3" in error.message
    assert error.hint == "with `zip` all lists of a row have the same length"
    assert refused(_read, write_plan, "1,2,both,1", head).allowed == "product, zip"


def test_a_label_is_cut_above_sixty_signs(write_plan: PlanWriter) -> None:
    fits, cut = "x" * 60, "y" * 61
    first, second = _read(write_plan, f"[{fits} | {cut}]")
    assert first == f"probing-a-{fits}"
    assert second.startswith(f"probing-a-{'y' * 40}-")
    assert len(second) == len("probing-a-") + 40 + 1 + 8


def test_two_points_of_a_logarithm_are_its_ends(write_plan: PlanWriter) -> None:
    assert _read(write_plan, '"log(0.1, 10, 2)"') == ["probing-a-0.1", "probing-a-10"]
    assert _read(write_plan, '"log(0.1, 10, 3)"')[1] == "probing-a-1"
