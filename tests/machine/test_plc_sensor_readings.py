"""Which instant of a distance sensor a V.E. variable shows, how often, and in which unit."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.plc.sensors import PlcSensors
from axisrig.bench.rig.reading.plc_sensors import DELAY_MAX, PlcSensorTable
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


class Sensor:
    """Shows 1 um for each ms of the instant that it is asked for, and `lift_um` more."""

    def __init__(self, lift_um: float = 0.0) -> None:
        self.asked: list[int] = []
        self._lift_um = lift_um

    def reported_at(self, time_ns: int) -> tuple[float, float | None, bool, bool]:
        self.asked.append(time_ns // MS)
        return (self._lift_um + time_ns / MS) * 1e-6, None, True, False


class Plc:
    """A PLC side with these entries; a cycle each ms, whose SYNC is at its begin."""

    def __init__(self, cycle_ns: int = MS, **entries: dict[str, Any]) -> None:
        self.plc = PlcInterface(Scheduler(), ("Z",))
        self.sensors = {f"of_{name}": Sensor(lift_um=1000.0 * n) for n, name in enumerate(entries)}
        tables = {
            f"V.E.{name}": PlcSensorTable(sensor=f"of_{name}", **keys)
            for name, keys in entries.items()
        }
        self.now_ns, self._cycle_ns = 10 * MS, cycle_ns
        of_them: Any = self.sensors
        self.taker = PlcSensors(tables, of_them, self.plc, lambda: self.now_ns, cycle_ns)

    def cycles(self, count: int) -> list[dict[str, float]]:
        found = []
        for _ in range(count):
            self.taker.take()
            found.append(dict(self.plc.values))
            self.now_ns += self._cycle_ns
        return found


@pytest.mark.parametrize(
    ("keys", "values"),
    [
        ({}, [100.0, 110.0, 120.0]),  # of 0.1 um
        ({"unit_um": 1.0}, [10.0, 11.0, 12.0]),
        ({"unit_um": 4.0}, [2.0, 3.0, 3.0]),  # 2.5, 2.75, 3: whole numbers, half to even
        ({"unit_um": 0.5, "sign": -1}, [-20.0, -22.0, -24.0]),
    ],
)
def test_a_value_is_a_whole_number_of_its_unit(keys: dict[str, Any], values: list[float]) -> None:
    assert [each["S"] for each in Plc(S=keys).cycles(3)] == values


@pytest.mark.parametrize("delay", [1, 3, DELAY_MAX])
def test_a_value_is_so_many_cycles_old_and_the_first_one_until_then(delay: int) -> None:
    plc = Plc(S={"delay_cycles": delay}, T={})
    plc.cycles(delay + 3)
    assert plc.sensors["of_S"].asked == [10] * delay + [10, 11, 12]
    assert plc.sensors["of_T"].asked == [*range(10, 13 + delay)]


def test_each_variable_has_its_own_sensor_and_period() -> None:
    """Read in every cycle, in every third, and in every second although 2.9 ms are promised."""
    plc = Plc(S={}, T={"period_ms": 3.0}, U={"period_ms": 2.9})
    found = plc.cycles(5)
    asked = [plc.sensors[f"of_{name}"].asked for name in "STU"]
    assert asked == [[10, 11, 12, 13, 14], [10, 13], [10, 12, 14]]
    assert found[4] == {"S": 140.0, "T": 10_130.0, "U": 20_140.0}


def test_the_age_of_a_promised_value_counts_from_its_reading() -> None:
    plc = Plc(S={}, T={"period_ms": 3.0})
    refreshed = plc.plc.refreshed
    assert [*refreshed] == ["T"]
    assert refreshed["T"].period_ns == 3 * MS
    ages = []
    for _ in range(7):
        plc.cycles(1)
        ages.append(refreshed["T"].age_cycles)
    assert ages == [0, 1, 2, 0, 1, 2, 0]


@pytest.mark.parametrize(("silent_ms", "last"), [(3.0, 12), (3.1, 13), (0.0, None)])
def test_a_sensor_is_not_read_from_its_silence_on(silent_ms: float, last: int | None) -> None:
    """The value stays and gets older."""
    plc = Plc(S={"silent_from_ms": silent_ms, "period_ms": 1.0})
    found = plc.cycles(6)
    asked = plc.sensors["of_S"].asked
    assert asked == ([] if last is None else [*range(10, last + 1)])
    assert found[-1].get("S") == (None if last is None else last * 10.0)
    assert plc.plc.refreshed["S"].age_cycles == 6 - len(asked)


def test_cycles_of_2_ms_are_counted_as_such() -> None:
    plc = Plc(2 * MS, S={"period_ms": 4.0, "silent_from_ms": 8.0})
    plc.cycles(6)
    assert plc.sensors["of_S"].asked == [10, 14]


@pytest.mark.parametrize(
    ("syncs_ms", "channel_ms", "read_ms"),
    [
        ((5, 7), 5, 7),  # of the drive that had its SYNC last
        ((7, 5), 7, 7),
        ((4, 4), 5, 6),  # nobody has heard the one of this cycle: where the plant is
        ((), 5, 6),
    ],
)
def test_the_plc_reads_at_the_last_sync_of_the_cycle(
    syncs_ms: tuple[int, ...], channel_ms: int, read_ms: int
) -> None:
    sensor = Sensor()
    plc = PlcInterface(Scheduler(), ("Z",))
    machine: Any = SimpleNamespace(
        channel=SimpleNamespace(plc=plc, sync_ns=channel_ms * MS),
        drives={str(n): SimpleNamespace(sync_ns=at * MS) for n, at in enumerate(syncs_ms)},
        plant=SimpleNamespace(now_ns=6 * MS),
        settings=SimpleNamespace(rig=SimpleNamespace(plc={"V.E.S": PlcSensorTable(sensor="gap")})),
        beside=SimpleNamespace(sensor={"gap": sensor}.__getitem__),
        timing=SimpleNamespace(period_ns=MS),
    )
    Machine._connect_plc_sensors(machine)
    (take,) = plc.inputs
    take()
    assert sensor.asked == [read_ms]
    machine.settings.rig.plc = {}
    Machine._connect_plc_sensors(machine)
    assert len(plc.inputs) == 1  # without an entry nobody reads


def test_a_promise_may_be_a_part_of_a_millisecond() -> None:
    """The period of the entry, and none for an entry that promises nothing."""
    for period_ms, period_ns in ((0.5, 500_000), (2.25, 2_250_000), (3.0, 3 * MS)):
        plc = Plc(cycle_ns=MS // 4, A={"period_ms": period_ms}, B={})
        assert {name: one.period_ns for name, one in plc.plc.refreshed.items()} == {"A": period_ns}
        values = [found["A"] for found in plc.cycles(2 * period_ns // (MS // 4) + 1)]
        changes = [n for n in range(1, len(values)) if values[n] != values[n - 1]]
        assert changes == [period_ns * turn // (MS // 4) for turn in (1, 2)]
