"""What is looked at in the cells of a row: units that are left out, variables that nothing uses."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import cell_warnings
from axisrig.bench.campaign.cell_warnings import (
    CellWarnings,
    bare_warning,
    look_at,
    rig_warnings,
)
from axisrig.bench.campaign.used_variables import Used
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.table import Place

SURFACE, OPEN, FEED, STEP = "plant:probe.surface", "plant:door.open", "plc:V.E.FEED", "plc:V.E.STEP"
UNITS = ("plant:probe.surface_mm", "plant:probe.surface_um")
BARE = {SURFACE: ("m", UNITS), OPEN: ("rad", ("plant:door.open_deg",))}
PLACES = {
    name: Place(Path("p.csv"), 3, column, name)
    for column, name in enumerate((SURFACE, OPEN, FEED, STEP), 4)
}
INPUTS = {SURFACE: "0.02", OPEN: "1", FEED: "600", STEP: "5"}


def settings(**more: Any) -> Any:
    known = {"bare": {}, "bare_in_rig": {}, "files": [Path("own.toml"), Path("base.toml")]}
    return SimpleNamespace(**(known | more))


def looked(
    monkeypatch: pytest.MonkeyPatch, of_rig: Any, *used: str, **more: Any
) -> list[cell_warnings.Looked]:
    """What is found in a row with four inputs. used: names of the variables that are."""
    asked: list[Path] = []

    def used_variables(_settings: Any, program: Path, _parsed: Any) -> Used:
        asked.append(program)
        return Used(frozenset(used), all_may=False)

    monkeypatch.setattr(cell_warnings, "used_variables", used_variables)
    case = case_of("a", **({"inputs": INPUTS, "places": PLACES} | more))
    found = look_at(case, SimpleNamespace(settings=of_rig, program=None))  # type: ignore[arg-type]
    assert asked == [Path("part.nc")]  # programs are read once for all cells of a row
    return found


def test_each_variable_is_looked_up_by_its_own_name(monkeypatch: pytest.MonkeyPatch) -> None:
    found = looked(monkeypatch, settings(), "STEP")
    assert [(one.column, one.place, one.is_unused) for one in found] == [
        (FEED, PLACES[FEED], True),
        (STEP, PLACES[STEP], False),
    ]
    assert found[0].text.startswith(f"{FEED} is not used: part.nc")
    assert found[1].text == ""


def test_each_value_without_a_unit_is_named_with_its_own_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = looked(monkeypatch, settings(bare=BARE), "FEED", "STEP")
    assert [one.text for one in found] == [
        f"{SURFACE} names no unit, so 0.02 counts in m; with a unit: {UNITS[0]} or {UNITS[1]}",
        f"{OPEN} names no unit, so 1 counts in rad; with a unit: plant:door.open_deg",
        "", "",
    ]  # fmt: skip
    warnings = CellWarnings()
    warnings.add(found)
    assert warnings.lines() == [
        f"p.csv:3:4: {found[0].text}", f"p.csv:3:5: {found[1].text}",
    ]  # fmt: skip


def test_a_value_of_the_command_line_has_no_place_in_the_table(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Also where the plan has a cell for it: that cell was not taken."""
    found = looked(monkeypatch, settings(bare=BARE), "STEP", overridden=frozenset({SURFACE, FEED}))
    places = {one.column: one.place for one in found}
    assert places == {SURFACE: None, OPEN: PLACES[OPEN], FEED: None, STEP: PLACES[STEP]}


def test_start_values_of_a_rig_are_named_before_cells_by_its_own_file(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each with the names that its rig would have them by, those without the instance."""
    words = [
        "own.toml: start value probe.surface names no unit and counts in m; with a unit:"
        " surface_mm or surface_um",
        "own.toml: start value door.open names no unit and counts in rad; with a unit: open_deg",
    ]
    of_rig = settings(bare_in_rig=BARE, bare={OPEN: BARE[OPEN]})
    assert rig_warnings(of_rig) == words
    assert rig_warnings(settings()) == []
    found = looked(monkeypatch, of_rig, "FEED", "STEP")
    assert [one.text for one in found[:2]] == words
    assert [(one.place, one.is_unused) for one in found[:2]] == [(None, False)] * 2
    assert found[2].column == OPEN
    warnings = CellWarnings()
    for _ in range(2):  # of two rows with one rig
        warnings.add(found)
    assert warnings.lines() == [*words, f"p.csv:3:5: {found[2].text}"]


def test_rows_that_nobody_looks_at_all_may_use_their_defaults(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The second of them has another default than the first."""
    beside: list[Any] = [SimpleNamespace(places={name: PLACES[name]}) for name in (OPEN, STEP)]
    warnings = CellWarnings(iter(beside))
    warnings.add(looked(monkeypatch, settings()))
    (line,) = warnings.lines()
    assert line.startswith(f"p.csv:3:6: {FEED} is not used")


def test_a_value_on_the_command_line_is_named_as_it_was_given() -> None:
    item = parse_assignment("plant:probe.surface=20")
    assert bare_warning(BARE, item).startswith(f"{SURFACE} names no unit, so 20 counts in m; ")
