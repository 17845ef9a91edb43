"""Start values of plants that are found once and set in each run; columns that name no unit."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from fmpy.model_description import BaseUnit, ModelVariable
from fmpy.model_description import Unit as Defined

from axisrig.bench.machine.start_values import set_start_values
from axisrig.bench.plan.assignment import Assignment, parse_assignment
from axisrig.bench.rig.reading.file import PlantTable
from axisrig.kernel.errors import UserError

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

METRE = Defined("m", BaseUnit(m=1, factor=1.0, offset=0.0))
VARIABLES = {
    each.name: each
    for each in (
        ModelVariable("reach", type="Float64", unit="m"),
        ModelVariable("share", type="Float64", unit="1"),
        ModelVariable("count", type="Int32"),
        ModelVariable("gap_mm", type="Float64", unit="m"),
        ModelVariable("rate_s", type="Float64", unit="1"),
    )
}


class Fmu:
    """An instance with these variables; given: what was set, in its order."""

    def __init__(self, name: str) -> None:
        self.given: list[tuple[str, Any]] = []
        self.name, self.variable = name, VARIABLES.__getitem__
        self.description = SimpleNamespace(unitDefinitions=[METRE])

    def set_start(self, name: str, value: Any) -> None:
        self.given.append((name, value))

    def has(self, name: str) -> bool:
        return name in VARIABLES

    def names(self, _causality: str) -> list[str]:
        return [*VARIABLES]


def settings_with(is_settled: bool, **cells: list[str]) -> Any:
    """Settings whose run assigns these cells, by plant."""

    def located(error: UserError, item: Assignment) -> UserError:
        return UserError(f"{item.column}: {error.message}")

    start = {
        name: [(parse_assignment(f"plant:{name}.{cell}"), located) for cell in of_plant]
        for name, of_plant in cells.items()
    }
    return SimpleNamespace(
        is_settled=is_settled, known={}, bare_in_rig={}, bare={}, files=["rig.toml"], start=start
    )


def given(settings: Any, name: str, **start: Any) -> list[tuple[str, Any]]:
    """What a new instance of a plant gets."""
    fmu = Fmu(name)
    roles: Any = SimpleNamespace(slave=fmu, spare_inputs=list)
    set_start_values(settings, name, PlantTable(fmu="p.fmu", start=start), roles)
    return fmu.given


def test_each_plant_gets_its_own_values_in_every_run_those_of_the_run_last() -> None:
    settings = settings_with(True, p=["reach_mm=250", "count=3"], q=["count=0"])
    of_p = [("reach", 0.5), ("share", 0.25), ("reach", 0.25), ("count", 3)]
    of_q = [("reach", 7.0), ("count", 0)]
    for _ in range(2):
        assert given(settings, "p", reach_mm=500, share=0.25) == of_p
        assert given(settings, "q", reach=7) == of_q
        assert given(settings, "r") == []
    assert [*settings.bare_in_rig] == ["plant:q.reach"]
    # Settings that may still change are read anew each time
    loose = settings_with(False, p=["count=3"])
    assert given(loose, "p") == [("count", 3)]
    assert loose.known == {}
    loose.start["p"].append((parse_assignment("plant:p.count=4"), loose.start["p"][0][1]))
    assert given(loose, "p") == [("count", 3), ("count", 4)]


def test_values_that_were_refused_are_refused_in_every_run(tmp_path: Path) -> None:
    """Every one of them is named, whether the rig or the run has it."""
    settings = settings_with(True, p=["count=1.5", "reach_s=2"])
    settings.files = [tmp_path / "rig.toml"]
    settings.files[0].write_text("[plant.p]\nstart = { share_mm = 3 }\n", encoding="utf-8")
    for _ in range(2):
        with pytest.raises(UserError) as refused:
            given(settings, "p", share_mm=3)
        errors = [refused.value, *refused.value.further]
        assert [(error.line, error.message.partition(": ")[0]) for error in errors] == [
            (2, "share_mm"), (None, "plant:p.count"), (None, "plant:p.reach_s"),
        ]  # fmt: skip
    assert settings.known == {}


@pytest.mark.parametrize(
    ("cell", "is_noted"),
    [("reach=2", True), ("reach=-2", True), ("reach=0", False), ("reach_mm=2", False),
     ("reach_m=2", False), ("share=2", False), ("count=2", False)],
)  # fmt: skip
def test_a_column_that_names_no_unit_is_noted_where_it_could_have_had_several(
    cell: str, is_noted: bool
) -> None:
    """0 is the same in each."""
    settings = settings_with(False, p=[cell])
    given(settings, "p")
    assert settings.bare_in_rig == {}
    assert [*settings.bare] == (["plant:p.reach"] if is_noted else [])
    if is_noted:
        unit, columns = settings.bare["plant:p.reach"]
        assert unit == "m"
        assert {"plant:p.reach_mm", "plant:p.reach_um"} <= {*columns}


@pytest.mark.parametrize(
    ("cell", "values", "columns"),
    [
        # The name is that of the variable: 2 counts in m, whatever it looks like
        ("gap_mm=2", [("gap_mm", 2.0)], ["plant:p.gap_mm_m", "plant:p.gap_mm_mm"]),
        ("gap_mm=-0.5", [("gap_mm", -0.5)], ["plant:p.gap_mm_m", "plant:p.gap_mm_mm"]),
        ("gap_mm=0", [("gap_mm", 0.0)], None),
        ("gap_mm_mm=2", [("gap_mm", 0.002)], None),
        ("rate_s=2", [("rate_s", 2.0)], None),  # it has no unit
    ],
)
def test_a_variable_that_ends_in_a_unit_counts_in_its_own_and_is_noted(
    cell: str, values: list[tuple[str, float]], columns: list[str] | None
) -> None:
    """From the rig as from the row, each in its own list."""
    name, _, text = cell.partition("=")
    of_row, of_rig = settings_with(False, p=[cell]), settings_with(False)
    assert given(of_row, "p") == values
    assert given(of_rig, "p", **{name: float(text)}) == values
    for noted, other in ((of_row.bare, of_row.bare_in_rig), (of_rig.bare_in_rig, of_rig.bare)):
        assert other == {}
        assert [*noted] == ([] if columns is None else ["plant:p.gap_mm"])
        for unit, known in noted.values():
            assert unit == "m"
            assert {*(columns or ())} <= {*known}


def test_values_of_rig_and_row_for_one_variable_are_noted_in_both() -> None:
    settings = settings_with(True, p=["reach=3"])
    assert given(settings, "p", reach=2) == [("reach", 2.0), ("reach", 3.0)]
    assert ([*settings.bare_in_rig], [*settings.bare]) == (["plant:p.reach"], ["plant:p.reach"])


@pytest.mark.parametrize(
    ("cell", "value"),
    [
        ("reach_mm=250", ("reach", 0.25)),
        ("share=0.5", ("share", 0.5)),
        ("count=-3", ("count", -3)),
        ("gap_mm=2", ("gap_mm", 2.0)),
        ("gap_mm_mm=2", ("gap_mm", 0.002)),
        ("rate_s=2", ("rate_s", 2.0)),
    ],
)
@pytest.mark.parametrize("of_rig", [True, False])
def test_a_later_run_sets_the_same_variable_to_the_same_value(
    cell: str, value: tuple[str, float], of_rig: bool
) -> None:
    name, _, text = cell.partition("=")
    settings = settings_with(True, **({} if of_rig else {"p": [cell]}))
    start = {name: float(text)} if of_rig else {}
    for _ in range(3):
        found = given(settings, "p", **start)
        assert found == [value]
        assert type(found[0][1]) is type(value[1])
