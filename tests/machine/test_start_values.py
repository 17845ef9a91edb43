"""Start values of plants: words of an enumeration, units that an FMU only names, other types."""

from types import SimpleNamespace
from typing import Any

import pytest
from fmpy.model_description import BaseUnit, Item, ModelVariable, SimpleType
from fmpy.model_description import Unit as Defined

from axisrig.bench.machine.start_values import set_start_values
from axisrig.bench.plan.assignment import Assignment, parse_assignment
from axisrig.bench.rig.reading.file import PlantTable
from axisrig.kernel.errors import UserError

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

SHAPES = SimpleType(
    "Shape", type="Enumeration", items=[Item("Ball", "1"), Item("Disk", "3"), Item("Tip", "4")]
)
VARIABLES = {
    each.name: each
    for each in (
        ModelVariable("shape", type="Enumeration", declaredType=SHAPES),
        ModelVariable("other", type="Enumeration", declaredType=SHAPES),
        ModelVariable("plain", type="Enumeration"),
        ModelVariable("wear", type="Float64", unit="furlong", min="-2", max="40"),
        ModelVariable("twist", type="Float64", unit="furlong"),
        ModelVariable("turns", type="Int32", unit="furlong"),
        ModelVariable("length", type="Float64", unit="inch"),
        ModelVariable("name", type="String"),
        ModelVariable("slide_mm", type="Float64", unit="furlong"),
        ModelVariable("lag_ms", type="Int32"),
        ModelVariable("is_on", type="Boolean"),
    )
}
INCH = Defined("inch", BaseUnit(m=1, factor=0.0254, offset=0.0))


class Plant:
    """An FMU with these variables as parameters; `given`: their start values, in its units."""

    def __init__(self) -> None:
        self.given: dict[str, Any] = {}
        self.name, self.variable = "probe", VARIABLES.__getitem__
        self.description = SimpleNamespace(unitDefinitions=[INCH])
        self.set_start = self.given.__setitem__

    def has(self, name: str) -> bool:
        return name in VARIABLES

    def names(self, _causality: str) -> list[str]:
        return [*VARIABLES]

    def take(self, *cells: str, **start: Any) -> dict[str, Any]:
        """Set what the rig has and what a row assigns; return what the FMU has then."""

        def located(error: UserError, _item: Assignment) -> UserError:
            return error

        settings: Any = SimpleNamespace(
            is_settled=False,
            bare_in_rig={},
            bare={},
            files=["rig.toml"],
            start={"p": [(parse_assignment(f"plant:p.{cell}"), located) for cell in cells]},
        )
        roles: Any = SimpleNamespace(slave=self, spare_inputs=list)
        set_start_values(settings, "p", PlantTable(fmu="p.fmu", start=start), roles)
        return self.given


def test_an_item_of_an_enumeration_is_the_number_that_its_type_gives_it() -> None:
    found = Plant().take("shape=Disk", "other=Tip", "plain=7")
    assert found == {"shape": 3, "other": 4, "plain": 7}
    assert {type(value) for value in found.values()} == {int}
    assert Plant().take("shape=Ball", shape="Tip") == {"shape": 1}  # that of the row is the later


@pytest.mark.parametrize(
    ("cell", "allowed"),
    [("shape=Disc", "Disk"), ("shape=ball", "Ball"), ("plain=Disk", "whole numbers")],
)
def test_an_item_that_a_type_does_not_have_is_refused(cell: str, allowed: str) -> None:
    with pytest.raises(UserError) as refused:
        Plant().take(cell)
    text = str(refused.value)
    assert "has no such item" in text
    assert cell.partition("=")[2] in text
    assert allowed in text


def test_a_number_for_a_unit_that_is_only_named_counts_as_it_is_written() -> None:
    """One that is defined is converted: 50.8 mm are 2 inches of 25.4 mm."""
    found = Plant().take("wear=-1.5", "twist=2e3", "turns=-3", "length_mm=50.8")
    assert found == {"wear": -1.5, "twist": 2000.0, "turns": -3, "length": pytest.approx(2.0)}


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        ("wear_mm=1", "wear of probe is in furlong, which the FMU does not define"),
        ("wear=40.5", "-2 .. 40 furlong"),
        ("wear=-2.01", "-2 .. 40 furlong"),
        ("turns=2.5", "turns of probe is a whole number"),
        ("length=3", "a number without unit would be a guess"),
    ],
)
def test_what_a_unit_does_not_fit_is_refused(cell: str, words: str) -> None:
    plant = Plant()
    with pytest.raises(UserError) as refused:
        plant.take(cell)
    assert words in str(refused.value)
    assert plant.given == {}


def test_words_and_flags_are_handed_over_as_such() -> None:
    assert Plant().take("name=M8", "is_on=false", is_on=True) == {"name": "M8", "is_on": False}


def test_a_name_that_itself_ends_in_a_unit_is_the_variable_of_that_name() -> None:
    """Its value is in the unit of the FMU; beside it the one whose name ends before the unit."""
    found = Plant().take("slide_mm=3", "lag_ms=-4", "length_mm=25.4", slide_mm=9.0)
    assert found == {"slide_mm": 3.0, "lag_ms": -4, "length": pytest.approx(1.0)}
