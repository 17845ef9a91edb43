"""Variables of foreign FMUs as roles: units, signs, thresholds, and what is refused."""

import csv
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.plan import assignment
from axisrig.kernel.cosim.fmi import roles
from axisrig.kernel.cosim.fmi.fmu import Exchange, FmuSlave, load_fmu
from axisrig.kernel.cosim.fmi.role_table import role_table
from axisrig.kernel.cosim.fmi.roles import Bound, Source, guess_kind, map_roles
from axisrig.kernel.cosim.fmi.units import Unit, known_units, unit_of
from axisrig.kernel.errors import UserError

AXIS = {"demand": Source("control.s_set"), "position": Source("table.s")}


@pytest.fixture
def table(fmu: Callable[..., Path]) -> Iterator[FmuSlave]:
    """The feed table: mm, rad and turns per minute."""
    slave = load_fmu(fmu("table"), "table")
    yield slave
    slave.close()


@pytest.fixture
def switch(fmu: Callable[..., Path]) -> Iterator[FmuSlave]:
    """The switch, whose numbers have no unit."""
    slave = load_fmu(fmu("switch"), "switch")
    yield slave
    slave.close()


# ---- units


def test_values_are_handed_over_in_si(table: FmuSlave) -> None:
    roles = map_roles(table, "axis", AXIS)
    demand = roles.exchange(["demand"])
    demand.values[0] = 0.13
    demand.write()
    assert table.get("control.s_set") == pytest.approx(130.0, abs=1e-12)
    table.set_start("table.s_start", -7.0)
    table.initialize(0)
    position = roles.exchange(["position"])
    position.read()
    assert position.values[0] == pytest.approx(-0.007, abs=1e-17)


def test_rotation_stands_for_a_travel_by_its_lead(table: FmuSlave) -> None:
    """A quarter turn of a screw of 10 mm moves the table by 2.5 mm; 60 turns/min by 10 mm/s."""
    sources = {
        **AXIS,
        "motor_position": Source("motor.phi", lead_m=0.010),
        "motor_velocity": Source("motor.n", lead_m=0.010, sign=-1),
    }
    roles = map_roles(table, "axis", sources)
    table.set_start("table.s_start", 2.5)
    table.set_start("control.s_set", 2.75)  # 40/s times 0.25 mm is 10 mm/s
    table.initialize(0)
    motor = roles.exchange(["motor_position", "motor_velocity"])
    motor.read()
    assert table.get("motor.phi") == pytest.approx(math.pi / 2)
    assert list(motor.values) == pytest.approx([0.0025, -0.010])


FAHRENHEIT = (5 / 9, 459.67 * 5 / 9)


@pytest.mark.parametrize(
    ("factor", "offset", "value", "si"),
    [
        (1.0, 0.0, -3.0, -3.0), (1e-3, 0.0, 250.0, 0.25), (1.0, 273.15, -40.0, 233.15),
        (*FAHRENHEIT, -40.0, 233.15), (*FAHRENHEIT, 212.0, 373.15),
        (-1e-3, 0.5, 100.0, 0.4),
    ],
)  # fmt: skip
def test_a_value_has_its_factor_first_and_its_offset_then(
    factor: float, offset: float, value: float, si: float
) -> None:
    """FMI 3.0, 2.4.3: base unit = factor * unit + offset; and back again."""
    for known in (Unit("u", (0,) * 8, factor, offset), Bound("v", factor, offset)):
        assert known.to_si(value) == pytest.approx(si, abs=1e-12)
        assert known.from_si(si) == pytest.approx(value, abs=1e-9)


@pytest.mark.parametrize("factor", [1.0, -1.0])
def test_an_inverted_level_is_inverted_both_ways(factor: float) -> None:
    """Above the threshold is high, at it is low; with the sign -1 the other way round."""
    level = Bound("v", factor, 0.0, 2.5)
    high = factor > 0.0
    assert [level.to_si(value) for value in (2.5, 2.500001, -7.0, 9.0)] == [
        not high, high, not high, high,
    ]  # fmt: skip
    assert (level.from_si(1.0), level.from_si(0.0)) == (float(high), float(not high))
    assert not level.is_plain


@pytest.mark.parametrize(
    ("sign", "lead_m", "exponents", "found"),
    [
        (1, None, "m", 0.6), (-1, None, "m", -0.6),
        (1, 0.01, "rad", 0.6 * 0.01 / (2 * math.pi)), (-1, 0.01, "rad", -0.003 / math.pi),
    ],
)  # fmt: skip
def test_sign_and_lead_are_of_the_whole_value(
    sign: int, lead_m: float | None, exponents: str, found: float
) -> None:
    """A unit that counts in thousandths from a mark at 0.5: 100 of it are 0.6."""
    base = SimpleNamespace(
        **dict.fromkeys(("kg", "m", "s", "A", "K", "mol", "cd", "rad"), 0)
        | {exponents: 1, "factor": 1e-3, "offset": 0.5}
    )
    variable: Any = SimpleNamespace(
        name="v", unit="tick", declaredType=None, causality="output", type="Float64", shape=None
    )
    slave: Any = SimpleNamespace(
        description=SimpleNamespace(unitDefinitions=[SimpleNamespace(name="tick", baseUnit=base)]),
        variable=lambda _name: variable, TYPES=("Float64",),
    )  # fmt: skip
    role = next(role for role in role_table() if role.role == "position")
    bound = roles.bind(slave, "position", role, Source("v", sign=sign, lead_m=lead_m))
    assert bound.to_si(100.0) == pytest.approx(found, rel=1e-12)


def test_offset_of_a_unit_counts_and_its_display_unit_does_not(
    fmu: Callable[..., Path],
) -> None:
    slave = load_fmu(fmu(), "odd")
    celsius = unit_of(slave.description, slave.variable("temperature"))
    assert celsius is not None
    assert celsius.to_si(20.0) == 293.15
    assert celsius.from_si(293.15) == 20.0
    length = unit_of(slave.description, slave.variable("limit"))
    assert length is not None
    assert length.to_si(1.0) == 1e-3
    slave.close()


@pytest.mark.parametrize(
    ("source", "text"),
    [
        (
            Source("motor.phi"),
            r"motor.phi is in rad \(rad\), position needs a unit of m; .*lead",
        ),
        (Source("motor.n"), r"motor.n is in turns/min \(s-1.rad\), position needs a unit of m"),
        (Source("table.s", unit="um"), r"the FMU says mm; found 'um'; allowed: mm, or no unit"),
        (Source("table.s", unit="ell"), "table.s: unknown unit; found 'ell'"),
        (Source("table.s", lead_m=0.01), "is in mm; lead_mm is for rotations"),
        (Source("tabel.s"), r"no such variable; found 'tabel.s'; did you mean: table.s"),
    ],
)
def test_what_does_not_fit_is_refused(table: FmuSlave, source: Source, text: str) -> None:
    with pytest.raises(UserError, match=text):
        map_roles(table, "axis", {**AXIS, "position": source})


def test_unit_that_the_fmu_names_but_does_not_define_is_refused(fmu: Callable[..., Path]) -> None:
    slave = load_fmu(fmu(), "odd")
    with pytest.raises(UserError, match="the unit is not given; found 'parsec'"):
        unit_of(slave.description, slave.variable("far"))
    slave.close()


def test_number_without_unit_needs_one(switch: FmuSlave) -> None:
    sources = {"z_position": Source("tip.depth"), "signal": Source("level")}
    with pytest.raises(UserError, match=r'has no unit.*tip.depth", unit = "m" }'):
        map_roles(switch, "probe", sources, ["z"])


def test_same_unit_twice_is_no_contradiction(table: FmuSlave) -> None:
    map_roles(table, "axis", {**AXIS, "position": Source("table.s", unit="mm")})


@pytest.mark.parametrize(
    ("types", "plain", "is_direct"),
    [
        (["Float64", "Float64"], True, True),
        (["Real", "Real"], True, True),
        (["Float32", "Float32"], True, False),  # four bytes each: no array of doubles is theirs
        (["Float64", "Float32"], True, False),
        (["Float64", "Int32"], True, False),
        (["Float64", "Float64"], False, False),  # another unit
    ],
)
def test_only_doubles_in_si_are_exchanged_as_they_are(
    monkeypatch: pytest.MonkeyPatch, types: list[str], plain: bool, is_direct: bool
) -> None:
    monkeypatch.setattr(roles, "Exchange", lambda _slave, names: ("direct", names))
    monkeypatch.setattr(roles, "ConvertedExchange", lambda _slave, bound: ("converted", bound))
    names = [f"v{number}" for number, _ in enumerate(types)]
    of_slave = {n: SimpleNamespace(type=t) for n, t in zip(names, types, strict=True)}
    bound = {n: SimpleNamespace(variable=n, is_plain=plain or n != "v1") for n in names}
    made: Any = SimpleNamespace(slave=SimpleNamespace(variable=of_slave.get), bound=bound)
    kind, what = roles.Roles.exchange(made, names)  # type: ignore[misc]
    assert kind == ("direct" if is_direct else "converted")
    assert what == (names if is_direct else [bound[n] for n in names])


# ---- levels


@pytest.mark.parametrize(
    ("source", "open_level"),
    [
        (Source("level"), False),
        (Source("level", sign=-1), True),
        (Source("contact_v", threshold=12.0), False),
        (Source("contact_v", threshold=12.0, sign=-1), True),
    ],
)
def test_level_of_a_boolean_or_of_a_number_above_a_threshold(
    switch: FmuSlave, source: Source, open_level: bool
) -> None:
    sources = {"z_position": Source("tip.depth", unit="mm", sign=-1), "signal": source}
    roles = map_roles(switch, "probe", sources, ["z"])
    position, signal = roles.exchange(["z_position"]), roles.exchange(["signal"])
    switch.initialize(0)
    for height_m, is_closed in ((0.1005, False), (0.0995, True)):  # trip at depth -100 mm
        position.values[0] = height_m
        position.write()
        switch.step_to(switch.time_ns + 1000)
        signal.read()
        assert bool(signal.values[0]) is (is_closed is not open_level)


# ---- which roles


def test_missing_roles_are_noted_with_what_happens_without(table: FmuSlave) -> None:
    roles = map_roles(table, "axis", AXIS)
    lacking = {note.partition(":")[0]: note.partition(": ")[2] for note in roles.notes}
    assert set(lacking) == {
        "no reference_position, reference_velocity, reference_time, reference_end",
        *(f"no {r}" for r in ("enabled", "velocity", "motor_position", "motor_velocity")),
        *(f"no {r}" for r in ("demand_position", "kv", "force")),
        "no control, reference_acceleration, reference_force",
        "no force_limit_negative, force_limit_positive",
    }
    assert lacking["no velocity"] == "numeric derivative of position"


def test_missing_necessary_roles_are_refused(table: FmuSlave) -> None:
    with pytest.raises(UserError, match=r"lacks what a plant of the kind axis .*position"):
        map_roles(table, "axis", {"demand": Source("control.s_set")})
    with pytest.raises(UserError, match=r"reference_end or demand"):
        map_roles(table, "axis", {"position": Source("table.s")})


def test_unknown_role_gets_the_nearest_ones(table: FmuSlave) -> None:
    with pytest.raises(UserError, match=r"no such role; found 'posision'; did you mean: position"):
        map_roles(table, "axis", {**AXIS, "posision": Source("table.s")})


def test_inputs_cannot_be_played_by_outputs(table: FmuSlave) -> None:
    with pytest.raises(UserError, match=r"demand needs an input; table.s has the causality output"):
        map_roles(table, "axis", {**AXIS, "demand": Source("table.s")})


def test_the_truth_is_never_read_from_an_input(table: FmuSlave) -> None:
    with pytest.raises(UserError, match=r"position needs an output; control.s_set has"):
        map_roles(table, "axis", {**AXIS, "position": Source("control.s_set")})


def test_an_input_has_one_writer(table: FmuSlave) -> None:
    enabled = Source("control.s_set", threshold=0.5)
    with pytest.raises(UserError, match="demand and enabled would write the same input"):
        map_roles(table, "axis", {**AXIS, "enabled": enabled})


def test_kind_follows_from_the_roles(table: FmuSlave, switch: FmuSlave) -> None:
    assert guess_kind(table, AXIS) == "axis"
    assert guess_kind(table, {"position": Source("table.s")}) == "axis"
    assert guess_kind(table, {}) is None
    sources = {"z_position": Source("tip.depth", unit="mm"), "signal": Source("level")}
    assert guess_kind(switch, sources) == "probe"


def test_inputs_that_nothing_is_wired_to_are_known(table: FmuSlave) -> None:
    assert map_roles(table, "axis", AXIS).spare_inputs() == []


# ---- tables


def test_units_of_roles_and_of_start_values_are_known() -> None:
    roles = {role.unit for role in role_table() if role.unit}
    path = Path(assignment.__file__).with_name("units.csv")
    suffixes = {row["si"] for row in csv.DictReader(path.read_text("utf-8").splitlines())}
    assert roles | suffixes <= set(known_units())


def test_mixed_types_are_one_exchange(switch: FmuSlave) -> None:
    """A Boolean and numbers together; the plain exchange of one type stays the fast one."""
    sources = {"z_position": Source("tip.depth", unit="m"), "signal": Source("level")}
    roles = map_roles(switch, "probe", sources, ["z"])
    assert isinstance(roles.exchange(["z_position"]), Exchange)
    assert not isinstance(roles.exchange(["z_position", "signal"]), Exchange)
