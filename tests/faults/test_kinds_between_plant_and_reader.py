"""Each kind of fault between the plant and who reads it, from its cell to what it does there."""

import random
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.axis.switches import HOME
from axisrig.bench.machine.faults import clock, plc, sensors, wires
from axisrig.bench.machine.faults.acts import Act
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.faults import read_faults
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.cosim.plant.probe import PlantSignal
from axisrig.kernel.time.clock import MS, US, S

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
KINDS = {**wires.KINDS, **sensors.KINDS, **plc.KINDS, **clock.KINDS}


class Axis:
    """A motor at 100 mm and 20 mm/s, whose load is 1 mm beside it."""

    kinds, limits_force = frozenset({"position", "velocity"}), True

    def __init__(self) -> None:
        self.calls: list[tuple[Any, ...]] = []

    def motor_position_m(self) -> float:
        return 0.100

    def motor_velocity_m_s(self) -> float:
        return 0.02

    def second_encoder_m(self) -> float:
        return 0.101

    def second_encoder_m_at(self, _time_ns: int) -> float:
        return 0.102

    def force_n(self) -> float:
        return 12.0

    def __getattr__(self, name: str) -> Any:
        return lambda *words: self.calls.append((name, *words))


def settings_of(rig: str, *changes: str) -> Settings:
    assigned = [(parse_assignment(text), as_written) for text in changes]
    return read_settings(*read_rig(RIGS / rig), assigned)


class Bench:
    """Wires of a rig over a plant by hand; `do` builds the fault of a cell in."""

    def __init__(self, rig: str, *changes: str) -> None:
        self.settings = settings_of(rig, *changes)
        self.signals = {
            name: PlantSignal(False)
            for table in self.settings.rig.axis.values()
            for name in (table.probe_1, table.probe_2, *table.signals.values())
            if name
        }
        self.axes = {table.plant: Axis() for table in self.settings.rig.axis.values()}
        self.clock: Any = SimpleNamespace(now_ns=0)
        sensor = SimpleNamespace(reported_at=lambda _: (2e-3, 2e-3, True, False))
        plant: Any = SimpleNamespace(
            probes={n: SimpleNamespace(signal=s) for n, s in self.signals.items()},
            axes=self.axes,
            distances={"gap": sensor, "other": sensor},
            advance_to=lambda _: None,
        )
        self.beside = Beside(self.settings, plant, self.clock)

    def do(self, kind: str, cell: str) -> Act:
        (fault,) = read_faults(kind, cell, self.settings.rig)
        return KINDS[kind](self.beside, fault, random.Random(1))

    def edges(self, signal: str) -> list[tuple[int, bool]]:
        return list(self.beside.signal(signal).edges)


EDGES = [(1 * MS, True), (3 * MS, False)]
BENT = {
    "probe_late": ("by=700us", [(1_700_000, True), (3_700_000, False)]),
    "probe_stick": ("", []),
    "probe_chatter": (
        "pulses=1 period=200us",
        [(at + step, up) for at, level in EDGES for step, up in
         ((0, level), (100_000, not level), (200_000, level))],
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", BENT)
def test_a_wire_does_what_its_cell_says_on_off_and_on(kind: str) -> None:
    """One fault from 0 to 5 ms, none from 10 to 15 ms, another one from 20 to 25 ms."""
    keys, bent = BENT[kind]
    bench = Bench("probe-z.toml")
    first, second = (bench.do(kind, f"probe {keys}") for _ in range(2))
    for act, begin_ns in ((first, 0), (None, 10 * MS), (second, 20 * MS)):
        bench.clock.now_ns = begin_ns
        if act:
            act.begin()
        for at_ns, level in EDGES:
            bench.signals["probe"].add(begin_ns + at_ns, level)
        bench.clock.now_ns = begin_ns + 5 * MS
        if act:
            act.end()
        edges = [(at_ns - begin_ns, level) for at_ns, level in bench.edges("probe")]
        assert [edge for edge in edges if edge[0] > 0] == (bent if act else EDGES)
    assert [*bench.beside.wires] == ["probe"]
    plain = [(begin + at, level) for begin in (0, 10 * MS, 20 * MS) for at, level in EDGES]
    assert bench.signals["probe"].edges == plain  # the truth


def test_a_second_fault_of_a_wire_has_the_first_before_it() -> None:
    bench = Bench("probe-z.toml")
    for cell in ("probe by=700us", "probe by=200us"):
        bench.do("probe_late", cell).begin()
    bench.signals["probe"].add(1 * MS, True)
    bench.clock.now_ns = 5 * MS
    assert bench.edges("probe") == [(1_900_000, True)]


def test_a_switch_has_a_wire_as_a_probe_has() -> None:
    bench = Bench("homing-z-g74.toml")
    name = bench.settings.rig.axis["Z"].signals["home_switch"]
    bench.do("probe_late", f"{name} by=1ms").begin()
    bench.signals[name].add(2 * MS, True)
    bench.clock.now_ns = 5 * MS
    assert bench.beside.switches("Z")[HOME].edges == [(3 * MS, True)]


@pytest.mark.parametrize("number", [1, 2])
def test_a_drive_reads_what_comes_of_the_wire_at_either_input(tmp_path: Path, number: int) -> None:
    """Crossed or not: the wire belongs to the probe, and the drive beside it has its own."""
    rig = tmp_path / "two.toml"
    base = RIGS / "independent-xy.toml"
    lines = (f'base = "{base}"', "[axis.X]", 'probe_2 = "stop_y"', "[axis.Y]", 'probe_2 = "stop_x"')
    rig.write_text("\n".join(lines), "utf-8")
    bench = Bench(str(rig))
    bent, plain = ("stop_x", "stop_y") if number == 1 else ("stop_y", "stop_x")
    bench.do("probe_late", f"{bent} by=1ms").begin()
    bench.signals[bent].add(2 * MS, True)
    bench.clock.now_ns = 5 * MS
    wire = bench.beside.signal(bent)
    assert bench.beside.wires == {bent: wire}
    for axis, place in (("X", number - 1), ("Y", 2 - number)):
        inputs = bench.beside.probes(axis)
        assert (inputs[place], inputs[1 - place]) == (wire, bench.signals[plain])
        assert wire.edges == [(3 * MS, True)]
    bench.do("crossed", "X")
    assert bench.beside.probes("X")[2 - number] is wire
    assert bench.beside.probes("Y")[2 - number] is wire


def test_crossed_inputs_are_those_of_the_named_drive_alone(tmp_path: Path) -> None:
    """Each of the two drives has its own probe at input 1 and that of the other at input 2."""
    rig = tmp_path / "two.toml"
    base = RIGS / "independent-xy.toml"
    lines = (f'base = "{base}"', "[axis.X]", 'probe_2 = "stop_y"', "[axis.Y]", 'probe_2 = "stop_x"')
    rig.write_text("\n".join(lines), "utf-8")
    bench = Bench(str(rig))
    stop_x, stop_y = bench.signals["stop_x"], bench.signals["stop_y"]
    assert bench.beside.probes("X") == (stop_x, stop_y)
    act = bench.do("crossed", "X")
    for _ in range(2):  # from the start, whatever its moments
        assert bench.beside.probes("X") == (stop_y, stop_x)
        assert bench.beside.probes("Y") == (stop_y, stop_x)
        act.begin()
        act.end()
    bench.do("crossed", "Y")
    assert bench.beside.probes("Y") == (stop_x, stop_y)


def test_lost_increments_are_increments_of_the_drive() -> None:
    """1 048 576 a turn of 10 mm: 1000 are 9.5367 um. Two faults add up on one wire."""
    bench = Bench("probe-z.toml")
    acts = [bench.do("encoder_loss", f"Z increments={count}") for count in (1000, 500)]
    wire = bench.beside.axis("Z")
    assert wire.motor_position_m() == 0.100
    acts[0].begin()
    assert wire.motor_position_m() == pytest.approx(0.100 - 1000 / 1_048_576 * 0.010, abs=1e-12)
    acts[1].begin()
    acts[0].end()
    assert wire.motor_position_m() == pytest.approx(0.100 - 1500 / 1_048_576 * 0.010, abs=1e-12)


@pytest.mark.parametrize(("p", "low", "high"), [(0.01, 0, 7), (0.25, 30, 70), (1, 200, 200)])
def test_so_many_values_of_a_sensor_are_spikes(p: float, low: int, high: int) -> None:
    """Of 200: the mean, and more than three standard deviations on each side; p = 1: all."""
    bench = Bench("distance-z.toml")
    act = bench.do("sensor_spikes", f"gap um=30 p={p}")
    act.begin()
    bench.clock.now_ns = S
    sensor = bench.beside.sensor("gap")
    reported_um = [round(sensor.reported_at(ms * MS)[0] * 1e6) for ms in range(1, 201)]
    assert low <= sum(um != 2000 for um in reported_um) <= high
    assert {*reported_um} <= {1970, 2000, 2030}


def test_an_encoder_freezes_and_passes_all_else() -> None:
    """What the drive orders reaches the plant, with the position that it means."""
    bench = Bench("probe-z.toml")
    act = bench.do("encoder_freeze", "Z")
    wire, (axis,) = bench.beside.axis("Z"), bench.axes.values()
    act.begin()
    assert (wire.motor_velocity_m_s(), wire.second_encoder_m()) == (0.0, 0.101)
    act.end()
    assert (wire.motor_velocity_m_s(), wire.second_encoder_m_at(7)) == (0.02, 0.102)
    assert (wire.kinds, wire.limits_force, wire.force_n()) == (axis.kinds, True, 12.0)
    axis.calls.clear()
    wire.advance_to(1)
    wire.command_velocity(2, 0.1, 0.2, 3)
    wire.command_force(4, 5.0)
    wire.limit_force(-6.0, 7.0)
    assert axis.calls == [
        ("advance_to", 1),
        ("command_velocity", 2, 0.1, 0.2, 3),
        ("command_force", 4, 5.0),
        ("limit_force", -6.0, 7.0),
    ]


REPORTED_UM = {  # 4 ms after the begin, of a distance of 2 mm
    "sensor_drift": ("um_s=-500", {2000.0 - 500.0 * 0.004}),
    "sensor_full": ("um=9000", {9000.0}),
    "sensor_spikes": ("um=30 p=1", {1970.0, 2030.0}),
    "sensor_freeze": ("", {2000.0}),
}


@pytest.mark.parametrize("kind", REPORTED_UM)
def test_a_sensor_reports_what_its_cell_says_on_off_and_on(kind: str) -> None:
    keys, expected = REPORTED_UM[kind]
    bench = Bench("distance-z.toml")
    assert bench.beside.sensor("gap") is bench.beside.plant.distances["gap"]
    first, second = (bench.do(kind, f"gap {keys}") for _ in range(2))
    for begin_ms, call, reported_um in (
        (10, first.begin, expected),
        (20, first.end, {2000.0}),
        (30, second.begin, expected),
        (40, second.end, {2000.0}),
    ):
        bench.clock.now_ns = begin_ms * MS
        call()
        reported_m, *others = bench.beside.sensor("gap").reported_at((begin_ms + 4) * MS)
        assert round(reported_m * 1e6, 6) in reported_um
        assert others == [2e-3, True, False]


@pytest.mark.parametrize(
    ("cells", "reported_um"),
    [
        ((("sensor_drift", "um_s=500"), ("sensor_full", "um=9000")), 9000.0),
        ((("sensor_full", "um=9000"), ("sensor_drift", "um_s=500")), 9000.0 + 2.0),
        ((("sensor_drift", "um_s=500"), ("sensor_freeze", "")), 2000.0 + 2.0),
        ((("sensor_freeze", ""), ("sensor_drift", "um_s=500")), 2000.0 + 2.0),
        ((("sensor_drift", "um_s=500"), ("sensor_drift", "um_s=-250")), 2000.0 + 1.0),
    ],
)
def test_of_two_faults_of_a_sensor_the_second_bends_what_comes_of_the_first(
    cells: tuple[tuple[str, str], ...], reported_um: float
) -> None:
    """In the order of the cells, 4 ms after both begin; the truth stays."""
    bench = Bench("distance-z.toml")
    for kind, keys in cells:
        bench.do(kind, f"gap {keys}".rstrip()).begin()
    reported_m, *others = bench.beside.sensor("gap").reported_at(4 * MS)
    assert reported_m * 1e6 == pytest.approx(reported_um, abs=1e-6)
    assert others == [2e-3, True, False]


def test_a_second_encoder_that_is_the_sensor_sees_what_comes_of_it() -> None:
    bench = Bench("distance-z.toml")
    assert bench.settings.rig.axis["Z"].encoder_2 == "gap"
    act = bench.do("sensor_drift", "gap um_s=1000")
    wire = bench.beside.axis("Z")
    act.begin()
    bench.clock.now_ns = 1 * S
    assert wire.second_encoder_m() == pytest.approx(0.101 + 1e-3)
    assert wire.motor_position_m() == 0.100
    # A latch is looked up later: what counts is its own instant
    bench.clock.now_ns = 2 * S
    act.end()
    bench.clock.now_ns = 3 * S
    for at_s, drift_m in ((0, 0.0), (0.5, 0.5e-3), (1.5, 1.5e-3), (2, 0.0), (3, 0.0)):
        assert wire.second_encoder_m_at(round(at_s * S)) == pytest.approx(0.102 + drift_m)


def test_each_axis_that_reads_a_sensor_sees_what_comes_of_it(tmp_path: Path) -> None:
    """Of three axes two have the sensor as their second encoder; a second fault adds to it."""
    rig = tmp_path / "three.toml"
    axis = 'list = "{}"\nsegment = "can1"\nnode = {}\ndrive = "servo"\nplant = "{}"\n{}'
    base = settings_of("distance-z.toml").rig
    (own,) = base.axis.values()
    others = [("X", 21, 'encoder_2 = "other"'), ("Y", 22, 'encoder_2 = "gap"')]
    lines = [f'base = "{RIGS / "distance-z.toml"}"']
    for name, node, key in others:
        words = axis.format(own.list, node, name.lower(), key).replace("can1", own.segment)
        lines += [f"[axis.{name}]", words.replace('"servo"', f'"{own.drive}"')]
        lines += [f"[plant.{name.lower()}]", 'fmu = "AxisRig.Drives.ServoAxis"']
    wired = 'fmu = "AxisRig.Sensors.DistanceSensor"\nwire = { z = "x" }'
    rig.write_text("\n".join([*lines, "[plant.other]", wired]), "utf-8")
    bench = Bench(str(rig))
    acts = [bench.do("sensor_drift", f"gap um_s={rate}") for rate in (1000, 500)]
    for act in acts:
        act.begin()
    bench.clock.now_ns = 1 * S
    reported_m = {name: bench.beside.axis(name).second_encoder_m() for name in "XYZ"}
    expected_m = {"X": 0.101, "Y": 0.101 + 1.5e-3, "Z": 0.101 + 1.5e-3}
    assert reported_m == pytest.approx(expected_m, abs=1e-12)


def test_a_task_and_a_clock_have_the_values_of_their_cells() -> None:
    """Late by 2 ms and 0 to 1 ms; the clock 30 us ahead, or 100 ppm too slow for 2 s."""
    bench = Bench("plc-signal.toml")
    lost, late = bench.do("plc_lost", "plc"), bench.do("plc_late", "plc by=2ms jitter=1ms")
    task = bench.beside.task
    lost.begin()
    assert (task.is_lost(0), task.late_ns(0)) == (True, 0)
    late.begin()
    found = [task.late_ns(at_ns) for at_ns in range(200)]
    assert 2 * MS <= min(found) < 2.1 * MS
    assert 2.9 * MS < max(found) <= 3 * MS
    bench.clock.now_ns = 1 * S
    lost.end()
    assert (task.is_lost(1 * S), task.late_ns(1 * S) >= 2 * MS) == (False, True)
    late.end()
    assert task.late_ns(1 * S) == 0

    bench = Bench("manual-el1252.toml")
    for cell, off_ns in (("clock_off", 30 * US), ("clock_drift", -200 * US)):
        keys = "by=30us" if cell == "clock_off" else "ppm=-100"
        act = bench.do(cell, f"terminal {keys}")
        bench.clock.now_ns = 5 * S
        act.begin()
        assert bench.beside.stamps.off_ns(7 * S) == off_ns
        bench.clock.now_ns = 8 * S
        act.end()
        assert bench.beside.stamps.off_ns(8 * S) == 0
