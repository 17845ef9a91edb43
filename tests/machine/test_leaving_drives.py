"""Real drives are led out of operation before they are let go, with drives by hand."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.leaving import POWER_DOWN_CYCLES_MAX, power_down
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
