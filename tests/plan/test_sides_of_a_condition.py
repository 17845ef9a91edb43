"""Conditions on both sides of what they name, and checks of metrics that nobody knows."""

import pytest

from axisrig.bench.plan.checks import Check, parse_check, parse_condition, plot_limits
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError

P, M, INC, F = Verdict.PASS, Verdict.MARGINAL, Verdict.INCONCLUSIVE, Verdict.FAIL


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("excluded", ["40", "-40", "0"])
@pytest.mark.parametrize(
    ("off", "u", "verdict"),
    [
        (0.0, 0.0, F), (0.001, 0.0, P), (1e6, 0.0, P),
        (0.0, 0.5, INC), (0.5, 0.5, INC), (0.75, 0.5, M), (1.0, 0.5, M), (1.25, 0.5, P),
    ],
)  # fmt: skip
def test_a_number_beside_the_excluded_one_is_judged_alike_on_either_side(
    side: float, excluded: str, off: float, u: float, verdict: Verdict
) -> None:
    """ISO 14253-1: the distance counts, not its sign."""
    for kind in ("number", "any"):
        condition = parse_condition(f"!= {excluded}", kind)
        assert condition.judge(float(excluded) + side * off, u) is verdict


@pytest.mark.parametrize(
    ("text", "value", "u", "verdict"),
    [
        ("0 .. 10", 1.0, 0.75, M), ("0 .. 10", 9.0, 0.75, M),
        ("0 .. 10", -1.0, 0.75, F), ("0 .. 10", 11.0, 0.75, F),
        ("> 0", 0.0, 0.0, F), (">= 0", 0.0, 0.0, P), ("< 0", 0.0, 0.0, F), ("<= 0", 0.0, 0.0, P),
        ("> 0", 1e-9, 0.0, P), ("< 0", -1e-9, 0.0, P), ("> 0", -1e-9, 0.0, F),
        ("< 0", 1e-9, 0.0, F),
        ("== 5", 5.0, 0.0, P), ("== 5", 4.999, 0.0, F), ("== 5", 5.001, 0.0, F),
        ("== 5", 4.0, 0.5, F), ("== 5", 4.6, 0.5, INC), ("== 5", 6.0, 0.5, F),
    ],
)  # fmt: skip
def test_each_limit_is_judged_on_its_own_side(
    text: str, value: float, u: float, verdict: Verdict
) -> None:
    assert parse_condition(text, "number").judge(value, u) is verdict


@pytest.mark.parametrize(
    ("value", "verdict"),
    [("0.5", P), (" 0.5 ", P), ("2", F), ("5e-1", P), ("fast", F), ("", F), ("0,5", F), ("1 2", F)],
)
def test_a_text_that_a_program_printed_may_be_a_number(value: str, verdict: Verdict) -> None:
    """`#MSG` fills up with blanks."""
    assert parse_condition("0 .. 1", "any").judge(value) is verdict


@pytest.mark.parametrize(
    ("metric", "condition", "further"),
    [
        ("latch_eror_um", "<= 1", None),
        ("latch_eror_um:Z", "TRUE", "not a condition"),  # a number is meant
        ("latch_eror_um", "about 1", "not a condition"),
        ("alarm", "none", None),
        ("alarm", "TRUE", "not a condition"),
        ("distance_state_ends", "ACTIVE", None),
        ("zzzzzz", "TRUE", None),  # nothing is near: it may be a text
        ("zzzzzz", "<= 1,5", "not a condition"),
    ],
)
def test_a_condition_of_an_unknown_metric_is_read_as_one_of_what_is_meant(
    metric: str, condition: str, further: str | None
) -> None:
    with pytest.raises(UserError, match="unknown metric") as caught:
        parse_check(metric, condition, "")
    found = [one.message for one in caught.value.further]
    assert found == ([] if further is None else [further])
    assert caught.value.value == metric


def shown(metric: str, condition: str) -> list[object]:
    limits = plot_limits(parse_check(metric, condition, "p.csv:2"))
    assert all(one["label"] == metric for one in limits)
    return [one["value"] for one in limits]


@pytest.mark.parametrize(
    ("metric", "condition", "values"),
    [
        ("lag_mm_max:Z", "<= 2", [2.0, -2.0]),  # a magnitude: the lag may be at either side
        ("lag_mm_max:Z", "0.5 .. 2", [0.5, 2.0, -0.5, -2.0]),
        ("lag_mm_max:Z", "== 0", [0.0]),
        ("latch_mm:Z", "66 .. 67", [66.0, 67.0]),
        ("latch_mm:Z", "== 66", [66.0]),  # once, though it is both limits
        ("latch_mm:Z", ">= 66", [66.0]),
        ("latch_mm:Z", "!= 66", []),
        ("bus_load_1ms_pct_max", "<= 50", []),  # no signal of a plot
    ],
)
def test_limits_of_a_signal_are_drawn_once_and_a_magnitude_on_both_sides(
    metric: str, condition: str, values: list[float]
) -> None:
    assert shown(metric, condition) == values


def test_a_drawn_limit_names_plot_and_axis() -> None:
    for metric, plot, axis in (
        ("lag_mm_max:Z", "lag", "Z"), ("latch_mm", "position", None),
        ("velocity_mm_s_max:X", "velocity", "X"),
    ):  # fmt: skip
        check: Check = parse_check(metric, "<= 1", "")
        assert {(one["plot"], one["axis"]) for one in plot_limits(check)} == {(plot, axis)}
