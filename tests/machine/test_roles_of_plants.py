"""What the table of a plant may say of its FMU, and where an error of it is."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.machine.made_rigs import above, settings_of

from axisrig.bench.machine import plants
from axisrig.bench.machine.fmu_files import plant_path
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.fmi.fmu import FmuSlave, load_fmu
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

SENSORS = {"gap": "distance-z.toml", "probe": "probe-z.toml"}
"""A distance sensor and a probe, with the rigs that have them."""
KINDS = {"gap": "distance", "probe": "probe", "z": "axis"}
TRAJECTORY = ("step_time", "step_size", "z_start", "z_rate_start", "z_end", "z_rate_end")


@pytest.fixture(scope="module")
def slaves() -> Iterator[dict[str, FmuSlave]]:
    """Their FMUs and that of an axis."""
    made = {}
    for name, rig in {**SENSORS, "z": "distance-z.toml"}.items():
        settings = settings_of(rig)
        made[name] = load_fmu(plant_path(settings, name, settings.rig.plant[name]), name)
    yield made
    for slave in made.values():
        slave.close()


@pytest.fixture
def fixed_step(slaves: dict[str, FmuSlave]) -> Iterator[dict[str, FmuSlave]]:
    """The same, with a step of 1 ms that cannot be another one."""
    for slave in slaves.values():
        slave.grid_ns = MS
    yield slaves
    for slave in slaves.values():
        slave.grid_ns = None


def roles_of(settings: Settings, name: str, slaves: dict[str, FmuSlave]) -> Any:
    return plants._roles(settings, name, settings.rig.plant[name], slaves[name])


def rig(folder: Path, name: str, text: str = "") -> Settings:
    return settings_of(above(folder, SENSORS[name], text))


def place(error: UserError) -> tuple[str, str]:
    """Name of the file and the line that an error is about."""
    assert error.file is not None
    assert error.line is not None
    path = Path(error.file)
    return path.name, path.read_text(encoding="utf-8").splitlines()[error.line - 1].strip()


@pytest.mark.parametrize("name", SENSORS)
def test_a_sensor_with_a_fixed_step_reads_no_trajectories(
    fixed_step: dict[str, FmuSlave], name: str
) -> None:
    """Sub-steps of a trajectory differ in length: a probe and a distance sensor alike."""
    with pytest.raises(UserError) as caught:
        roles_of(settings_of(SENSORS[name]), name, fixed_step)
    assert caught.value.message == (
        f"plant {name} reads trajectories but cannot take steps that differ in length"
    )
    hint = "let it follow positions: step_time = false and g_position in its map"
    assert caught.value.hint == hint
    file, line = place(caught.value)
    assert (file, line.startswith("fmu = ")) == (SENSORS[name], True)


@pytest.mark.parametrize("name", SENSORS)
def test_one_that_takes_any_step_reads_them(slaves: dict[str, FmuSlave], name: str) -> None:
    roles = roles_of(settings_of(SENSORS[name]), name, slaves)
    assert (roles.kind, roles.has_group("trajectory")) == (KINDS[name], True)
    assert roles.has(*TRAJECTORY)


@pytest.mark.parametrize("name", SENSORS)
def test_a_sensor_with_a_fixed_step_may_follow_positions(
    fixed_step: dict[str, FmuSlave], tmp_path: Path, name: str
) -> None:
    """As the hint of the refusal says."""
    off = "".join(f"{role} = false\n" for role in TRAJECTORY)
    kind = f'[plant.{name}]\nkind = "{KINDS[name]}"\n'
    text = f'{kind}[plant.{name}.map]\n{off}z_position = "z_start"'
    roles = roles_of(rig(tmp_path, name, text), name, fixed_step)
    assert (roles.has_group("trajectory"), roles.has_group("plain")) == (False, True)
    assert roles.bound["z_position"].variable == "z_start"


def test_an_axis_with_a_fixed_step_is_taken(fixed_step: dict[str, FmuSlave]) -> None:
    assert roles_of(settings_of("distance-z.toml"), "z", fixed_step).kind == "axis"


# Wires


def test_nothing_is_wired_to_an_axis(slaves: dict[str, FmuSlave], tmp_path: Path) -> None:
    settings = rig(tmp_path, "gap", '[plant.z]\nwire = { z = "z" }')
    with pytest.raises(UserError, match="plant z is an axis: nothing is wired to it") as caught:
        roles_of(settings, "z", slaves)
    assert place(caught.value) == ("rig.toml", 'wire = { z = "z" }')


@pytest.mark.parametrize("name", SENSORS)
def test_a_sensor_is_wired_to_an_axis(slaves: dict[str, FmuSlave], name: str) -> None:
    settings = settings_of(SENSORS[name])
    settings.rig.plant[name].wire.clear()
    with pytest.raises(UserError, match=f"plant {name} is wired to no axis"):
        roles_of(settings, name, slaves)


@pytest.mark.parametrize("name", SENSORS)
def test_a_wire_to_an_input_that_there_is_not_names_those_that_there_are(
    slaves: dict[str, FmuSlave], tmp_path: Path, name: str
) -> None:
    settings = rig(tmp_path, name, f'[plant.{name}.wire]\nq = "z"')
    with pytest.raises(UserError, match=f"{name} has no input q") as caught:
        roles_of(settings, name, slaves)
    assert caught.value.value == "q"
    assert "z" in caught.value.allowed  # type: ignore[operator]
    assert "q_position = ..." in (caught.value.hint or "")
    assert place(caught.value) == ("rig.toml", 'q = "z"')


# Maps


@pytest.mark.parametrize(
    ("name", "role", "near"), [("gap", "distanse", "distance"), ("probe", "signall", "signal")]
)
def test_a_role_that_there_is_not_is_refused_where_the_map_has_it(
    slaves: dict[str, FmuSlave], tmp_path: Path, name: str, role: str, near: str
) -> None:
    text = f'[plant.{name}]\nkind = "{KINDS[name]}"\n[plant.{name}.map]\n{role} = "x"'
    with pytest.raises(UserError) as caught:
        roles_of(rig(tmp_path, name, text), name, slaves)
    message = f"plant {name}: a plant of the kind {KINDS[name]} has no such role"
    assert (caught.value.message, caught.value.value) == (message, role)
    assert near in caught.value.allowed  # type: ignore[operator]
    assert place(caught.value) == ("rig.toml", f'{role} = "x"')


@pytest.mark.parametrize(("name", "role"), [("gap", "distance"), ("probe", "signal")])
def test_a_variable_that_the_fmu_lacks_is_refused_at_its_role(
    slaves: dict[str, FmuSlave], tmp_path: Path, name: str, role: str
) -> None:
    text = f'[plant.{name}.map]\n{role} = "no_such_variable"'
    with pytest.raises(UserError) as caught:
        roles_of(rig(tmp_path, name, text), name, slaves)
    assert caught.value.message.startswith(f"plant {name}: ")
    assert place(caught.value) == ("rig.toml", f'{role} = "no_such_variable"')


@pytest.mark.parametrize(("name", "role"), [("gap", "distance"), ("probe", "signal")])
def test_a_role_that_is_needed_and_left_out_is_an_error_of_the_plant(
    slaves: dict[str, FmuSlave], tmp_path: Path, name: str, role: str
) -> None:
    text = f'[plant.{name}]\nkind = "{KINDS[name]}"\n[plant.{name}.map]\n{role} = false'
    with pytest.raises(UserError, match=role) as caught:
        roles_of(rig(tmp_path, name, text), name, slaves)
    assert caught.value.line is not None
    assert place(caught.value)[1].startswith("fmu = ")


class Lacking:
    """An FMU without one of its variables."""

    def __init__(self, slave: FmuSlave, name: str) -> None:
        self._slave, self._name = slave, name

    def has(self, name: str) -> bool:
        return name != self._name and self._slave.has(name)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._slave, name)


@pytest.mark.interpreted
def test_a_role_that_neither_map_nor_fmu_has_is_an_error_of_the_fmu(
    slaves: dict[str, FmuSlave], tmp_path: Path
) -> None:
    """Although the map has others."""
    settings = rig(
        tmp_path, "gap", '[plant.gap]\nkind = "distance"\n[plant.gap.map]\nvalid = false'
    )
    own: Any = Lacking(slaves["gap"], "distance")
    with pytest.raises(UserError, match="distance") as caught:
        plants._roles(settings, "gap", settings.rig.plant["gap"], own)
    assert place(caught.value)[1].startswith("fmu = ")


@pytest.mark.parametrize("name", KINDS)
def test_the_kind_of_a_plant_follows_from_its_fmu_or_is_given(
    slaves: dict[str, FmuSlave], name: str
) -> None:
    settings = settings_of(SENSORS.get(name, "distance-z.toml"))
    assert roles_of(settings, name, slaves).kind == KINDS[name]
    table = settings.rig.plant[name].model_copy(update={"kind": KINDS[name]})
    assert plants._roles(settings, name, table, slaves[name]).kind == KINDS[name]


def test_an_fmu_that_is_no_plant_says_what_the_rig_may_give(
    slaves: dict[str, FmuSlave], tmp_path: Path
) -> None:
    """Neither an axis nor a sensor: what either needs is left out."""
    text = "[plant.gap.map]\ndistance = false\nsignal = false\nposition = false"
    settings = rig(tmp_path, "gap", text)
    with pytest.raises(UserError, match="fit neither an axis nor a sensor") as caught:
        roles_of(settings, "gap", slaves)
    assert caught.value.value == "gap"
    assert (caught.value.hint or "").startswith("give kind and map in the rig")
    assert place(caught.value)[1].startswith("fmu = ")


@pytest.mark.parametrize("name", SENSORS)
def test_a_sensor_is_added_as_what_it_is(slaves: dict[str, FmuSlave], name: str) -> None:
    settings = settings_of(SENSORS[name])
    plant, roles = Plant(MS, 62_500), roles_of(settings, name, slaves)
    axis = settings_of("distance-z.toml")
    plant.add_axis(slaves["z"], roles_of(axis, "z", slaves))
    plants._wire(settings, plant, name, settings.rig.plant[name], roles)
    assert [*plant.probes] == ["probe"] * (name == "probe")
    assert [*plant.distances] == ["gap"] * (name == "gap")


@pytest.mark.parametrize("name", SENSORS)
def test_a_wire_to_no_axis_is_refused_at_the_wire(
    slaves: dict[str, FmuSlave], tmp_path: Path, name: str
) -> None:
    settings = rig(tmp_path, name, f'[plant.{name}]\nwire = {{ z = "nobody" }}')
    roles = roles_of(settings, name, slaves)
    plant = Plant(MS, 62_500)
    with pytest.raises(UserError) as caught:
        plants._wire(settings, plant, name, settings.rig.plant[name], roles)
    assert place(caught.value) == ("rig.toml", 'wire = { z = "nobody" }')
