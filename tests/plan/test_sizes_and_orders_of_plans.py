"""How many runs a plan may have with all its rows, and in which order inputs of a row are."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.plan import plan as plan_module
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.table import _further_sheets
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]
HEAD = "case,program,rig,plc:V.E.A,plc:V.E.B,plc:V.E.C"
ROW = "probe.nc,machine.toml"


@pytest.mark.parametrize(
    ("cells", "line"),
    [
        (["[1 | 2]", "[1 | 2]"], None),
        (["[1 | 2]", "[1 | 2 | 3]"], 3),
        (["[1 | 2 | 3 | 4]", "1"], 3),
        (["1", "1", "1", "1", "1"], 6),
        (["1", "[1 | 2]", "1"], None),
    ],
)
def test_the_runs_of_all_rows_together_are_limited(
    write_plan: PlanWriter, monkeypatch: pytest.MonkeyPatch, cells: list[str], line: int | None
) -> None:
    """Four of them here; the row that makes one too many is named."""
    monkeypatch.setattr(plan_module, "RUNS_MAX", 4)
    rows = [f"r{n},{ROW},{text},," for n, text in enumerate(cells)]
    path = write_plan("\n".join([HEAD, *rows, ""]))
    if line is None:
        assert len(read_plan(path).cases) == 4
        return
    with pytest.raises(UserError, match="the plan has more than 4 runs") as caught:
        read_plan(path)
    assert (caught.value.line, caught.value.value) == (line, 5)


@pytest.mark.parametrize(
    ("default", "own", "inputs"),
    [
        (",,3", "1,2,", {"A": "1", "B": "2", "C": "3"}),
        ("1,,", ",2,3", {"A": "1", "B": "2", "C": "3"}),
        (",2,", "1,,3", {"A": "1", "B": "2", "C": "3"}),
        ("9,9,9", ",2,", {"A": "9", "B": "2", "C": "9"}),
        ("1,2,3", "-,,5", {"B": "2", "C": "5"}),
    ],
)
def test_inputs_come_in_the_order_of_their_columns_wherever_they_are_given(
    write_plan: PlanWriter, default: str, own: str, inputs: dict[str, str]
) -> None:
    """They act in this order, also where a default gives the last of them."""
    path = write_plan(f"{HEAD}\n*,,,{default}\na,{ROW},{own}\n")
    (case,) = read_plan(path).cases
    assert list(case.inputs.items()) == [(f"plc:V.E.{k}", value) for k, value in inputs.items()]


@pytest.mark.parametrize("word", ["case", "Case", "CASE"])
def test_a_further_sheet_with_cases_is_refused_in_any_letters(word: str) -> None:
    notes = [["", ""], ["note", "text"]]
    assert _further_sheets(Path("p.xlsx"), {"notes": notes, "empty": []}) == [
        "the sheet 'notes' is not read", "the sheet 'empty' is not read",
    ]  # fmt: skip
    with pytest.raises(UserError, match="a further sheet has a column 'case'") as caught:
        _further_sheets(Path("p.xlsx"), {"notes": notes, "more": [[], ["rig", word]]})
    assert caught.value.value == "more"
