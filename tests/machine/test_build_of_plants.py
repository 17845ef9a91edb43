"""How the plants of a rig are built one after the other: owners first, let go where one fails."""

import os
from collections import defaultdict
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.made_rigs import settings_of

from axisrig.bench.machine import kept_fmus, plants
from axisrig.bench.plan.assignment import Assignment, parse_assignment
from axisrig.bench.rig.reading.file import LOAD, MapTable, PlantTable
from axisrig.kernel.cosim.fmi.roles import Source
from axisrig.kernel.errors import UserError

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

SERVO, BEAM = "AxisRig.Drives.ServoAxis", "AxisRig.Drives.GantryBeam"


class World:
    """A rig of stand-ins; calls: what was done, in its order. broken: plant that cannot be had."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, broken: str = "") -> None:
        self.calls: list[tuple[Any, ...]] = []
        self.closed: list[str] = []
        self.broken = broken
        self.plant = SimpleNamespace(
            axes={}, notes=defaultdict(list), remarks=defaultdict(list),
            add_axis=self._add_axis,
            add_axis_beside=lambda name, first, _roles, second: self.calls.append(
                ("beside", name, first, second)
            ),
        )  # fmt: skip
        for name, stand_in in {
            "_empty_plant": lambda _settings: self.plant,
            "simulated_plants": lambda settings: settings.rig.plant,
            "_load": self._load,
            "_wire": lambda _s, _p, name, *_: self.calls.append(("wire", name)),
            "roles_of": lambda slave, table, _find: SimpleNamespace(
                kind=table.kind or "axis", notes=[f"note of {slave.name}"], bound={}, slave=slave
            ),
            "set_start_values": lambda _s, name, *_: self.calls.append(("start", name)),
            "problems": lambda slave: [f"problem of {slave.name}"],
            "remarks": lambda _table, roles: [f"remark on {roles.slave.name}"],
            "close_fmus": lambda slaves: self.closed.extend(slave.name for slave in slaves),
        }.items():
            monkeypatch.setattr(plants, name, stand_in)

    def _load(self, _settings: Any, name: str, _table: Any) -> Any:
        if name == self.broken:
            raise KeyboardInterrupt
        self.calls.append(("load", name))
        return SimpleNamespace(name=name, names=lambda _kind: ())

    def _add_axis(self, slave: Any, roles: Any, second: str | None) -> None:
        self.plant.axes[slave.name] = SimpleNamespace(slave=slave, roles=roles)
        self.calls.append(("axis", slave.name, second))

    def build(self, tables: dict[str, PlantTable], **encoders: str) -> Any:
        axis = {
            name.upper(): SimpleNamespace(plant=name, encoder_2=encoders.get(name), signals={})
            for name, table in tables.items()
            if table.kind is None
        }
        rig = SimpleNamespace(plant=tables, axis=axis)
        settings: Any = SimpleNamespace(rig=rig, start={}, files=[])
        return plants.build_plant(settings)


def table(**keys: Any) -> PlantTable:
    return PlantTable(fmu=keys.pop("fmu", SERVO), **keys)


def test_a_plant_that_shares_an_fmu_is_built_after_its_owner_wherever_it_stands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Sensors are wired when every axis is there. What was noted is in the order of the build."""
    world = World(monkeypatch)
    plant = world.build(
        {
            "gap": table(kind="distance", fmu="AxisRig.Sensors.DistanceSensor"),
            "x2": table(shares="x", fmu=BEAM),
            "x": table(fmu=BEAM),
            "z": table(),
        }
    )
    assert [call for call in world.calls if call[0] != "start"] == [
        ("load", "gap"), ("load", "x"), ("axis", "x", None), ("load", "z"), ("axis", "z", None),
        ("beside", "x2", "x", None), ("wire", "gap"),
    ]  # fmt: skip
    assert [name for kind, name, *_ in world.calls if kind == "start"] == ["gap", "x", "z", "x2"]
    assert plant.notes["x2"] == ["problem of x", "note of x"]
    assert plant.remarks == {name: [f"remark on {name}"] for name in ("gap", "x", "z")} | {
        "x2": ["remark on x"]
    }
    assert world.closed == []


def test_a_second_encoder_at_the_load_is_that_of_the_axis_itself(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    world = World(monkeypatch)
    world.build(
        {"x": table(fmu=BEAM), "x2": table(shares="x", fmu=BEAM), "y": table(), "z": table()},
        x=LOAD, x2=LOAD, y="gap",
    )  # fmt: skip
    assert [call for call in world.calls if call[0] in ("axis", "beside")] == [
        ("axis", "x", "x"), ("axis", "y", "gap"), ("axis", "z", None), ("beside", "x2", "x", "x2"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("broken", "closed"), [("x", []), ("y", ["x"]), ("z", ["x", "y"]), ("", [])]
)
def test_where_one_cannot_be_had_those_before_it_are_let_go(
    monkeypatch: pytest.MonkeyPatch, broken: str, closed: list[str]
) -> None:
    world = World(monkeypatch, broken)
    tables = {name: table() for name in "xyz"}
    if not broken:
        assert [*world.build(tables).axes] == ["x", "y", "z"]
    else:
        with pytest.raises(KeyboardInterrupt):
            world.build(tables)
    assert world.closed == closed


# --- what cannot be shared


def shared(name: str, first: str, fmu: str = BEAM, *cells: str, **keys: Any) -> UserError:
    """The error of a plant beside x and x2, which is on the FMU of x, and y."""
    slaves = {of: SimpleNamespace(name=of) for of in "xy"}
    plant: Any = SimpleNamespace(
        axes={of: SimpleNamespace(slave=slaves[of[0]]) for of in ("x", "x2", "y")}
    )
    settings = settings_of("gantry-pair.toml")

    def located(error: UserError, item: Assignment) -> UserError:
        error.message = f"{item.column}: {error.message}"
        return error

    start = [(parse_assignment(f"plant:{name}.{cell}"), located) for cell in cells]
    tables = settings.rig.plant | {"x": table(fmu=BEAM), "y": table()}
    rig = settings.rig.model_copy(update={"plant": tables})
    made: Any = SimpleNamespace(rig=rig, files=settings.files, start={name: start})
    with pytest.raises(UserError) as refused:
        plants._shared(made, plant, name, PlantTable(fmu=fmu, shares=first, **keys), first)
    return refused.value


@pytest.mark.parametrize("first", ["x2", "probe", "x3"])
def test_who_shares_an_fmu_itself_is_no_owner_of_it(first: str) -> None:
    error = shared("x3", first)
    assert error.message == (
        "plant x3: shares must name the plant of an axis that is simulated here"
    )
    assert (error.value, error.allowed) == (first, "x, y")


def test_what_is_wrong_with_a_shared_plant_is_named_with_what_is_right() -> None:
    error = shared("x3", "x", SERVO)
    assert error.message == "plant x3 shares the FMU of x and names another"
    assert (error.value, error.allowed) == (SERVO, BEAM)
    error = shared("x3", "x", start={"kv": 3})
    assert error.message == "start values of plant x3 belong to x"
    error = shared("x3", "x", BEAM, "kv=30", "force_limit_n=700")
    assert error.message == "plant:x3.kv: x3 has no start values"
    assert (error.value, error.hint) == ("kv", "plant x3 shares the FMU of x: set it there")


def test_an_input_that_is_taken_is_that_of_the_axis_that_has_it() -> None:
    """Of three on one FMU the third one takes that of the second."""
    beam: Any = SimpleNamespace(names=lambda kind: ("f1", "f2", "f3") if kind == "input" else ())

    def named(variable: str) -> Any:
        bound = {"force": SimpleNamespace(variable=variable)}
        roles = SimpleNamespace(slave=beam, kind="axis", bound=bound)
        return SimpleNamespace(slave=beam, roles=roles)

    plant: Any = SimpleNamespace(axes={"x": named("f1"), "x2": named("f2")})
    for variable, owner in (("f1", "x"), ("f2", "x2")):
        with pytest.raises(UserError) as refused:
            plants._add_beside(
                settings_of("gantry-pair.toml"), plant, "x2", "x", named(variable).roles, None
            )
        assert refused.value.message == f"plant x2 writes the same input as {owner}"
        assert (refused.value.value, refused.value.hint) == (
            variable, "give both a suffix, or a map"
        )  # fmt: skip


def test_each_input_of_an_axis_has_to_be_free() -> None:
    """The force is its own and the limit behind it is taken; an output may be shared."""
    inputs = ("f1", "f2", "limit", "brake")
    beam: Any = SimpleNamespace(names=lambda kind: inputs if kind == "input" else ())

    def named(**bound: str) -> Any:
        of = {role: SimpleNamespace(variable=name) for role, name in bound.items()}
        return SimpleNamespace(slave=beam, kind="axis", bound=of)

    added: list[Any] = []
    first = named(position="out", force="f1", force_limit="limit")
    plant: Any = SimpleNamespace(
        axes={"x": SimpleNamespace(slave=beam, roles=first)},
        add_axis_beside=lambda *words: added.append(words),
    )
    settings = settings_of("gantry-pair.toml")
    second = named(position="out", force="f2", force_limit="limit")
    with pytest.raises(UserError, match="plant x2 writes the same input as x") as refused:
        plants._add_beside(settings, plant, "x2", "x", second, None)
    assert (refused.value.value, added) == ("limit", [])
    free = named(position="out", force="f2", force_limit="brake")
    plants._add_beside(settings, plant, "x2", "x", free, None)
    assert added == [("x2", "x", free, None)]


@pytest.mark.parametrize(
    ("signals", "is_noted"),
    [
        ({}, True),
        ({"probe_1": "p"}, True),
        ({"probe_2": "p"}, True),
        ({"limit_negative": "p"}, False),
        ({"home_switch": "p", "limit_positive": "p"}, False),
        ({"home_switch": "p", "probe_2": "p"}, True),
        ({"home_switch": "other"}, True),
    ],
)
def test_a_switch_needs_no_contacts_and_a_probe_does(
    monkeypatch: pytest.MonkeyPatch, signals: dict[str, str], is_noted: bool
) -> None:
    """Every other note is about a switch too."""
    world, notes = World(monkeypatch), ["no contact_z: contacts are not known", "no signal_rate"]
    monkeypatch.setattr(
        plants, "roles_of", lambda slave, *_: SimpleNamespace(kind="probe", notes=notes, bound={})
    )
    axis = SimpleNamespace(plant="z", encoder_2=None, signals=signals)
    rig = SimpleNamespace(plant={"p": table(kind="probe")}, axis={"Z": axis})
    settings: Any = SimpleNamespace(rig=rig, start={}, files=[])
    monkeypatch.setattr(plants, "remarks", lambda *_: [])
    plant = plants.build_plant(settings)
    assert plant is world.plant
    assert plant.notes["p"] == ["problem of p", *(notes if is_noted else notes[1:])]


# --- roles and wires


def test_a_map_comes_before_a_suffix_and_adds_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    taken: dict[str, Any] = {}
    monkeypatch.setattr(plants, "coordinates_of", lambda *_: [])
    monkeypatch.setattr(plants, "refuse_unknown", lambda *_: None)

    def map_roles(_slave: Any, _kind: str, sources: dict[str, Any], *_: Any) -> Any:
        taken.update(sources)
        return SimpleNamespace(has_group=lambda _: False)

    monkeypatch.setattr(plants, "map_roles", map_roles)
    names = ("position_2", "velocity_2", "force_2")
    slave: Any = SimpleNamespace(has=names.__contains__, grid_ns=None)
    entry = MapTable(variable="v", sign=-1)
    own = PlantTable(
        fmu="own.fmu", kind="axis", suffix="_2", map={"velocity": entry, "force": False, "kv": "k"}
    )
    plants._roles(settings_of("probe-z.toml"), "z", own, slave)
    assert taken == {
        "position": Source("position_2"), "velocity": Source("v", None, -1), "force": None,
        "kv": Source("k"),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("wire", "coordinates", "allowed"),
    [({"q": "x"}, ["x", "y"], "x, y"), ({"x": "x", "u": "y"}, ["x"], "x"), ({"x": "z"}, [], None)],
)
def test_a_coordinate_that_the_fmu_does_not_read_names_those_that_it_does(
    wire: dict[str, str], coordinates: list[str], allowed: str | None
) -> None:
    wrong = next(name for name in wire if name not in coordinates)
    own = PlantTable(fmu="own.fmu", wire=wire)
    with pytest.raises(UserError) as refused:
        plants._check_wire(settings_of("probe-z.toml"), "probe", own, coordinates)
    assert refused.value.message == f"probe has no input {wrong}"
    assert (refused.value.value, refused.value.allowed) == (wrong, allowed)


def test_a_file_in_the_place_of_another_is_another_one_whatever_its_time_and_size(
    tmp_path: Path,
) -> None:
    """As a build that is copied with its times; what is not there is nothing."""
    path, other = tmp_path / "a.fmu", tmp_path / "b.fmu"
    for file in (path, other):
        file.write_bytes(b"1234")
        os.utime(file, ns=(5, 5))
    first = kept_fmus._state(path)
    assert kept_fmus._state(path) == first
    other.replace(path)
    assert kept_fmus._state(path) != first
    second = kept_fmus._state(path)
    os.utime(path, ns=(5, 6))
    assert kept_fmus._state(path) != second
    path.unlink()
    assert kept_fmus._state(path) is None
