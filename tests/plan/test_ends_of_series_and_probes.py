"""Series of values at their ends, what a probe keeps of its row, lines of metrics of the user."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.plan.own_metrics import own_module
from axisrig.bench.plan.probes import probe_of
from axisrig.bench.plan.searching import HEAD
from axisrig.bench.plan.series import RUNS_MAX, log_values, range_values
from axisrig.bench.plan.table import Cell, Place
from axisrig.kernel.errors import UserError

PLACE = Place(Path("p.csv"), 2, 4, "plc:V.E.A")


@pytest.mark.parametrize("last", [RUNS_MAX, RUNS_MAX + 1, 10 * RUNS_MAX])
def test_a_range_with_one_value_too_many_is_refused_with_its_count(last: int) -> None:
    """From 0 on: one value more than steps."""
    with pytest.raises(UserError, match=f"{last + 1} runs are more than {RUNS_MAX}"):
        range_values(Cell(f"0 .. {last} step 1", PLACE))


@pytest.mark.parametrize(
    ("first", "last"),
    [("0", "5"), ("5", "0"), ("-1", "5"), ("5", "-1"), ("-5", "-1"), ("5", "5"), ("5", "5.0")],
)
def test_the_ends_of_equal_ratios_are_two_numbers_above_0(first: str, last: str) -> None:
    """A ratio from or to 0 is none, whichever end it is."""
    cell = Cell(f"log({first}, {last}, 3)", PLACE)
    with pytest.raises(UserError, match="two different numbers above 0") as caught:
        log_values(cell, first, last, "3")
    assert caught.value.value == cell.text


@pytest.mark.parametrize("number", [1, 2, 40])
def test_a_probe_is_asked_for_the_checks_of_its_search_and_expects_no_failure(number: int) -> None:
    """What the row itself expects is about the limit that it finds."""
    column = "plant:z.x_mm"
    search: Any = SimpleNamespace(column=column, checks=("own",))
    case = case_of(
        "s", search=search, expected=("search_good",), inputs={"plc:V.E.A": "1"},
        places={HEAD + column: PLACE}, seed=7,
    )  # fmt: skip
    probe = probe_of(case, number, "300")
    assert (probe.run, probe.probe_of) == (f"p-s-s{number:02}", "p-s")
    assert (probe.checks, probe.expected, probe.search) == (("own",), (), None)
    assert probe.inputs == {"plc:V.E.A": "1", column: "300"}
    assert (probe.places[column], probe.seed) == (PLACE, 7)


def test_each_metric_of_a_module_has_the_line_of_its_function(tmp_path: Path) -> None:
    path = tmp_path / "own.py"
    text = "import math\n\n\ndef metric_one(r):\n    '''First.\n\n    More.'''\n\n\n"
    path.write_text(text + "def metric_two(r): ...\n", encoding="utf-8")
    cell = Cell("own.py", Place(tmp_path / "p.csv", 2, 4, "module"))
    found = own_module(cell).metrics
    assert {name: row.source for name, row in found.items()} == {
        "one": f"{path}:4", "two": f"{path}:10",
    }  # fmt: skip
    assert [row.meaning for row in found.values()] == ["First.", ""]


@pytest.mark.parametrize("before", [0, 1, 5])
def test_a_metric_with_a_name_of_axisrig_is_refused_at_its_line(
    tmp_path: Path, before: int
) -> None:
    (tmp_path / "own.py").write_text(
        "\n" * before + "def metric_alarms(r): ...\n", encoding="utf-8"
    )
    with pytest.raises(UserError, match="axisrig has a metric of this name") as caught:
        own_module(Cell("own.py", Place(tmp_path / "p.csv", 2, 4, "module")))
    assert (caught.value.line, caught.value.value) == (before + 1, "alarms")
