"""Real drives are led out of operation before they are let go, with drives by hand."""

from collections.abc import Iterable
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.machine.canopen.family import CanBuses
from axisrig.bench.machine.leaving import POWER_DOWN_CYCLES_MAX, power_down
from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.pacing import Hardware
from axisrig.kernel.channel import ChannelState
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import Scheduler

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

PERIOD_NS, OFFSET_NS = 2 * MS, 600 * US


class Link:
    """A drive that is off after so many set values; silent: from so many telegrams on."""

    def __init__(self, name: str, clock: Any, off_after: int, silent: int | None = None) -> None:
        self.name, self.set_mm, self._clock = name, 10.0 + len(name), clock
        self._off_after, self._silent = off_after, silent
        self.calls: list[tuple[Any, ...]] = []
        self.times_ns: list[int] = []

    @property
    def is_off(self) -> bool:
        return len(self.times_ns) >= self._off_after

    def order(self, order: PowerOrder) -> None:
        self.calls.append(("order", order))

    def disarm(self) -> None:
        self.calls.append(("disarm",))

    def begin_cycle(self) -> None:
        self.calls.append(("begin", self._clock.now_ns))

    def take(self) -> None:
        if self._silent is not None and len(self.times_ns) >= self._silent:
            raise Alarm(900730, axis=self.name, cycles=3)

    def send(self, set_mm: float) -> None:
        assert set_mm == self.set_mm  # it stays where it is
        self.times_ns.append(self._clock.now_ns)


class Part:
    """What some drives belong to."""

    def __init__(self, *links: Link) -> None:
        self.links = {link.name: link for link in links}
        self.gone: list[list[str]] = []

    def is_off(self, axis: str) -> bool:
        return self.links[axis].is_off

    def let_go(self, axes: Any) -> None:
        assert all(self.links[axis].times_ns for axis in axes)
        self.gone.append([*axes])


def left(*parts: Part, clock: Scheduler) -> list[int]:
    """Leave them all, and return when the carrier began a cycle."""
    begins: list[int] = []
    carrier: Any = SimpleNamespace(begin_cycle=lambda: begins.append(clock.now_ns))
    part_of: Any = {axis: part for part in parts for axis in part.links}
    timing: Any = SimpleNamespace(period_ns=PERIOD_NS, offset_ns=OFFSET_NS)
    power_down(clock, part_of, [carrier], timing)
    return begins


def test_all_drives_go_out_of_operation_in_the_same_cycles() -> None:
    """One is off after 3 cycles, one of another segment after 5: both go on until then."""
    clock = Scheduler()
    clock.run_until(7 * MS)
    x, y, z = Link("X", clock, 3), Link("Y", clock, 5), Link("Z", clock, 1)
    first, second = Part(x, z), Part(y)
    begins = left(first, second, clock=clock)
    assert begins == [7 * MS + number * PERIOD_NS for number in range(5)]
    for link in (x, y, z):
        assert link.times_ns == [begin + OFFSET_NS for begin in begins]
        assert link.calls[:2] == [("order", PowerOrder.SWITCH_OFF), ("disarm",)]
        assert link.calls[2:] == [("begin", begin) for begin in begins]
    assert (first.gone, second.gone) == ([["X", "Z"]], [["Y"]])
    assert clock.now_ns == 7 * MS + 6 * PERIOD_NS  # a cycle in which what lets them go is sent


@pytest.mark.parametrize("silent", [0, 2])
def test_a_drive_that_says_nothing_is_not_waited_for(silent: int) -> None:
    clock = Scheduler()
    x, y = Link("X", clock, 10_000, silent), Link("Y", clock, 4)
    part = Part(x, y)
    assert len(left(part, clock=clock)) == 4  # until the other one is off
    assert part.gone == [["X", "Y"]]


def test_a_drive_that_stays_on_is_let_go_after_all() -> None:
    clock = Scheduler()
    part = Part(Link("X", clock, 10_000))
    assert len(left(part, clock=clock)) == POWER_DOWN_CYCLES_MAX
    assert part.gone == [["X"]]


# --- while it runs: an operator who stops, interfaces that are lost


class Outside(OutsideSegment):
    """A segment on an interface that may be lost."""

    def __init__(self) -> None:  # nothing is opened
        self.lost = None


def words_of(alarms: Iterable[Alarm]) -> list[tuple[int, dict[str, object]]]:
    return [(alarm.id, alarm.values) for alarm in alarms]


def gone(segment: str, reason: str) -> tuple[int, dict[str, object]]:
    return 900071, {"segment": segment, "reason": reason}


def of_can(**segments: Any) -> CanBuses:
    buses = CanBuses.__new__(CanBuses)
    buses.segments, buses._lost = segments, set()
    return buses


def test_each_interface_that_is_lost_is_an_alarm_once() -> None:
    first, second = Outside(), Outside()
    buses = of_can(can1=first, can2=second, can3=SimpleNamespace(lost="simulated"))
    assert [*buses.look()] == []
    second.lost = "adapter is gone"
    assert words_of(buses.look()) == [gone("can2", "adapter is gone")]
    assert [*buses.look()] == []
    first.lost = "no power"
    assert words_of(buses.look()) == [gone("can1", "no power")]
    assert [*buses.look()] == []


def test_the_program_is_stopped_once_by_the_operator_and_by_each_alarm() -> None:
    wants, lost = [False], Outside()
    stops: list[Alarm] = []
    machine: Any = SimpleNamespace(
        is_stopped=False,
        installed=[of_can(can1=Outside()), of_can(can2=lost)],
        channel=SimpleNamespace(stop=stops.append),
    )
    hardware = Hardware(SimpleNamespace(), lambda: wants[0])  # type: ignore[arg-type]

    def look() -> list[Any]:
        Machine._look_outside(machine, hardware)
        return words_of(stops)

    assert look() == []
    assert not machine.is_stopped
    wants[0] = True
    assert look() == [(900070, {})]
    assert machine.is_stopped
    lost.lost = "adapter is gone"
    assert look() == look() == [(900070, {}), gone("can2", "adapter is gone")]


def test_a_machine_leaves_the_drives_that_are_outside_whatever_its_channel_does() -> None:
    """X and Z are there, Y is simulated; the carriers of both segments go on, each once."""
    clock = Scheduler()
    x, y, z = Link("X", clock, 2), Link("Y", clock, 1), Link("Z", clock, 3)
    first, second = Part(x, y), Part(z)
    begins: list[str] = []
    rig = SimpleNamespace(axis={n: SimpleNamespace(segment=f"can{n}") for n in "XYZ"})
    machine: Any = SimpleNamespace(
        channel=SimpleNamespace(state=ChannelState.RUNNING),
        part_of={"X": first, "Y": first, "Z": second},
        outside=("X", "Z"),
        settings=SimpleNamespace(rig=rig),
        _carriers={
            f"can{name}": SimpleNamespace(begin_cycle=lambda name=name: begins.append(name))
            for name in "XYZ"
        },
        scheduler=clock,
        timing=SimpleNamespace(period_ns=PERIOD_NS, offset_ns=OFFSET_NS),
    )
    Machine._leave(machine)
    assert machine.channel.state is ChannelState.ENDED
    assert [len(link.times_ns) for link in (x, y, z)] == [3, 0, 3]
    assert begins == ["X", "Z"] * 3
    assert (first.gone, second.gone) == ([["X"]], [["Z"]])


def test_each_drive_is_led_to_pre_operational_on_its_own_bus() -> None:
    """CiA 301: NMT has identifier 0, command 128 and the node."""
    sent: list[tuple[str, int, bytes]] = []

    def link(bus: str, node_id: int) -> Any:
        network = SimpleNamespace(
            send_message=lambda can_id, data: sent.append((bus, can_id, data))
        )
        return SimpleNamespace(network=network, node_id=node_id)

    buses = of_can()
    buses.links = {"X": link("can1", 1), "Y": link("can1", 2), "Z": link("can2", 0x7F)}
    buses.let_go(["X", "Z"])
    assert sent == [("can1", 0, bytes((128, 1))), ("can2", 0, bytes((128, 127)))]
