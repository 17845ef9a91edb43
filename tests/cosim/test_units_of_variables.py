"""The unit of a variable: what its FMU says, what a rig writes, and where the two disagree."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.units import Unit, find_unit, unit_name, unit_of
from axisrig.kernel.errors import UserError

BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


def defined(name: str, factor: float = 1.0, offset: float = 0.0, **exponents: int) -> Any:
    """A unit as an FMU defines it; what it leaves out is 0."""
    base = SimpleNamespace(**dict.fromkeys(BASES, 0) | exponents, factor=factor, offset=offset)
    return SimpleNamespace(name=name, baseUnit=base)


def described(*units: Any) -> Any:
    return SimpleNamespace(unitDefinitions=list(units))


def variable(unit: str | None = None, of_type: str | None = None) -> Any:
    declared = None if of_type is None else SimpleNamespace(unit=of_type)
    return SimpleNamespace(name="table.s", unit=unit, declaredType=declared)


LENGTHS = described(
    defined("mm", 1e-3, m=1), defined("length", 2.0, m=1), defined("degF", 5 / 9, 255.37, K=1),
    defined("shifted", 1e-3, 0.5, m=1), defined("thousandth", 1e-3, m=1),
    defined("area", 1e-3, m=2), SimpleNamespace(name="m", baseUnit=None),
)  # fmt: skip


@pytest.mark.parametrize(
    ("unit", "of_type", "name"),
    [("mm", None, "mm"), (None, "um", "um"), ("mm", "um", "mm"), (None, None, None),
     ("", "um", "um"), ("", None, None), (None, "", None)],
)  # fmt: skip
def test_a_variable_has_its_own_unit_else_that_of_its_type(
    unit: str | None, of_type: str | None, name: str | None
) -> None:
    assert unit_name(variable(unit, of_type)) == name


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("mm", Unit("mm", (0, 1, 0, 0, 0, 0, 0, 0), 1e-3)),
        ("length", Unit("length", (0, 1, 0, 0, 0, 0, 0, 0), 2.0)),
        ("degF", Unit("degF", (0, 0, 0, 0, 1, 0, 0, 0), 5 / 9, 255.37)),
        # named without its base units, or not at all: as the table of known units has it
        ("m", Unit("m", (0, 1, 0, 0, 0, 0, 0, 0))),
        ("um", Unit("um", (0, 1, 0, 0, 0, 0, 0, 0), 1e-6)),
        ("parsec", None),
    ],
)
def test_the_definition_of_the_fmu_comes_before_the_table(name: str, found: Unit | None) -> None:
    assert find_unit(LENGTHS, name) == found


def test_a_unit_of_the_fmu_may_mean_something_else_than_in_the_table() -> None:
    of_fmu = described(defined("um", 1e-3, m=1))
    unit = unit_of(of_fmu, variable("um"))
    assert unit is not None
    assert unit.to_si(3.0) == pytest.approx(0.003)


@pytest.mark.parametrize("place", range(len(BASES)))
def test_each_base_unit_has_its_place(place: int) -> None:
    unit = find_unit(described(defined("u", **{BASES[place]: -2})), "u")
    assert unit is not None
    assert unit.exponents == tuple(-2 * (n == place) for n in range(len(BASES)))


@pytest.mark.parametrize(
    ("own", "written", "name"),
    [
        (None, None, None), ("mm", None, "mm"), (None, "mm", "mm"), ("mm", "mm", "mm"),
        ("mm", "thousandth", "thousandth"),  # two names of one unit
        ("parsec", "mm", "mm"),  # nobody defines that of the FMU: the rig says what it is
    ],
)  # fmt: skip
def test_a_unit_is_that_of_the_fmu_or_of_the_rig(
    own: str | None, written: str | None, name: str | None
) -> None:
    unit = unit_of(LENGTHS, variable(own), written)
    assert (None if unit is None else unit.name) == name


@pytest.mark.parametrize("written", ["length", "shifted", "area", "degF"])
def test_a_rig_that_contradicts_its_fmu_is_refused(written: str) -> None:
    """In the factor alone, the offset alone, the base units alone, or in all of them."""
    with pytest.raises(UserError) as caught:
        unit_of(LENGTHS, variable("mm"), written)
    error = caught.value
    assert error.message == "table.s: the FMU says mm"
    assert (error.value, error.allowed) == (written, "mm, or no unit")


@pytest.mark.parametrize(
    ("own", "written", "message", "value"),
    [
        ("parsec", None, "table.s: the unit is not given", "parsec"),
        (None, "ell", "table.s: unknown unit", "ell"),
        ("mm", "ell", "table.s: unknown unit", "ell"),
        ("parsec", "ell", "table.s: unknown unit", "ell"),
        ("parsec", "parsec", "table.s: the unit is not given", "parsec"),
    ],
)
def test_a_unit_that_nobody_defines_is_refused(
    own: str | None, written: str | None, message: str, value: str
) -> None:
    """Only where the rig writes none does the message say how to write one."""
    with pytest.raises(UserError) as caught:
        unit_of(LENGTHS, variable(own), written)
    error = caught.value
    assert (error.message, error.value) == (message, value)
    hint = 'say it in the map: { variable = "...", unit = "..." }'
    assert error.hint == (None if written else hint)


@pytest.mark.parametrize(
    ("unit", "value", "si"),
    [(Unit("mm", (), 1e-3), 250.0, 0.25), (Unit("degF", (), 0.5, 255.0), 90.0, 300.0),
     (Unit("turned", (), -2.0, 1.0), 3.0, -5.0)],
)  # fmt: skip
def test_a_value_goes_to_si_and_back(unit: Unit, value: float, si: float) -> None:
    assert (unit.to_si(value), unit.from_si(si)) == pytest.approx((si, value))
    assert not unit.is_si


@pytest.mark.parametrize(
    ("factor", "offset", "is_si"),
    [(1.0, 0.0, True), (1.0, 273.15, False), (1e-3, 0.0, False), (-1.0, 0.0, False)],
)
def test_a_number_in_si_has_neither_factor_nor_offset(
    factor: float, offset: float, is_si: bool
) -> None:
    assert Unit("u", (), factor, offset).is_si is is_si
