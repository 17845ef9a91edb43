"""Conditions: how a cell is read, and where the guard band draws its lines."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.plan.checks import Check, known_metrics, parse_check, parse_condition, value_text
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError, catalogue

P, M, INC, F = Verdict.PASS, Verdict.MARGINAL, Verdict.INCONCLUSIVE, Verdict.FAIL


@pytest.mark.parametrize(
    ("text", "lower", "upper"),
    [
        ("<= 0.5", None, 0.5),
        ("<=0.5", None, 0.5),
        ("< 1", None, 1.0),
        (">= 2", 2.0, None),
        ("> -2.5e-3", -0.0025, None),
        ("== 70331", 70331.0, 70331.0),
        ("70331", 70331.0, 70331.0),
        ("66.99 .. 67.01", 66.99, 67.01),
        ("-1..-.5", -1.0, -0.5),
        ("-1e3 .. 1e-3", -1000.0, 0.001),
        ("100 +- 0.001", 99.999, 100.001),
        ("100 ± 0.001", 99.999, 100.001),
        ("20.0045 +/- 0.01", 19.9945, 20.0145),
        ("0.3 +- 0.1", 0.2, 0.4),
        ("1.1 +- 2.2", -1.1, 3.3),
        ("!= 3", None, None),
    ],
)
def test_limits_are_those_a_reader_writes_down(
    text: str, lower: float | None, upper: float | None
) -> None:
    condition = parse_condition(text, "number")
    assert (condition.lower, condition.upper) == (lower, upper)


@pytest.mark.parametrize(
    "text", ["<= 0,5", "=> 2", "5 .. 4", "about 3", "", "<=", "nan", "== TRUE"]
)
def test_a_number_metric_refuses(text: str) -> None:
    with pytest.raises(UserError):
        parse_condition(text, "number")


def test_a_decimal_comma_is_named() -> None:
    with pytest.raises(UserError, match="decimal point"):
        parse_condition("<= 0,5", "number")
    with pytest.raises(UserError, match="decimal point"):
        parse_condition("0,5", "any")


# Limits 0 .. 10 with u = 1: inconclusive up to 1 from a limit, marginal up to 2, pass beyond.
@pytest.mark.parametrize(
    ("value", "verdict"),
    [
        (5.0, P), (2.001, P), (2.0, M), (1.001, M), (1.0, INC), (0.0, INC), (-1.0, INC),
        (7.999, P), (8.0, M), (8.999, M), (9.0, INC), (10.0, INC), (11.0, INC), (11.001, F),
        (-1.001, F),
    ],
)  # fmt: skip
def test_guard_band_is_the_uncertainty(value: float, verdict: Verdict) -> None:
    assert parse_condition("0 .. 10").judge(value, 1.0) == verdict


@pytest.mark.parametrize(
    ("text", "value", "verdict"),
    [
        ("<= 0.5", 0.5, P),
        ("<= 0.5", 0.5000001, F),
        ("< 0.5", 0.5, F),
        ("< 0.5", 0.4999999, P),
        (">= 2", 2, P),
        ("> 2", 2, F),
        ("== 70331", 70331, P),
        ("== 70331", 70332, F),
        ("!= 3", 3, F),
        ("!= 3", 3.1, P),
        ("66.99 .. 67.01", 67.01, P),
        ("66.99 .. 67.01", 67.0101, F),
        ("100 +- 0.001", 100.001, P),
        ("<= 0.5", -math.inf, P),
        ("<= 0.5", math.inf, F),
    ],
)
def test_without_uncertainty_the_limit_decides(text: str, value: float, verdict: Verdict) -> None:
    assert parse_condition(text).judge(value) == verdict


def test_unequal_keeps_its_distance() -> None:
    condition = parse_condition("!= 3")
    assert [condition.judge(3.0 + d, 1.0) for d in (0.5, 1.0, 1.5, 2.0, 2.5)] == [INC, INC, M, M, P]


@pytest.mark.parametrize("text", ["<= 0.5", "> 2", "0 .. 1", "!= 3", "== TRUE"])
@pytest.mark.parametrize("uncertainty", [0.0, 1.0, 1e9])
def test_a_missing_value_never_passes(text: str, uncertainty: float) -> None:
    condition = parse_condition(text)
    assert condition.judge(None, uncertainty) == F
    assert condition.judge(math.nan, uncertainty) == F
    assert parse_condition("none", "alarms").judge(None) == F


@pytest.mark.parametrize("uncertainty", [-0.1, math.nan])
def test_an_impossible_uncertainty_is_a_defect(uncertainty: float) -> None:
    with pytest.raises(ValueError, match="uncertainty"):
        parse_condition("<= 1").judge(0.5, uncertainty)


@pytest.mark.long
@given(
    value=st.floats(-100, 100),
    low=st.floats(-50, 50),
    width=st.floats(0, 50),
    u=st.floats(0.001, 20),
)
def test_pass_means_every_value_within_the_uncertainty_is_inside(
    value: float, low: float, width: float, u: float
) -> None:
    """The claim behind the guard band, checked at both ends of the interval value +- u."""
    high = low + width
    verdict = parse_condition(f"{low!r} .. {high!r}").judge(value, u)
    ends_inside = [low <= value + end <= high for end in (-u, u)]
    tiny = 1e-9
    if verdict <= M:
        assert low - tiny <= value - u
        assert value + u <= high + tiny
    elif verdict == F:
        assert not any(ends_inside)


@pytest.mark.parametrize(
    ("text", "found", "verdict"),
    [
        ("none", [], P),
        ("==", [], P),
        ("== none", [], P),
        ("none", [50059], F),
        ("50059", [50059], P),
        ("== 50059", [50059, 50052], F),
        ("== 50059 50052", [50059, 50052], P),
        ("== 50052 50059", [50059, 50052], F),
        ("!= none", [50059], P),
        ("!= none", [], F),
        ("contains 50052", [50059, 50052], P),
        ("contains 50052 70331", [50059, 50052], F),
        ("50059 50052", [50059, 50052], P),
        ("50059 50052", [50059], F),
        ("one of 50059 50052", [50052], P),
        ("== 310017 50052", [70331, 50052], P),
        ("contains 70331", [50052, 310017], P),
        ("!= 310017", [70331], F),
        ("one of 50059 50052", [50059, 50052], P),
        ("one of 50059 50052", [], F),
        ("one of 50059 50052", [50059, 70331], F),
        ("one of none 50052", [], P),
        ("one of none 50052", [50052], P),
    ],
)
def test_alarms_are_a_list_in_order(text: str, found: list[int], verdict: Verdict) -> None:
    assert parse_condition(text, "alarms").judge(found) == verdict


@pytest.mark.parametrize(
    "text",
    [
        "contains",
        "one of",
        "one of fifty",
        "one 50052",
        "<= 3",
        "50059, 50052",
        "fifty",
        "contains50052",
    ],
)
def test_alarms_refuse(text: str) -> None:
    with pytest.raises(UserError):
        parse_condition(text, "alarms")


@pytest.mark.parametrize(
    "text",
    ["1", "!= 1", "50052 50953", "contains 500521", "one of none 7", "== 0", "!= " + "9" * 5000],
)
def test_alarms_that_do_not_exist_are_refused(text: str) -> None:
    """`!= 1` held for ever, and `contains` with a digit too much never."""
    with pytest.raises(UserError, match=r"no alarm has this ID.*axisrig errors"):
        parse_condition(text, "alarms")


@pytest.mark.parametrize("text", ["== 050052", "!= 0050052", "contains 00050052", "one of 050052"])
def test_an_id_may_be_written_with_zeros_before_it(text: str) -> None:
    """Six digits wide, as controls show it."""
    assert parse_condition(text, "alarms").text == text


def test_every_alarm_of_the_catalogue_can_be_asked_for() -> None:
    for alarm_id in catalogue():
        assert parse_condition(f"== {alarm_id}", "alarms").judge([alarm_id]) == P


def test_text_and_printed_numbers() -> None:
    assert parse_condition("== TRUE").judge("TRUE") == P
    assert parse_condition("TRUE").judge("FALSE") == F
    assert parse_condition("!= TRUE").judge("FALSE") == P
    assert parse_condition("66.99 .. 67.01").judge(" 67.0000 ") == P
    assert parse_condition("66.99 .. 67.01").judge("not found") == F
    assert parse_condition("70331", "text").judge("70331") == P


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, ""), (0.1, "0.1"), (1e-9, "1e-09"), (70331, "70331"), ([5, 7], "5 7"),
        ([], ""), ("TRUE", "TRUE"), (np.float64(0.1), "0.1"), (np.int64(7), "7"),
    ],
)  # fmt: skip
def test_values_as_text(value: object, text: str) -> None:
    assert value_text(value) == text  # type: ignore[arg-type]


def test_checks_name_axis_block_and_unit() -> None:
    latch = parse_check("latch_error_um:X", "<= 0.5", "probing.csv:2")
    assert (latch.name, latch.axis, latch.block, latch.unit) == ("latch_error_um", "X", None, "um")
    assert parse_check("latch_error_um", "<= 0.5", "").axis is None
    assert parse_check("msg:N30", "67", "").block == ("N30", 1)
    assert parse_check("msg:N30.2", "67", "").block == ("N30", 2)
    assert isinstance(latch, Check)


@pytest.mark.parametrize(
    ("metric", "words"),
    [
        ("latch_eror_um:X", "latch_error_um"),
        ("msg", "msg:N30"),
        ("msg:30", "msg:N30"),
        ("msg:N30.0", "unknown metric"),
        ("alarms:X", "cannot be asked for"),
        ("latch_error_um:X.2", "latch_error_um:X"),
        ("", "unknown metric"),
    ],
)
def test_unknown_metrics_are_refused_with_a_hint(metric: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        parse_check(metric, "<= 1", "probing.csv:2")


@pytest.mark.parametrize(
    ("condition", "close"),
    [("== Lag", "lag"), ("lags", "lag"), ("!= windw", "window"), ("== nothing", "none")],
)
def test_a_word_that_a_metric_never_says_is_refused(condition: str, close: str) -> None:
    """`!= windw` would hold for ever."""
    with pytest.raises(UserError, match="never says") as shown:
        parse_check("detection_criterion:Z", condition, "stop.csv:2")
    assert "lag, window, none" in str(shown.value)
    assert close in str(shown.value)


WORDED = {name: metric for name, metric in known_metrics().items() if metric.words}


@pytest.mark.parametrize("name", sorted(WORDED))
def test_each_word_of_a_metric_is_taken_whole_and_alone(name: str) -> None:
    """No part of a word, no two of them, none with more behind it."""
    words = WORDED[name].words.split()
    assert len(words) == len(set(words)) > 1
    for word in words:
        for condition in (word, f"== {word}", f"!= {word}"):
            assert parse_check(name, condition, "").condition.expected == (word,)
    others = [words[0][:-1], words[0][1:], f"{words[0]}s", " ".join(words[:2]), WORDED[name].words]
    for other in (*others, words[0].swapcase()):
        assert other not in words
        for condition in (other, f"== {other}", f"!= {other}"):
            with pytest.raises(UserError, match="never says this") as shown:
                parse_check(name, condition, "")
            assert (shown.value.value, shown.value.allowed) == (other, ", ".join(words))


@pytest.mark.parametrize("condition", ["== lag", "window", "!= none"])
def test_the_words_of_a_metric_are_taken(condition: str) -> None:
    assert parse_check("detection_criterion", condition, "").condition.text == condition


TURNED = ("angle", "angular_velocity", "angular_lag")
ANGULAR = {
    **{"mm": "deg", "um": "mdeg", "N": "N.m"},
    **{f"mm/s{power}": f"deg/s{power}" for power in ("", "2", "3")},
}


def test_a_metric_of_rotary_axes_tells_what_its_linear_twin_tells() -> None:
    """Every length and force of an axis has one, in degrees or N.m."""
    known = known_metrics()
    twins = {metric.linear: metric for metric in known.values() if metric.linear}
    for name, twin in twins.items():
        own = known[name]
        assert twin.unit == ANGULAR[own.unit]
        assert (twin.scope, twin.type, twin.judged) == (own.scope, own.type, own.judged)
        assert bool(twin.plot) == bool(own.plot)
    of_axes = {name: metric for name, metric in known.items() if metric.scope != "run"}
    shown = {n for n, metric in of_axes.items() if metric.unit in ANGULAR and not metric.linear}
    others = {name for name in shown if name.startswith("tcp_")}  # of the tool, not of an axis
    assert shown - others - twins.keys() == {"probe_deflection_mm_max"}, "probes meet lengths only"


def test_the_metrics_table_is_sound() -> None:
    for name, metric in known_metrics().items():
        assert metric.name == name
        assert metric.scope in {"run", "axis", "block"}
        assert metric.type in {"number", "text", "alarms", "any"}
        assert metric.plot in {"", "position", "velocity", "lag", *TURNED}
        assert metric.judged in {"", "last", "every"}
        assert not metric.words or metric.type == "text"
        assert metric.meaning
        assert metric.source
        spelled = metric.unit.replace("/", "_").replace(".", "").lower()
        assert not spelled or f"_{spelled}" in name, "the name ends in the unit"


@pytest.mark.parametrize(
    ("cell", "meant"),
    [
        ("≤ 1", "<= 1"),
        ("≥0.5", ">= 0.5"),
        ("≠ 3", "!= 3"),
        ("=< 1", "<= 1"),
        ("<> 3", "!= 3"),
        ("-1 ... 1", "-1 .. 1"),
        ("−1 … 1", "-1 .. 1"),
        ("True", "== TRUE"),
    ],
)
def test_condition_in_other_signs_shows_those_of_a_plan(cell: str, meant: str) -> None:
    with pytest.raises(UserError, match="not a condition") as caught:
        parse_condition(cell, "number")
    assert caught.value.hint == f"write {meant}"
    parse_condition(meant, "any")


def test_condition_that_is_nothing_known_gets_no_hint() -> None:
    with pytest.raises(UserError) as caught:
        parse_condition("about 3", "number")
    assert caught.value.hint is None


def test_a_wrong_condition_is_named_beside_a_wrong_metric() -> None:
    """As the condition of the metric that was meant, or as any."""
    for metric, condition, words in (
        ("latch_eror_um", "1 .. 0", "latch_error_um"),
        ("completely_else", "> ", ""),
    ):
        with pytest.raises(UserError, match="unknown metric") as caught:
            parse_check(metric, condition, "probing.csv:2")
        assert words in str(caught.value)
        assert len(caught.value.further) == 1
    with pytest.raises(UserError, match="unknown metric") as caught:
        parse_check("latch_eror_um", "0 .. 1", "probing.csv:2")
    assert list(caught.value.further) == []
