"""Start values of plants: words of an enumeration, units that an FMU only names, other types."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from fmpy.model_description import BaseUnit, Item, ModelVariable, SimpleType
from fmpy.model_description import Unit as Defined

from axisrig.bench.machine.start_values import set_start_values
from axisrig.bench.plan.assignment import Assignment, parse_assignment
from axisrig.bench.rig.reading.file import PlantTable
from axisrig.kernel.cosim.fmi.fmu import PlantError
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
        ModelVariable("turns", type="Int32", unit="furlong", min="-9", max="9"),
        ModelVariable("dip", type="Float64", unit="1", min="-5", max="-1"),
        ModelVariable("thick", type="Float64", unit="inch", min="0", max="5"),
        ModelVariable("many", type="Int32", max="1000"),
        ModelVariable("length", type="Float64", unit="inch"),
        ModelVariable("name", type="String"),
        ModelVariable("slide_mm", type="Float64", unit="furlong"),
        ModelVariable("lag_ms", type="Int32"),
        ModelVariable("is_on", type="Boolean"),
    )
}
INCH = Defined("inch", BaseUnit(m=1, factor=0.0254, offset=0.0))


class Plant:
    """An FMU with these variables as parameters; `given`: their start values, in its units.

    parameters, inputs: what can be set.
    """

    def __init__(self, variables: dict[str, ModelVariable] = VARIABLES) -> None:
        self.given: dict[str, Any] = {}
        self.name, self.variable = "probe", variables.__getitem__
        self.parameters, self.inputs = [*variables], list[str]()
        self.description = SimpleNamespace(unitDefinitions=[INCH])
        self.set_start: Any = self.given.__setitem__
        self.has = variables.__contains__

    def names(self, _causality: str) -> list[str]:
        return self.parameters

    def take(self, *cells: str, rig: Path = Path("rig.toml"), **start: Any) -> dict[str, Any]:
        """Set what the rig has and what a row assigns; return what the FMU has then."""

        def located(error: UserError, _item: Assignment) -> UserError:
            return error

        settings: Any = SimpleNamespace(
            is_settled=False,
            bare_in_rig={},
            bare={},
            files=[rig],
            start={"p": [(parse_assignment(f"plant:p.{cell}"), located) for cell in cells]},
        )
        roles: Any = SimpleNamespace(slave=self, spare_inputs=lambda: self.inputs)
        set_start_values(settings, "p", PlantTable(fmu="p.fmu", start=start), roles)
        return self.given


def test_an_item_of_an_enumeration_is_the_number_that_its_type_gives_it() -> None:
    found = Plant().take("shape=Disk", "other=Tip", "plain=7")
    assert found == {"shape": 3, "other": 4, "plain": 7}
    assert {type(value) for value in found.values()} == {int}
    assert Plant().take("shape=Ball", shape="Tip") == {"shape": 1}  # that of the row is the later


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


@pytest.mark.parametrize(
    ("cell", "value", "allowed"),
    [
        # Near a name: each with the units that it may have, or with the one that was written
        ("lenght_mm=1", "lenght_mm", "length_mm"),
        ("lenght=1", "lenght", "length_m, length_mm, length_um, length_nm"),
        ("lenght_s=1", "lenght_s", "length_m, length_mm, length_um, length_nm"),
        ("is_onn=1", "is_onn", "is_on"),
        ("twst=1", "twst", "twist"),
        ("length_inch_mm=1", "length_inch_mm", "length_mm"),
        # Not near any: all that can be set
        ("zzzz=1", "zzzz", ", ".join(VARIABLES)),
        ("zzzz_mm=1", "zzzz_mm", ", ".join(VARIABLES)),
        ("lengths=1", "lengths", "length_m, length_mm, length_um, length_nm"),
    ],
)
def test_a_name_that_is_not_there_gets_those_near_it_with_their_units(
    cell: str, value: str, allowed: str
) -> None:
    with pytest.raises(UserError) as refused:
        Plant().take(cell)
    assert refused.value.message == "probe has no such variable"
    assert (refused.value.value, refused.value.allowed) == (value, allowed)


@pytest.mark.parametrize("written", ["inch", "millimetre", "mm_3"])
def test_a_word_behind_a_name_that_is_no_unit_of_it_is_named(written: str) -> None:
    with pytest.raises(UserError) as refused:
        Plant().take(f"length_{written}=1")
    assert refused.value.message == f"{written} is no unit of length"
    assert refused.value.value == f"length_{written}"
    assert refused.value.allowed == "length_m, length_mm, length_um, length_nm"


def test_what_is_there_and_cannot_be_set_says_so_and_an_open_input_can_be_set() -> None:
    plant = Plant()
    plant.parameters = ["twist"]
    for cell in ("wear=1", "length_mm=1"):
        with pytest.raises(UserError) as refused:
            plant.take(cell)
        assert refused.value.message == "probe has no such start value that can be set"
    plant.inputs = ["wear"]
    assert plant.take("wear=2", "twist=1") == {"wear": 2.0, "twist": 1.0}


@pytest.mark.parametrize(
    ("text", "is_on"),
    [("true", True), ("TRUE", True), ("True", True), ("1", True),
     ("false", False), ("FALSE", False), ("False", False), ("0", False)],
)  # fmt: skip
def test_a_flag_is_written_in_four_words_of_either_case(text: str, is_on: bool) -> None:
    found = Plant().take(f"is_on={text}")
    assert found == {"is_on": is_on}
    assert type(found["is_on"]) is bool


@pytest.mark.parametrize("cell", ["is_on=yes", "is_on=2", "is_on=-1", "is_on_mm=1", "is_on=1.0"])
def test_what_is_no_flag_is_refused(cell: str) -> None:
    with pytest.raises(UserError) as refused:
        Plant().take(cell)
    assert refused.value.message == "is_on of probe is true or false"
    assert (refused.value.value, refused.value.allowed) == (cell.partition("=")[2], "true, false")


@pytest.mark.parametrize(
    ("cell", "allowed"),
    [
        ("shape=Disc", "Disk"),
        ("shape=ball", "Ball"),
        ("shape=zzzz", "Ball, Disk, Tip"),
        ("plain=Disk", "whole numbers"),
    ],
)
def test_items_near_a_word_are_named_or_all(cell: str, allowed: str) -> None:
    with pytest.raises(UserError) as refused:
        Plant().take(cell)
    name, _, value = cell.partition("=")
    assert refused.value.message == f"{name} of probe has no such item"
    assert (refused.value.value, refused.value.allowed) == (value, allowed)
    assert ("did you mean" in str(refused.value)) == (allowed in ("Disk", "Ball"))


def test_an_item_may_be_given_by_its_number_also_below_0() -> None:
    found = Plant().take("shape=4", "plain=-2")
    assert found == {"shape": 4, "plain": -2}
    assert {type(value) for value in found.values()} == {int}


@pytest.mark.parametrize(
    ("cell", "value"),
    [("wear=-2", -2.0), ("wear=40", 40.0), ("turns=9", 9), ("turns=-9", -9), ("dip=-1", -1.0),
     ("dip=-5", -5.0), ("thick_mm=0", 0.0), ("thick_mm=127", 5.0), ("many=1e3", 1000)],
)  # fmt: skip
def test_the_ends_of_a_range_are_inside_it(cell: str, value: float) -> None:
    """127 mm are 5 inches; limits are in the unit of the FMU."""
    (found,) = Plant().take(cell).values()
    assert found == pytest.approx(value, abs=1e-12)
    assert type(found) is type(value)


@pytest.mark.parametrize(
    ("cell", "allowed"),
    [
        ("turns=10", "-9 .. 9 furlong"),
        ("turns=-10", "-9 .. 9 furlong"),
        ("dip=0", "-5 .. -1"),
        ("dip=-5.001", "-5 .. -1"),
        ("dip=3", "-5 .. -1"),
        ("thick_mm=-0.1", "0 .. 5 inch"),
        ("thick_mm=128", "0 .. 5 inch"),
        ("many=1001", "-inf .. 1000"),
    ],
)
def test_a_value_out_of_range_is_named_as_it_was_written(cell: str, allowed: str) -> None:
    with pytest.raises(UserError) as refused:
        Plant().take(cell)
    name, _, value = cell.partition("=")
    assert refused.value.message == f"{name.removesuffix('_mm')} of probe is out of range"
    assert (refused.value.value, refused.value.allowed) == (value, allowed)


@pytest.mark.parametrize(
    ("cell", "message", "value", "allowed"),
    [
        ("wear_mm=1", "wear of probe is in furlong, which the FMU does not define", "mm",
         "a bare number in that unit"),
        ("many_mm=1", "many of probe has another unit", "mm", "a bare number"),
        ("length_s=1", "length of probe has another unit", "s", "a unit of inch"),
        ("length_m_s=1", "length of probe has another unit", "m_s", "a unit of inch"),
        ("length_kg=1", "length of probe has another unit", "kg", "a unit of inch"),
        ("many=1.5", "many of probe is a whole number", "1.5", None),
        ("many=-0.25", "many of probe is a whole number", "-0.25", None),
        ("length=3", "length of probe is in inch; a number without unit would be a guess", "3",
         "length_m, length_mm, length_um, length_nm"),
        ("length=0", "length of probe is in inch; a number without unit would be a guess", "0",
         "length_m, length_mm, length_um, length_nm"),
    ],
)  # fmt: skip
def test_a_unit_that_does_not_fit_has_its_reason_and_what_does(
    cell: str, message: str, value: str, allowed: str | None
) -> None:
    plant = Plant()
    with pytest.raises(UserError) as refused:
        plant.take(cell)
    assert refused.value.message == message
    assert (refused.value.value, refused.value.allowed) == (value, allowed)
    assert plant.given == {}


def test_a_share_may_be_in_percent() -> None:
    assert Plant().take("dip_percent=-250") == {"dip": pytest.approx(-2.5)}


def test_of_two_variables_the_one_of_the_whole_name_is_meant() -> None:
    """`length` has a length in mm as `length_mm`, unless a variable has that very name."""
    variables = {**VARIABLES, "length_mm": ModelVariable("length_mm", type="Float64")}
    plant = Plant(variables)
    assert plant.take("length_mm=3", "length_um=25400") == {
        "length_mm": 3.0, "length": pytest.approx(1.0)
    }  # fmt: skip


@pytest.mark.parametrize(("cell", "name"), [("slide_mm=3", "slide_mm"), ("length_mm=4", "length")])
def test_what_an_fmu_refuses_is_named_as_the_variable_with_the_value_of_the_cell(
    cell: str, name: str
) -> None:
    plant = Plant()

    def refuse(*_: Any) -> None:
        raise PlantError("probe", 0, "it is read only")

    plant.set_start = refuse
    with pytest.raises(UserError) as refused:
        plant.take(cell)
    assert refused.value.message == f"probe refuses {name}: it is read only"
    assert refused.value.value == cell.partition("=")[2]


def test_a_mistake_of_the_rig_keeps_its_value_and_what_is_allowed(tmp_path: Path) -> None:
    rig = tmp_path / "rig.toml"
    rig.write_text("[plant.p]\nfmu = 'p.fmu'\nstart = { many_mm = 3 }\n", encoding="utf-8")
    for start, value, allowed in (
        ({"many_mm": 3}, "mm", "a bare number"),
        ({"many": True}, "true", None),  # as the rig has it
        ({"is_on": "Yes"}, "Yes", "true, false"),
        ({"shape": "Disc"}, "Disc", "Disk"),
        ({"turns": 10}, "10", "-9 .. 9 furlong"),
    ):
        with pytest.raises(UserError) as refused:
            Plant().take(rig=rig, **start)
        (name,) = start
        assert refused.value.message.startswith(f"{name}: ")
        assert (refused.value.value, refused.value.allowed) == (value, allowed)
        assert (refused.value.file, refused.value.line) == (str(rig), 3)


def test_a_mistake_of_the_rig_says_how_to_write_it(tmp_path: Path) -> None:
    rig = tmp_path / "rig.toml"
    rig.write_text("[plant.p]\nfmu = 'p.fmu'\nstart = { wear = '1,5' }\n", encoding="utf-8")
    with pytest.raises(UserError) as refused:
        Plant().take(rig=rig, wear="1,5", dip="-2,5")
    errors = [refused.value, *refused.value.further]
    assert [(error.value, error.hint) for error in errors] == [
        ("1,5", "a decimal point, not a comma: 1.5"),
        ("-2,5", "a decimal point, not a comma: -2.5"),
    ]
