"""What a run leaves of axes, of FMUs and of distance sensors: with stand-ins for its parts."""

import math
from dataclasses import fields
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pyarrow as pa
import pytest

from axisrig.bench.machine import facts
from axisrig.bench.machine.recording import plant_values
from axisrig.bench.machine.recording.recorder import Recorder
from axisrig.bench.record.axes import AxisRecord, Latch, PlantValue
from axisrig.bench.record.series import SeriesWriter
from axisrig.kernel.cosim.fmi.units import Unit
from axisrig.kernel.time.clock import MS

# An axis


def machine_of(has_servo: bool = True, node: int | None = 3) -> Any:
    table = SimpleNamespace(segment="can1", node=node, drive="servo", plant="z", encoder_2="gap",
                            signals={"probe_1": "p"})  # fmt: skip
    data = SimpleNamespace(rated_torque_mnm=1270, lead_mm=10.0004, second_delay_cycles=2,
                           units_per_mm=Fraction(1), latch_per_mm=Fraction(500))  # fmt: skip
    rig = SimpleNamespace(axis={"Z": table}, drive={"servo": SimpleNamespace(facts=lambda: data)})
    servo = SimpleNamespace(origin_units=-500, latch_instants_ns=[[7, 3], [5]])
    link = SimpleNamespace(settings=SimpleNamespace(increments_per_mm=1000.0), doubt_mm=0.25,
                           unproved_latches=4, interpolated_latches=2)  # fmt: skip
    part = SimpleNamespace(telegrams=lambda name: [f"telegram of {name}"], states={"Z": ["state"]})
    channel = SimpleNamespace(single=SimpleNamespace(homed=[(9, "Z"), (10, "X"), (11, "Z")]))
    return SimpleNamespace(
        settings=SimpleNamespace(rig=rig), links={"Z": link}, outside=frozenset({"X"}),
        drives={"Z": servo} if has_servo else {}, part_of={"Z": part}, channel=channel,
        torque_limits=SimpleNamespace(of=lambda name: (f"limit of {name}",)),
    )  # fmt: skip


@pytest.fixture
def words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(facts, "is_rotary", lambda *_: True)
    monkeypatch.setattr(facts, "arm_m", lambda *_: 0.5)
    monkeypatch.setattr(facts, "torque_arm_m", lambda *_: 0.75)
    monkeypatch.setattr(facts, "_written", lambda *_: {"kp": 1})
    family = SimpleNamespace(
        late_cycles=lambda _, name: {"Z": 2}[name],
        fresh_late_cycles=lambda _, name: {"Z": 1}[name],
    )
    monkeypatch.setattr(facts, "family_of", lambda *_: family)


@pytest.mark.usefixtures("words")
def test_an_axis_keeps_every_field_of_its_own() -> None:
    found = facts._axis(machine_of(), "Z")
    expected = {
        "segment": "can1", "node": 3, "increments_per_mm": 1000.0, "is_outside": False,
        "is_rotary": True, "arm_m": 0.5, "torque_arm_m": 0.75, "plant": "z",
        "signals": {"probe_1": "p"}, "sensor": "gap", "telegrams": ("telegram of Z",),
        "written": {"kp": 1}, "origin_mm": 0.5, "homed_ns": (9, 11), "doubt_mm": 0.25,
        "unproved_latches": 6, "second_delay_cycles": 2, "late_cycles": 2, "fresh_late_cycles": 1,
        "rated_torque_mnm": 1270, "latch_per_mm": 500.0,
        "lead_um": 10000.0, "torque_limits": ("limit of Z",), "states": ("state",),
        # In the order of their instants, each with the number of its probe
        "latches": (Latch(3, 1), Latch(5, 2), Latch(7, 1)),
    }  # fmt: skip
    assert {one.name for one in fields(AxisRecord)} == set(expected)
    for name, value in expected.items():
        assert getattr(found, name) == value, name


@pytest.mark.usefixtures("words")
def test_a_drive_outside_has_no_latches_and_no_origin_here() -> None:
    made = machine_of(has_servo=False, node=None)
    made.outside = frozenset({"Z"})
    made.settings.rig.axis["Z"].encoder_2 = None
    found = facts._axis(made, "Z")
    assert (found.is_outside, found.latches, found.origin_mm, found.node, found.sensor) == (
        True, (), 0.0, 0, "",
    )  # fmt: skip


@pytest.mark.usefixtures("words")
@pytest.mark.parametrize(
    ("lead_mm", "lead_um"), [(10.0006, 10_001.0), (8.29, 8290.0), (5.08, 5080.0), (2.5, 2500.0)]
)
def test_a_lead_is_to_the_nearest_micrometre(lead_mm: float, lead_um: float) -> None:
    """8.29 mm are a little less than 8290 um as binary numbers."""
    made = machine_of()
    made.settings.rig.drive["servo"].facts().lead_mm = lead_mm
    assert facts._axis(made, "Z").lead_um == lead_um


# An FMU


class Slave:
    """An FMU with these variables: name -> (type, unit, value); `read`: how often it was asked."""

    def __init__(self, **known: tuple[str, str | None, float]) -> None:
        self.known, self.asked = known, list[list[str]]()
        self.description = None

    def has(self, name: str) -> bool:
        return name in self.known

    def variable(self, name: str) -> Any:
        kind, unit, _ = self.known[name]
        return SimpleNamespace(type=kind, unit=unit, shape=(3,) if kind == "Array" else ())

    def get(self, name: str) -> float:
        return self.known[name][2]


class Exchange:
    """Reads several variables at once."""

    def __init__(self, slave: Slave, names: list[str]) -> None:
        self._slave, self._names = slave, names
        self.values: list[float] = []

    def read(self) -> None:
        self._slave.asked.append(self._names)
        self.values = [self._slave.get(name) for name in self._names]


LENGTH = (0, 1, 0, 0, 0, 0, 0, 0)


@pytest.fixture
def named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plant_values, "Exchange", Exchange)
    monkeypatch.setattr(plant_values, "value_names", lambda: ("kv", "lead", "level", "backlash"))
    monkeypatch.setattr(plant_values, "unit_name", lambda variable: variable.unit)
    monkeypatch.setattr(plant_values, "find_unit", lambda _, name: Unit(name, LENGTH, 1e-3, 0.0))


def axis_of(slave: Slave, position: str | None = "position", kv_per_s: float = 50.0) -> Any:
    bound = {} if position is None else {"position": SimpleNamespace(variable=position)}
    return SimpleNamespace(slave=slave, roles=SimpleNamespace(bound=bound), kv_per_s=kv_per_s)


@pytest.mark.interpreted
@pytest.mark.usefixtures("named")
def test_values_of_an_fmu_come_in_si_units_those_of_a_type_at_once() -> None:
    slave = Slave(kv=("Float64", None, 40.0), lead=("Float64", "mm", 10.0),
                  level=("Int32", None, 3.0), other=("Float64", None, 9.0))  # fmt: skip
    for _ in range(2):
        found = plant_values.plant_record(axis_of(slave))
        assert found.values == {
            "kv": PlantValue(40.0), "lead": PlantValue(10e-3, LENGTH), "level": PlantValue(3.0),
        }  # fmt: skip
        assert found.kv_per_s == 50.0
    assert slave.asked == [["kv", "lead"], ["level"]] * 2
    slave.known["kv"] = ("Float64", None, 41.0)
    assert plant_values.plant_record(axis_of(slave)).values["kv"].value == 41.0
    none = plant_values.plant_record(axis_of(Slave(), None, 0.0))
    assert (none.values, none.kv_per_s) == ({}, None)


@pytest.mark.interpreted
@pytest.mark.usefixtures("named")
def test_of_two_axes_in_an_fmu_each_has_its_own_values() -> None:
    slave = Slave(kv_1=("Float64", None, 1.0), kv_2=("Float64", None, 2.0),
                  lead=("Float64", None, 5.0), kv=("Float64", None, 9.0))  # fmt: skip
    for position, kv in (("position_1", 1.0), ("position_2", 2.0), ("position", 9.0), ("way", 9.0)):
        found = plant_values.plant_record(axis_of(slave, position)).values
        assert (found["kv"].value, found["lead"].value) == (kv, 5.0), position


# A distance sensor


class Sensor:
    """A distance sensor that gives these values, in m and rad."""

    def __init__(self, roles: str, true_m: float | None, has_tool: bool = False) -> None:
        self.roles: Any = SimpleNamespace(has=roles.split().__contains__)
        self.has_tool, self._true_m = has_tool, true_m

    def reported_at(self, time_ns: int) -> tuple[float, float | None, bool, bool]:
        return 0.002 + time_ns / MS * 1e-6, self._true_m, True, False

    def tool_at(self, _time_ns: int) -> list[float]:
        return [0.001 * k for k in range(1, 9)] + [math.radians(35.0)]


def recorded(rows: int, **sensors: Sensor) -> pa.Table:
    plant: Any = SimpleNamespace(distances=sensors, now_ns=0)
    recorder = Recorder(plant, (), {}, (), SeriesWriter(None))
    distance = SimpleNamespace(axes={}, channel=None)
    for number in range(1, rows + 1):
        recorder(SimpleNamespace(sync_ns=number * MS, links=[], distance=distance))  # type: ignore[arg-type]
    return recorder.table()


@pytest.mark.interpreted
def test_sensors_have_the_columns_of_their_roles_in_mm() -> None:
    table = recorded(
        2,
        gap=Sensor("distance distance_true valid touching", 0.003),
        bare=Sensor("distance", None),
        tilted=Sensor("distance distance_true", 0.004, has_tool=True),
    )
    found = {name: table[name].to_pylist() for name in table.column_names}
    assert found["gap.distance_mm"] == pytest.approx([2.001, 2.002])
    assert found["gap.distance_true_mm"] == pytest.approx([3.0, 3.0])
    assert (found["gap.valid"], found["gap.touching"]) == ([1, 1], [0, 0])
    assert [name for name in found if name.startswith("bare.")] == ["bare.distance_mm"]
    tool = [name for name in found if name.startswith("tilted.")][2:]
    assert [found[name][0] for name in tool] == pytest.approx([1, 2, 3, 4, 5, 6, 7, 8, 35])
    assert [tool[0], tool[-1]] == ["tilted.along_mm", "tilted.tilt_deg"]
    assert not any(name.startswith("gap.tilt") for name in found)


@pytest.mark.interpreted
def test_a_run_without_a_cycle_has_its_columns_and_no_row() -> None:
    table = recorded(0, gap=Sensor("distance", None))
    assert (table.num_rows, "gap.distance_mm" in table.column_names) == (0, True)
