"""Plants as the tables of a rig make them: steps, sources of roles, start values, shared FMUs."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.made_rigs import above, settings_of

from axisrig.bench.machine import kept_fmus, plants
from axisrig.bench.machine.fmu_files import plant_path
from axisrig.bench.machine.start_values import set_start_values
from axisrig.bench.rig.reading.file import MapTable, PlantTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.fmi.fmu import load_fmu
from axisrig.kernel.cosim.fmi.roles import FLAG_THRESHOLD, Source, map_roles
from axisrig.kernel.errors import UserError

# --- steps


BACK, AHEAD = "input_delay_us = 4.0\ndelay_compensation_us = 44.0", "input_delay_us = 7.0"


@pytest.mark.parametrize(("first", "second"), [(BACK, AHEAD), (AHEAD, BACK)])
def test_steps_serve_the_drive_that_looks_farthest_on_either_side(
    tmp_path: Path, first: str, second: str
) -> None:
    """One drive looks 40 us back and 4 us ahead, the other one 7 us ahead and not back."""
    text = (
        "[cycle]\nexchange_us = 5000\nfine_us = 25\n"
        f'[drive.servo]\n{first}\n[drive.other]\n{second}\n[axis.Y]\ndrive = "other"'
    )
    plant = plants._empty_plant(settings_of(above(tmp_path, "probe-xyz.toml", text)))
    assert (plant.exchange_ns, plant.fine_ns) == (5_000_000, 25_000)
    assert (plant._hold_ns, plant._look_back_ns) == (7000, 40_000)


# --- where a role comes from


@pytest.mark.parametrize(
    ("entry", "source"),
    [
        (False, None),
        ("out", Source("out", None, 1, FLAG_THRESHOLD, None)),
        (MapTable(variable="v"), Source("v", None, 1, FLAG_THRESHOLD, None)),
        (MapTable(variable="v", unit="deg", sign=-1, threshold=0.0, lead_mm=360.0),
         Source("v", "deg", -1, 0.0, 0.36)),
        (MapTable(variable="v", threshold=24.0), Source("v", None, 1, 24.0, None)),
    ],
)  # fmt: skip
def test_an_entry_of_a_map_names_the_source_of_a_role(entry: Any, source: Any) -> None:
    assert plants._source(entry) == source


@pytest.mark.parametrize(
    ("known", "found"),
    [
        ("position_2 velocity_2 kv", {"position": "position_2", "velocity": "velocity_2"}),
        ("position velocity", {}),
        # Limits on either side take the place of one for both
        ("position_2 force_limit_negative_2 force_limit_positive_2",
         {"position": "position_2", "force_limit_negative": "force_limit_negative_2",
          "force_limit_positive": "force_limit_positive_2", "force_limit": None}),
        ("position_2 force_limit_negative_2", {"position": "position_2",
                                               "force_limit_negative": "force_limit_negative_2"}),
    ],
)  # fmt: skip
@pytest.mark.interpreted
def test_a_suffix_is_behind_the_names_of_the_roles(known: str, found: dict[str, Any]) -> None:
    slave: Any = SimpleNamespace(has=known.split().__contains__)
    sources = plants._suffixed(slave, "_2")
    assert {r: None if s is None else s.variable for r, s in sources.items()} == found


# --- start values


class Fmu:
    """A model of the library, as an axis."""

    def __init__(self) -> None:
        path = plant_path(
            settings_of("probe-z.toml"), "z", PlantTable(fmu="AxisRig.Drives.ServoAxis")
        )
        self.slave = load_fmu(path, "z")
        self.roles = map_roles(self.slave, "axis", {}, [], lambda error, _role: error)
        self.given: list[tuple[str, Any]] = []

    def take(self, settings: Settings, table: PlantTable) -> list[tuple[str, Any]]:
        self.given = []
        stand: Any = SimpleNamespace(
            **{name: getattr(self.slave, name) for name in ("has", "names", "variable", "name")},
            description=self.slave.description,
            set_start=lambda *words: self.given.append(words),
        )
        roles: Any = SimpleNamespace(slave=stand, spare_inputs=self.roles.spare_inputs)
        set_start_values(settings, "z", table, roles)
        return self.given


@pytest.fixture(scope="module")
def fmu() -> Any:
    made = Fmu()
    yield made
    made.slave.close()


@pytest.mark.interpreted
def test_values_of_the_run_come_after_those_of_the_rig_in_the_unit_of_the_fmu(fmu: Fmu) -> None:
    """Lengths in m; a run may give what the rig gives too, and the last one counts."""
    settings = settings_of("probe-z.toml", "plant:z.position_start_um=250", "plant:z.kv=30")
    table = PlantTable(fmu="AxisRig.Drives.ServoAxis", start={"position_start_mm": 5, "kv": 40})
    assert fmu.take(settings, table) == [
        ("position_start", pytest.approx(5e-3)), ("kv", 40.0),
        ("position_start", pytest.approx(250e-6)), ("kv", 30.0),
    ]  # fmt: skip


@pytest.mark.interpreted
def test_settled_settings_know_the_values_of_each_plant(fmu: Fmu) -> None:
    settings = settings_of("probe-z.toml", "plant:z.kv=30")
    table = PlantTable(fmu="AxisRig.Drives.ServoAxis", start={"kv": 40})
    first = [*fmu.take(settings, table)]
    assert not settings.known
    settings.is_settled = True
    assert fmu.take(settings, table) == first
    assert settings.known[("start values", "z")] == first
    settings.start["z"].clear()  # nothing is read again
    assert fmu.take(settings, table) == first
    assert fmu.take(replace(settings), table) == first[:1]  # a copy begins without


@pytest.mark.interpreted
def test_a_length_without_a_unit_is_noted_where_it_could_have_one(fmu: Fmu) -> None:
    """0 is 0 in every unit; a gain has one size; what names its unit is clear."""
    changes = ("position_start=0.25", "kv=30", "screw_lead_mm=10")
    settings = settings_of("probe-z.toml", *(f"plant:z.{one}" for one in changes))
    table = PlantTable(
        fmu="AxisRig.Drives.ServoAxis", start={"position_start": 0, "screw_lead": 0.02}
    )
    fmu.take(settings, table)
    assert [*settings.bare] == ["plant:z.position_start"]
    unit, columns = settings.bare["plant:z.position_start"]
    assert unit == "m"
    assert {"plant:z.position_start_mm", "plant:z.position_start_um"} <= {*columns}
    assert [*settings.bare_in_rig] == ["plant:z.screw_lead"]


# --- roles that are known


def test_roles_are_found_once_for_each_table_of_an_instance() -> None:
    path = plant_path(settings_of("probe-z.toml"), "z", PlantTable(fmu="AxisRig.Drives.ServoAxis"))
    slave, other = kept_fmus.take_fmu(path, "roles_a"), load_fmu(path, "roles_a")
    found: list[Any] = []

    def find() -> Any:
        found.append(object())
        return found[-1]

    first = PlantTable(fmu="AxisRig.Drives.ServoAxis")
    second = PlantTable(fmu="AxisRig.Drives.ServoAxis", suffix="_2")
    try:
        one = kept_fmus.roles_of(slave, first, find)
        assert kept_fmus.roles_of(slave, first.model_copy(), find) is one
        two = kept_fmus.roles_of(slave, second, find)
        assert kept_fmus.roles_of(slave, second, find) is two is not one
        assert kept_fmus.roles_of(slave, first, find) is one
        # Another instance of the same name is not the one that is kept
        assert kept_fmus.roles_of(other, first, find) is not one
        assert len(found) == 3
        for number in range(kept_fmus.ROLES_MAX):
            kept_fmus.roles_of(slave, PlantTable(fmu="A.B", suffix=f"_{number}"), find)
        assert kept_fmus.roles_of(slave, first, find) is not one  # only the latest are kept
    finally:
        other.close()
        kept_fmus.close_fmus([slave])


# --- an axis beside another one on its FMU


def roles_on(slave: Any, kind: str = "axis", **bound: str) -> Any:
    variables = {role: SimpleNamespace(variable=name) for role, name in bound.items()}
    return SimpleNamespace(slave=slave, kind=kind, bound=variables)


def fmu_with(*inputs: str) -> Any:
    return SimpleNamespace(names=lambda causality: inputs if causality == "input" else ())


@pytest.mark.interpreted
def test_two_axes_of_one_fmu_have_inputs_of_their_own_and_may_share_its_outputs() -> None:
    """Another FMU of the same model has inputs of the same names: these are other ones."""
    beam, other = fmu_with("force_1", "force_2"), fmu_with("force_1", "force_2")
    added: list[Any] = []

    def named(slave: Any, force: str) -> Any:
        return SimpleNamespace(slave=slave, roles=roles_on(slave, force=force, position="middle"))

    plant: Any = SimpleNamespace(
        axes={"x": named(beam, "force_1"), "y": named(other, "force_2")},
        add_axis_beside=lambda *words: added.append(words),
    )
    settings = settings_of("gantry-pair.toml")
    second = roles_on(beam, force="force_2", position="middle")
    plants._add_beside(settings, plant, "x2", "x", second, "second")
    assert added == [("x2", "x", second, "second")]
    with pytest.raises(UserError, match="plant x2 writes the same input as x") as refused:
        plants._add_beside(settings, plant, "x2", "x", roles_on(beam, force="force_1"), None)
    assert refused.value.value == "force_1"
    with pytest.raises(UserError, match="shares an FMU and is no axis") as refused:
        plants._add_beside(settings, plant, "x2", "x", roles_on(beam, kind="sensor"), None)
    assert (refused.value.value, refused.value.allowed) == ("sensor", "axis")
    assert len(added) == 1


@pytest.mark.interpreted
def test_what_an_fmu_refuses_of_a_second_axis_has_the_place_of_its_key() -> None:
    def refuse(*_: Any) -> None:
        raise UserError("it has no second axis", value="x2")

    plant: Any = SimpleNamespace(axes={}, add_axis_beside=refuse)
    with pytest.raises(UserError, match="it has no second axis") as refused:
        plants._add_beside(
            settings_of("gantry-pair.toml"), plant, "x2", "x", roles_on(fmu_with()), None
        )
    assert str(refused.value.file).endswith("gantry-pair.toml")
    assert refused.value.line is not None
