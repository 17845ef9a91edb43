"""A variable in a cell of the row itself has to be used; one of a shared table need not be."""

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import RIG, case_of

from axisrig.bench.campaign import preparing
from axisrig.bench.campaign.used_variables import Used
from axisrig.bench.plan.table import Place
from axisrig.kernel.errors import UserError

OWN, SHARED = Path("p.csv"), Path("defaults.csv")


def refused(
    cells: Mapping[str, tuple[str, Path | None, int]],
    monkeypatch: pytest.MonkeyPatch,
    *used: str,
    **changes: Any,
) -> list[UserError]:
    """The errors of a row in line 2 of p.csv. cells: column -> value, and file and line of it."""
    asked: list[object] = []

    def used_variables(*what: object) -> Used:
        asked.append(what)
        return Used(frozenset(used), all_may=False)

    monkeypatch.setattr(preparing, "used_variables", used_variables)
    places = {
        column: Place(file, line, 5, column)
        for column, (_, file, line) in cells.items()
        if file is not None
    }
    inputs = {column: value for column, (value, *_) in cells.items()}
    case = case_of("a", line=2, inputs=inputs, places=places, **changes)
    found = list(preparing._wrong_variables(case, SimpleNamespace(), SimpleNamespace()))  # type: ignore[arg-type]
    assert len(asked) <= 1  # programs are looked through once for a row
    return found


@pytest.mark.parametrize(
    ("file", "line", "is_refused"),
    [
        (OWN, 2, True),
        (SHARED, 2, False),  # of another table, by chance in the same line
        (OWN, 1, False),
        (OWN, 3, False),
        (SHARED, 7, False),
        (None, 0, False),
    ],
)
def test_only_a_cell_of_the_row_itself_has_to_be_used(
    monkeypatch: pytest.MonkeyPatch, file: Path | None, line: int, is_refused: bool
) -> None:
    errors = refused({"plc:V.E.FEED": ("600", file, line)}, monkeypatch)
    assert len(errors) == is_refused
    for error in errors:
        assert (str(error.file), error.line, error.column, error.value) == ("p.csv", 2, 5, "600")
        assert "plc:V.E.FEED is not used" in error.message


@pytest.mark.parametrize(
    ("column", "used", "count"),
    [
        ("plc:V.E.FEED", ("FEED",), 0),
        ("plc:V.E.feed", ("FEED",), 0),
        ("plc:V.E.FEE", ("FEED",), 1),
        ("plc:feedhold", (), 0),
        ("plc:Z.torque_limit", (), 0),
        ("plant:probe.switched_on", (), 0),
    ],
)
def test_only_variables_have_to_be_used(
    monkeypatch: pytest.MonkeyPatch, column: str, used: tuple[str, ...], count: int
) -> None:
    errors = refused({column: ("1", OWN, 2)}, monkeypatch, *used)
    assert len(errors) == count
    assert [error.hint for error in errors] == ["did you mean V.E.FEED?"] * count


def test_each_cell_that_nothing_uses_is_named_in_the_order_of_the_row(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cells = {f"plc:V.E.{name}": (str(n), OWN, 2) for n, name in enumerate(("B", "USED", "A", "C"))}
    errors = refused(cells, monkeypatch, "USED")
    assert [error.value for error in errors] == ["0", "2", "3"]


def test_a_value_of_the_command_line_need_not_be_used_by_each_row(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """`--set` is for all rows; the other cell of the row counts still."""
    cells = {"plc:V.E.A": ("1", OWN, 2), "plc:V.E.B": ("2", OWN, 2)}
    errors = refused(cells, monkeypatch, overridden=frozenset({"plc:V.E.A"}))
    assert [error.value for error in errors] == ["2"]


@pytest.mark.parametrize(("file", "named"), [(OWN, OWN), (None, RIG)])
def test_several_mistakes_of_a_row_are_of_its_plan_and_without_one_of_its_rig(
    monkeypatch: pytest.MonkeyPatch, file: Path | None, named: Path
) -> None:
    refusals: list[Path] = []
    monkeypatch.setattr(
        preparing,
        "settings_of",
        lambda _: SimpleNamespace(rig=SimpleNamespace(axis=("Z",)), is_settled=False),
    )
    monkeypatch.setattr(preparing, "_program", lambda *_: None)
    monkeypatch.setattr(preparing, "programs_of", lambda *_: {})
    monkeypatch.setattr(preparing, "_wrong_variables", lambda *_: [])
    monkeypatch.setattr(preparing.Mistakes, "refuse", lambda _, file: refusals.append(file))
    preparing.read_case(case_of("a", file=file))
    assert refusals == [named]
