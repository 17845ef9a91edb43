"""Roles of variables as a description alone has them: units of torque, whole numbers, namesakes."""

import math
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi import roles
from axisrig.kernel.cosim.fmi.roles import Bound, ConvertedExchange, Source, map_roles
from axisrig.kernel.errors import UserError

BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
UNITS = {
    # N.mm: a thousandth of kg m2/s2, as FMUs define it
    "N.mm": {"kg": 1, "m": 2, "s": -2, "factor": 1e-3, "offset": 0.0},
    "rad2": {"rad": 2, "factor": 1.0, "offset": 0.0},
    "um": {"m": 1, "factor": 1e-6, "offset": 0.0},
}
Variables = Mapping[str, tuple[str, str, str | None]]

POSITION = {"demand": ("input", "Float64", "m"), "position": ("output", "Float64", "m")}


def slave_of(variables: Variables) -> Any:
    """An instance with these variables: causality, type and unit by name."""
    found = {
        name: SimpleNamespace(
            name=name, causality=causality, type=type_, unit=unit, declaredType=None, shape=None
        )
        for name, (causality, type_, unit) in variables.items()
    }
    units = [
        SimpleNamespace(name=name, baseUnit=SimpleNamespace(**dict.fromkeys(BASES, 0) | content))
        for name, content in UNITS.items()
    ]
    return SimpleNamespace(
        description=SimpleNamespace(unitDefinitions=units),
        path=Path("plant.fmu"),
        TYPES=("Float64", "Float32", "Int32", "Boolean"),
        variable=found.__getitem__,
        has=found.__contains__,
        names=lambda causality: [name for name, v in found.items() if v.causality == causality],
    )


@pytest.mark.parametrize(("unit", "factor"), [("N.m", 1.0), ("N.mm", 1e-3)])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_torque_is_a_force_along_the_travel_by_its_lead(
    unit: str, factor: float, sign: int
) -> None:
    """Work of one turn: 2 pi M = F lead."""
    slave = slave_of({**POSITION, "motor.M": ("output", "Float64", unit)})
    found = map_roles(slave, "axis", {"force": Source("motor.M", sign=sign, lead_m=0.005)})
    torque = 250.0
    wanted_n = sign * 2 * math.pi * torque * factor / 0.005
    assert found.bound["force"].to_si(torque) == pytest.approx(wanted_n, rel=1e-14)
    assert found.bound["force"].from_si(wanted_n) == pytest.approx(torque, rel=1e-14)


@pytest.mark.parametrize("unit", ["rad2", "um", "1"])
def test_a_lead_is_for_rotations(unit: str) -> None:
    slave = slave_of({**POSITION, "way": ("output", "Float64", unit)})
    with pytest.raises(UserError, match=f"way is in {unit}; lead_mm is for rotations") as caught:
        map_roles(slave, "axis", {"motor_position": Source("way", lead_m=0.01)})
    assert caught.value.value == unit


@pytest.mark.parametrize(
    ("bound", "is_plain"),
    [
        (Bound("v"), True),
        (Bound("v", factor=1e-3), False),
        (Bound("v", factor=-1.0), False),
        (Bound("v", offset=0.5), False),
        (Bound("v", threshold=0.5), False),
    ],
)
def test_only_a_value_without_conversion_is_plain(bound: Bound, is_plain: bool) -> None:
    assert bound.is_plain is is_plain


def test_a_whole_number_gets_the_nearest_value(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.00029 m in um is 289.99999999999994 in double precision."""
    written: list[tuple[list[str], list[float]]] = []

    class Written:
        def __init__(self, _slave: Any, names: list[str]) -> None:
            self.names, self.values = names, [0.0] * len(names)

        def write(self) -> None:
            written.append((self.names, list(self.values)))

    monkeypatch.setattr(roles, "Exchange", Written)
    slave = slave_of({"ticks": ("input", "Int32", "um"), "real": ("input", "Float64", "um")})
    exchange = ConvertedExchange(slave, [Bound("ticks", 1e-6), Bound("real", 1e-6)])
    exchange.values[:] = [0.00029, 0.00029]
    exchange.write()
    assert written == [(["ticks"], [290]), (["real"], [0.00029 / 1e-6])]


RAMP = ("reference_position", "reference_velocity", "reference_time", "reference_end")


@pytest.mark.parametrize("missing", RAMP)
def test_only_what_is_missing_of_a_group_is_asked_for(missing: str) -> None:
    units = dict(zip(RAMP, ("m", "m/s", "s", "s"), strict=True))
    variables: dict[str, tuple[str, str, str | None]] = {"position": POSITION["position"]}
    variables |= {n: ("input", "Float64", unit) for n, unit in units.items() if n != missing}
    with pytest.raises(UserError) as caught:
        map_roles(slave_of(variables), "axis", {})
    assert caught.value.message == (
        f"plant.fmu lacks what a plant of the kind axis needs: {missing} or demand"
    )


@pytest.mark.parametrize("name", ["force", "stop_force", "stop_face", "force_limit"])
def test_a_namesake_in_another_unit_is_noted_and_one_that_is_mapped_is_refused(name: str) -> None:
    causality = "input" if name == "force_limit" else "output"
    slave = slave_of({**POSITION, name: (causality, "Float64", "s")})
    found = map_roles(slave, "axis", {})
    assert name not in found.bound
    (note,) = [note for note in found.notes if note.startswith(f"{name} of the FMU is not taken")]
    assert f"{name} is in s (s)" in note
    with pytest.raises(UserError, match=f"{name} is in s"):
        map_roles(slave, "axis", {name: Source(name)})


LIMITS = ("force_limit_negative", "force_limit_positive", "force_limit")


def test_a_limit_of_both_directions_gives_way_to_those_of_each() -> None:
    """Where the rig maps it by name it stays."""
    limits: Variables = dict.fromkeys(LIMITS, ("input", "Float64", "N"))
    slave = slave_of({**POSITION, **limits})
    assert set(map_roles(slave, "axis", {}).bound) == {*POSITION, *LIMITS[:2]}
    mapped = map_roles(slave, "axis", {"force_limit": Source("force_limit")})
    assert set(mapped.bound) == {*POSITION, *LIMITS}
    alone = slave_of({**POSITION, "force_limit": ("input", "Float64", "N")})
    assert set(map_roles(alone, "axis", {}).bound) == {*POSITION, "force_limit"}


def test_inputs_that_nothing_is_wired_to_are_in_the_order_of_the_description() -> None:
    more: Variables = {
        "z_spare": ("input", "Float64", "m"), "a_spare": ("input", "Boolean", None),
        "kv": ("parameter", "Float64", "1/s"), "p": ("parameter", "Float64", "m"),
    }  # fmt: skip
    found = map_roles(slave_of({**more, **POSITION}), "axis", {})
    assert found.spare_inputs() == ["z_spare", "a_spare"]
