"""The table of a budget: each column of a cause, and the row of what is left."""

from dataclasses import replace
from typing import Any

import pytest

from axisrig.bench.tools.budget.budget import Budget, Share
from axisrig.bench.tools.budget.causes import causes
from axisrig.bench.tools.budget.words import LEFT, budget_table

CAUSES = {each.cause: each for each in causes()}


def share(cause: str, um: float, **more: Any) -> Share:
    values = {"cause": CAUSES[cause], "setting": f"set {cause}", "alone_um": 2 * um,
              "in_turn_um": um, "expected_um": None, "bound_um": None}  # fmt: skip
    return Share(**(values | more))


def budget(*shares: Share, **given: Any) -> Budget:
    values = {"run": "plan.row", "axis": "C", "error_um": -9.5, "velocity_mm_s": -10.0,
              "increment_um": 0.01, "left_um": 0.004, "shares": shares,
              "frame_log_sha256": "abc"}  # fmt: skip
    return Budget(**(values | given))


def test_a_row_has_what_its_cause_is_and_costs() -> None:
    """Numbers that all differ: alone -3, in turn -1.5, by its form -1.2, mean of all orders -2."""
    trigger, encoder = CAUSES["trigger"], CAUSES["encoder"]
    assert trigger.meaning != encoder.meaning
    row, bounded, _ = budget_table(
        budget(
            share("trigger", -1.5, expected_um=-1.2, combined_um=-2.0),
            share("encoder", 0.25, bound_um=0.1),
        )
    )
    assert row == {
        "run": "plan.row", "axis": "C", "cause": "trigger", "setting": "set trigger",
        "effect": trigger.effect, "alone_um": -3.0, "in_turn_um": -1.5, "closed_form_um": -1.2,
        "bound_um": None, "meaning": trigger.meaning, "frame_log_sha256": "abc",
        "term": trigger.term, "combined_um": -2.0, "differs_um": pytest.approx(-0.3),
    }  # fmt: skip
    assert (bounded["cause"], bounded["closed_form_um"], bounded["bound_um"]) == (
        "encoder", None, 0.1
    )  # fmt: skip
    assert (bounded["combined_um"], bounded["differs_um"]) == (None, pytest.approx(0.15))


def test_effect_and_term_of_each_cause_are_those_of_its_table() -> None:
    """As the GUM has the words: what comes again is systematic, what is drawn is random."""
    rows = budget_table(budget(*(share(name, 1.0) for name in CAUSES)))
    assert [row["cause"] for row in rows] == [*CAUSES, LEFT]
    for row in rows[:-1]:
        cause = CAUSES[str(row["cause"])]
        assert (row["effect"], row["term"], row["meaning"]) == (
            cause.effect, cause.term, cause.meaning
        )  # fmt: skip
    assert {row["effect"] for row in rows[:-1]} >= {"systematic", "random"}


def test_all_rows_have_the_same_columns_and_the_last_one_only_what_is_left() -> None:
    first, left = budget_table(budget(share("trigger", -9.504)))
    assert list(first) == list(left)
    held = {name: value for name, value in left.items() if value not in (None, "")}
    assert held == {
        "run": "plan.row", "axis": "C", "cause": LEFT, "in_turn_um": 0.004,
        "frame_log_sha256": "abc",
    }  # fmt: skip
    (alone,) = budget_table(budget())
    assert list(alone) == list(left)


def test_the_last_row_says_what_is_not_explained_then_what_was_left_out() -> None:
    made = budget(left_um=-0.5, kept_on=("run-up", "braking"), not_combined=("drift",))
    (left,) = budget_table(made)
    parts = str(left["meaning"]).split("; ", 2)
    assert len(parts) == 3
    assert parts[0].startswith("not explained: -0.5000 um")
    assert parts[1] == "not switched off, as there is no value without: run-up, braking"
    assert parts[2].startswith("not combined, only in turn")
    assert parts[2].endswith(": drift")
    (explained,) = budget_table(replace(made, left_um=0.0, kept_on=()))
    assert str(explained["meaning"]) == parts[2]
