"""Moments of two axes: which of them counts, when each is noticed, and what was so before."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.machine.faults.when import Moments, Watched
from axisrig.bench.rig.reading.faults import read_faults
from axisrig.bench.rig.reading.file import read_rig
from axisrig.kernel.time.clock import MS, US, Phase
from axisrig.kernel.time.scheduler import new_scheduler

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

RIG, _ = read_rig(Path(__file__).parents[2] / "testplans" / "rigs" / "probes-older.toml")
Condition = tuple[str, str]
"""A moment, and the axis that has it."""


class Bench:
    """Axes X and Z, each with its two probes and latches; NC cycles of 1 ms.

    begun, ended: instants in us of a fault.
    """

    def __init__(self, *, is_running: bool = True, input_of: int = 1, edge: str = "POS") -> None:
        self.clock, self.begun, self.ended = new_scheduler(), list[float](), list[float]()
        self.channel: Any = SimpleNamespace(
            start_ns=0 if is_running else None,
            observers=[],
            interpolator=SimpleNamespace(is_standing=False),
        )
        self.number, self.is_rising = input_of, edge == "POS"
        self.signals = {
            f"{axis}{n}": SimpleNamespace(level=not self.is_rising, watches=[])
            for axis in "XZ"
            for n in (1, 2)
        }
        self.latches = {name: self._latch() for name in self.signals}
        self.links = {
            axis: SimpleNamespace(probe_input=input_of, edge=edge, has_latched=False)
            for axis in "XZ"
        }
        self.drives = {
            axis: SimpleNamespace(
                latches=[self.latches[f"{axis}{n}"] for n in (1, 2)], latch_watches=[]
            )
            for axis in "XZ"
        }
        tables = {
            axis: RIG.axis["Z"].model_copy(update={"probe_1": f"{axis}1", "probe_2": f"{axis}2"})
            for axis in "XZ"
        }
        plant = SimpleNamespace(
            probes={name: SimpleNamespace(signal=signal) for name, signal in self.signals.items()}
        )
        self.watched: Any = (self.clock, self.channel, self.links, self.drives, plant)
        self.watched = Watched(RIG.model_copy(update={"axis": tables}), *self.watched)
        self.record = Injected("power_loss", "Z")
        self.clock.call_at(MS, Phase.APPLICATION, self._cycle)

    @staticmethod
    def _latch() -> Any:
        latch = SimpleNamespace(is_enabled=False, stored=set[bool]())
        latch.has_stored = latch.stored.__contains__
        return latch

    def _cycle(self) -> None:
        self.clock.call_at(self.clock.now_ns + MS, Phase.APPLICATION, self._cycle)
        for observer in self.channel.observers:
            observer(self.channel)

    def fault(self, keys: str, axes: str = "XZ", *, is_early: bool = False) -> None:
        (fault,) = read_faults("power_loss", f"Z {keys}".rstrip(), RIG)
        act = Act(lambda: self._note(self.begun), lambda: self._note(self.ended), is_early)
        Moments(self.watched).run(fault, act, axes, self.record)

    def _note(self, instants: list[float]) -> None:
        instants.append(self.clock.now_ns / US)

    def turn(self, condition: Condition, is_so: bool, at_us: float | None = None) -> None:
        """Let a condition become true, or not any more, at an instant; at once without one."""
        if at_us is not None:
            self.clock.run_until(round(at_us * US))
        moment, axis = condition
        name = f"{axis}{self.number}"
        signal, latch, drive = self.signals[name], self.latches[name], self.drives[axis]
        if moment == "edge":
            signal.level = is_so is self.is_rising
            for watch in signal.watches:
                watch(self.clock.now_ns)
        elif moment == "armed":
            latch.is_enabled = is_so
        elif moment == "latched":
            latch.stored.clear()
            latch.stored.update({self.is_rising} if is_so else ())
        elif moment == "seen":
            self.links[axis].has_latched = is_so
        elif moment == "motion":
            self.channel.interpolator.is_standing = not is_so
        else:
            self.channel.interpolator.is_standing = is_so
        if moment in ("armed", "latched"):
            for look in drive.latch_watches:
                look()

    def run(self, until_us: float) -> list[float]:
        self.clock.run_until(round(until_us * US))
        return self.begun


@pytest.mark.parametrize("edge", ["POS", "NEG"])
@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("axis", ["X", "Z"])
@pytest.mark.parametrize("moment", ["edge", "armed", "latched"])
def test_what_comes_between_two_nc_cycles_is_noticed_at_its_instant_of_every_axis(
    moment: str, axis: str, number: int, edge: str
) -> None:
    bench = Bench(input_of=number, edge=edge)
    bench.fault(f"at={moment} for=1ms")
    bench.turn((moment, axis), True, 2300)
    assert bench.run(4000) == [2300]
    assert bench.ended == [3300]
    assert (bench.record.begin_ns, bench.record.end_ns) == (2300 * US, 3300 * US)


@pytest.mark.parametrize("axis", ["X", "Z"])
@pytest.mark.parametrize("moment", ["seen", "motion", "standing"])
def test_what_the_control_notices_comes_with_its_cycle_of_every_axis(
    moment: str, axis: str
) -> None:
    bench = Bench()
    bench.turn((moment, axis), False)
    bench.fault(f"at={moment}")
    bench.turn((moment, axis), True, 2300)
    assert bench.run(6000) == [3000]


@pytest.mark.parametrize("other", ["other input", "other edge", "other moment"])
def test_what_is_of_another_input_edge_or_kind_is_no_moment(other: str) -> None:
    bench = Bench()
    bench.fault("at=latched")
    latches = bench.drives["Z"].latches
    if other == "other input":
        latches[1].stored.add(True)
    elif other == "other edge":
        latches[0].stored.add(False)
    else:
        latches[0].is_enabled = True
    for look in bench.drives["Z"].latch_watches:
        look()
    assert bench.run(3000) == []
    bench.turn(("latched", "Z"), True)
    assert bench.run(4000) == [3000]


@pytest.mark.parametrize("moment", ["edge", "armed", "latched", "seen", "motion", "standing"])
def test_what_is_so_when_the_program_starts_has_to_come_up_again(moment: str) -> None:
    """It came up before the start, at 1.5 ms; the program starts at 2.2 ms."""
    bench = Bench(is_running=False)
    bench.turn((moment, "Z"), False)
    bench.fault(f"at={moment}")
    bench.turn((moment, "Z"), True, 1500)
    bench.run(2200)
    bench.channel.start_ns = 2200 * US
    assert bench.run(4500) == []
    bench.turn((moment, "Z"), False)
    assert bench.run(5500) == []
    bench.turn((moment, "Z"), True)
    later = 5500 if moment in ("edge", "armed", "latched") else 6000
    assert bench.run(7000) == [later]


def test_a_moment_before_the_start_does_not_count_among_the_nth() -> None:
    bench = Bench(is_running=False)
    bench.fault("at=edge nth=2")
    for at_us, is_so in ((1100, True), (1200, False)):
        bench.turn(("edge", "Z"), is_so, at_us)
    bench.channel.start_ns = 1300 * US
    for at_us, is_so in ((2100, True), (2200, False), (3100, True), (3200, False), (4100, True)):
        bench.turn(("edge", "Z"), is_so, at_us)
    assert bench.run(6000) == [3100]


def test_of_two_axes_a_moment_comes_when_the_first_has_it_and_again_when_none_had_it() -> None:
    """X from 1.1 to 1.5 ms, Z from 1.3 to 1.7 ms: one moment; Z again at 2.1 ms: the second."""
    for nth, begun in ((1, 1100), (2, 2100)):
        bench = Bench()
        bench.fault(f"at=edge nth={nth}")
        for at_us, axis, is_so in (
            *((1100, "X", True), (1300, "Z", True), (1500, "X", False), (1700, "Z", False)),
            (2100, "Z", True),
        ):
            bench.turn(("edge", axis), is_so, at_us)
        assert bench.run(4000) == [begun]


@pytest.mark.parametrize(("offset", "begun"), [("+0.4ms", 2700), ("+0ms", 2300), ("+2500us", 4800)])
def test_an_offset_counts_from_the_edge(offset: str, begun: float) -> None:
    bench = Bench()
    bench.fault(f"at=edge{offset}")
    bench.turn(("edge", "Z"), True, 2300)
    assert bench.run(6000) == [begun]


@pytest.mark.parametrize(("is_early", "called"), [(False, [1500]), (True, [1500, 1500])])
def test_without_a_moment_what_is_early_is_there_before_the_first_event(
    is_early: bool, called: list[float]
) -> None:
    """It begins as it is built in, and with its event like every other; it is noted once."""
    bench = Bench()
    bench.run(1500)
    bench.fault("for=0.5ms", is_early=is_early)
    assert bench.begun == called[1:]
    assert bench.record.begin_ns is None
    assert bench.run(3000) == called
    assert bench.ended == [2000]
    assert (bench.record.begin_ns, bench.record.end_ns) == (1500 * US, 2000 * US)


def test_without_a_time_a_fault_does_not_end() -> None:
    bench = Bench()
    bench.fault("at=edge")
    bench.turn(("edge", "Z"), True, 1300)
    bench.turn(("edge", "Z"), False, 1400)
    bench.run(9000)
    assert (bench.begun, bench.ended, bench.record.end_ns) == ([1300], [], None)
