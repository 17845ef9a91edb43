"""What a table and a picture of sensitivity say of an effect, and the words of a sample."""

import dataclasses
import re
from types import SimpleNamespace
from typing import Any

import pytest
from tests.reports.swept import numbers

from axisrig.bench.judge.statistics.summary import describe
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.statistics.estimates import Effect, Estimate
from axisrig.reports.statistics.section import SampleView, _block, _limits, _members, _value
from axisrig.reports.sweeps.sensitivity import Sensitivity, _cell, _per_cent, _rounded, tornado


def effect(value: float, lower: float, upper: float, r_squared: float = 0.9) -> Effect:
    return Effect(Estimate(value, lower, upper, 9), 1.0, 3.0, r_squared)


@pytest.mark.parametrize(
    ("found", "cell"),
    [
        (effect(2.0, 1.0, 3.0), "<td><b>▲ +20 %</b> <i>+10 to +30</i></td>"),
        (effect(-2.0, -3.0, -1.0), "<td><b>▼ -20 %</b> <i>-30 to -10</i></td>"),
        (effect(1.0, -1.0, 3.0), '<td class="soft">+10 % <i>-10 to +30</i></td>'),
        (effect(1.0, 0.0, 2.0), '<td class="soft">+10 % <i>0 to +20</i></td>'),
        (effect(-1.0, -2.0, 0.0), '<td class="soft">-10 % <i>-20 to 0</i></td>'),
        (effect(0.5, 0.25, 0.75), "<td><b>▲ +5.0 %</b> <i>+2.5 to +7.5</i></td>"),
    ],
)
def test_a_share_has_its_sign_and_is_bold_where_it_is_sure(found: Effect, cell: str) -> None:
    """Of a width of 10."""
    shown = _cell(found, 10.0).replace('<span class="note">', "<i>").replace("</span>", "</i>")
    assert shown == cell


@pytest.mark.parametrize(
    ("value", "text"),
    [(9.95, "+10"), (9.9, "+9.9"), (-9.95, "-10"), (-9.9, "-9.9"), (123.4, "+123"), (0.04, "0"),
     (0.06, "+0.1"), (-0.04, "0"), (0.0, "0")],
)  # fmt: skip
def test_a_share_is_short(value: float, text: str) -> None:
    assert _per_cent(value) == text


def test_what_is_nothing_beside_its_bounds_is_zero() -> None:
    assert _rounded(Estimate(1e-12, -2.0, 1.0, 9)) == ["0", "-2", "+1"]
    assert _rounded(Estimate(1e-12, -2e-12, 3e-12, 9)) == ["+1e-12", "-2e-12", "+3e-12"]
    assert _rounded(Estimate(-4.0, -4.0, -1e-12, 9)) == ["-4", "-4", "0"]


def picture(*effects: Effect, unit: str = "um", columns: str = "ABCD") -> str:
    sweep: Any = SimpleNamespace(case="p-c", metric="m", unit=unit, columns=columns[: len(effects)])
    return tornado(Sensitivity(sweep, effects, 10.0))


RECT = r'<rect class="[\w-]+" x="([\d.]+)" y="([\d.]+)" width="([\d.]+)"'
BOUND = r'd="M([\d.]+),([\d.]+)v8m0,-4H([\d.]+)'
ZERO = r'x1="([\d.]+)" x2="([\d.]+)" y1="([\d.]+)" y2="([\d.]+)"'


def test_bars_go_from_nothing_to_the_change_the_longest_first() -> None:
    text = picture(effect(-1.0, -2.0, 0.5), effect(2.0, 1.0, 3.0))
    assert [label[0] for label in re.findall(r"<text [^>]*>([^<]*)", text)] == ["B", "A"]
    bars, bounds, zeros = (numbers(pattern, text) for pattern in (RECT, BOUND, ZERO))
    # From -2 to 3 are 5 units between the ends of the picture
    whole = bounds[0][2] - bounds[1][0]
    zero = zeros[0][0]
    assert {x for line in zeros for x in line[:2]} == {zero}
    for (left, _, width), (low, _, high), change, ends in zip(
        bars, bounds, (2.0, -1.0), ((1.0, 3.0), (-2.0, 0.5)), strict=True
    ):
        assert width == pytest.approx(abs(change) * whole / 5, abs=0.2)
        assert left == pytest.approx(zero + min(change, 0.0) * whole / 5, abs=0.2)
        assert (low - zero, high - zero) == pytest.approx(
            [end * whole / 5 for end in ends], abs=0.2
        )
    ((width_px, height_px),) = numbers(r'viewBox="0 0 (\d+) (\d+)"', text)
    assert 0 < bounds[1][0] < bounds[0][2] < width_px
    for (_, top, _), (_, end, _), (_, _, begin, last) in zip(bars, bounds, zeros, strict=True):
        assert begin <= top < end + 4 < top + 12 <= last < height_px
    assert bars[1][1] - bars[0][1] == zeros[1][2] - zeros[0][2] > 12


def test_a_change_of_nothing_is_a_bar_that_can_be_seen() -> None:
    for text in (picture(effect(0.0, 0.0, 0.0)), picture(effect(0.0, -1.0, 1.0))):
        ((_, _, width),) = numbers(RECT, text)
        assert width == 1.0


@pytest.mark.parametrize(
    ("r_squared", "words"),
    [(0.7, "explained: 70 %<"), (0.69, "explained: 69 %: look at the sweep, it is no plane<")],
)
def test_a_picture_says_how_much_it_explains(r_squared: float, words: str) -> None:
    text = picture(effect(2.0, 1.0, 3.0, r_squared))
    assert words in text
    assert "A 1 to 3: +2 (+1 to +3) um<" in text
    assert "m, um <span" in text
    plain = picture(effect(2.0, 1.0, 3.0), unit="")
    assert "A 1 to 3: +2 (+1 to +3)<" in plain
    assert "</b>: m <span" in plain


def test_a_bar_says_whether_it_is_sure() -> None:
    text = picture(effect(2.0, 1.0, 3.0), effect(-1.0, -2.0, -0.5), effect(0.5, -1.0, 2.0))
    assert re.findall(r'<rect class="([\w-]+)"', text) == ["sw-sure", "sw-sure", "sw-unsure"]


# The words of a sample


def section_of(values: list[float], *limits: float | None, **more: Any) -> str:
    checks = [
        CheckRow("mean(m)", "<= 1", "0.123456789", "um", verdict="pass"),
        CheckRow("cpk(m)", "> 1", verdict="inconclusive"),
    ]
    found = describe([f"r{n}" for n in range(len(values))], values, *(limits or (None, None)))
    view = SampleView("p-c", "", "m", "um", [], checks, found)
    return _block(dataclasses.replace(view, **more))


def test_a_sample_in_words() -> None:
    """-0.1 and 0.1: s is 0.1414, t of one degree 12.706; Cpk (0.3 - 0)/(3 s)."""
    text = section_of([-0.1, 0.1], -0.4, 0.3)
    assert "<h3>p-c: m, um</h3><p>n 2, a small sample; mean 0 (-1.27062 to 1.27062) um;" in text
    assert "; s 0.1414 (0.0631 to 4.513) um; 2 s 0.2828 um; Cpk 0.707 (" in text
    assert "<li>pass: mean(m) = 0.1234568 um, asked for &lt;= 1</li>" in text
    assert "<li>inconclusive: cpk(m) = no value, asked for &gt; 1</li>" in text
    assert "Cpk" not in section_of([-0.1, 0.1])
    one = section_of([0.5])
    assert "<p>n 1, a small sample</p>" in one
    assert "<figure>" not in one
    assert "<figure>" in section_of([0.1, 0.2, 0.4])


def test_a_sample_names_what_is_odd_in_it() -> None:
    calm = [0.1, -0.1, 0.2, -0.2, 0.1, -0.1, 0.2, -0.2, 0.1, -0.1, 0.2, -0.2]
    quiet = section_of(calm)
    for words in ("outlier", "first value apart", "drift", "small", "not counted"):
        assert words not in quiet
    assert "outlier: r12, " in section_of([*calm, 9.0])
    assert "first value apart: r0, " in section_of([9.0, *calm])
    rising = section_of([0.1 * n for n in range(12)])
    assert "drift 0.1 um for each value, p " in rising
    assert "not counted, same frames as an earlier run: r1, r2" in section_of(
        calm, equal=["r1", "r2"]
    )
    assert '<p class="note">of a &lt;title&gt;</p>' in section_of(calm, title="of a <title>")
    assert "<h3>p-c: m</h3>" in section_of(calm, unit="")


def test_values_of_checks_have_seven_digits_and_their_unit() -> None:
    for value, unit, text in (("1.23456789", "um", "1.234568 um"), ("2", "", "2"),
                              ("FREE", "um", "no value"), ("", "um", "no value")):  # fmt: skip
        assert _value(CheckRow("m", value=value, unit=unit)) == text


def _run(name: str, case: str, statistic: bool = False, rows: Any = ()) -> Any:
    return SimpleNamespace(
        run=name,
        is_statistic=statistic,
        case={"plan": "p", "case": case},
        checks=[CheckRow.read(row) for row in rows],
    )


def test_a_row_of_statistics_is_about_the_runs_of_its_case() -> None:
    runs = [_run("a1", "a"), _run("a2", "a"), _run("b1", "b"), _run("p-a", "a", True)]
    results: Any = SimpleNamespace(planned=runs)
    assert [one.run for one in _members(results, runs[3])] == ["a1", "a2"]
    assert [one.run for one in _members(results, runs[1])] == ["a2"]


@pytest.mark.parametrize(
    ("limits", "found"),
    [
        ((("1", "2"), ("1", "2")), (1.0, 2.0)),
        ((("", "2"), ("", "2")), (None, 2.0)),
        ((("1", ""),), (1.0, None)),
        ((("1", "2"), ("1", "3")), (None, None)),
        ((), (None, None)),
    ],
)
def test_a_sample_has_the_limits_that_all_its_runs_check(
    limits: tuple[tuple[str, str], ...], found: tuple[float | None, float | None]
) -> None:
    members = [
        _run(f"r{n}", "a", rows=[{"metric": "m", "lower": lower, "upper": upper},
                                 {"metric": "other", "lower": "7", "upper": "8"}])
        for n, (lower, upper) in enumerate(limits)
    ]  # fmt: skip
    assert _limits(members, "m") == found


@pytest.mark.parametrize(("values", "side"), [((2.0, 3.0), "right"), ((-2.0, -3.0), "left")])
def test_bars_of_one_sign_begin_at_no_change(values: tuple[float, ...], side: str) -> None:
    """It is at one edge of the picture, and the longest bar comes first."""
    svg = picture(*(effect(value, value - 0.5, value + 0.5) for value in values))
    bars = [tuple(map(float, bar)) for bar in re.findall(RECT, svg)]
    (zero,) = {float(x) for x in re.findall(r'class="sw-zero" x1="([\d.]+)"', svg)}
    (x, _, width), (other, _, less) = bars
    # Both are drawn to 0.1 px
    assert width == pytest.approx(1.5 * less, abs=0.05 + 1.5 * 0.05 + 1e-3)
    if side == "right":
        assert x == other == zero
    else:
        assert (x + width, other + less) == pytest.approx(
            (zero, zero), abs=0.151
        )  # three numbers to 0.1 px
    assert 0.0 < zero < 420.0
