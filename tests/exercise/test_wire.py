"""A family of drives is made of new folders only: the channel runs a toy without CAN or CiA 402."""

import ast
from pathlib import Path

import pytest
from tests.architecture.sources import imported_names
from tests.channel.conftest import AxisSpec, Words
from tests.exercise.wire.control import Wire, WireDrive, Wires, WireWatch

from axisrig.bench.campaign.results.build_info import is_compiled
from axisrig.kernel.channel import Channel, CycleTiming, Surroundings
from axisrig.kernel.channel.path.monitor import Monitor
from axisrig.kernel.drives.settings import DriveSettings
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS, US, S
from axisrig.kernel.time.scheduler import new_scheduler

SWITCH_MM, PER_MM = 5.0123, 1e4
pytestmark = pytest.mark.skipif(is_compiled(), reason="the toy is written in Python alone")


class AtOnce:
    """A far end without an axis: it is at its set position at once, and latches a switch there."""

    def __init__(self, wire: Wire, switch_mm: float) -> None:
        self._wire, self._switch_mm = wire, switch_mm

    def exchange(self) -> None:
        wire, before_mm = self._wire, self._wire.actual_mm
        wire.actual_mm = wire.set_mm if wire.is_on else before_mm
        crosses = before_mm < self._switch_mm <= wire.actual_mm
        if wire.is_armed and crosses and wire.latched_mm is None:
            wire.latched_mm = self._switch_mm
        wire.level = wire.actual_mm >= self._switch_mm
        wire.is_armed = wire.is_ordered


class Bench:
    """Two drives on wires: Y with its switch out of reach, X that meets its own."""

    def __init__(self) -> None:
        self.scheduler, self.is_cut = new_scheduler(), False
        self.drives = [
            WireDrive(DriveSettings("X", PER_MM, lag_delay_cycles=2), Wire()),
            WireDrive(DriveSettings("Y", 2 * PER_MM, lag_delay_cycles=2), Wire()),
        ]
        places = zip(self.drives, (SWITCH_MM, 1000.0), strict=True)
        ends = [AtOnce(drive.wire, switch_mm).exchange for drive, switch_mm in places]
        self.wires = Wires("wires", list(ends))
        watches = [WireWatch(drive, lambda: self.is_cut) for drive in self.drives]
        self.channel = Channel(
            self.scheduler,
            CycleTiming(MS, 600 * US),
            [AxisSpec("X").settings(), AxisSpec("Y").settings()],
            self.drives,
            Surroundings(
                put_out=lambda _: None, monitor=Monitor(self.drives, [self.wires], watches)
            ),
        )

    def run(self, *commands: canon.Command, cut_after_ns: int | None = None) -> None:
        self.channel.load(iter(commands))
        self.channel.start()
        if cut_after_ns is not None:
            self.scheduler.run_until(cut_after_ns)
            self.is_cut = True
        assert self.scheduler.run_while(lambda: not self.channel.has_ended, 20 * S)


def test_axes_move_and_measure() -> None:
    """The switch is met between two cycles; what it latches is where it is."""
    words, bench = Words(), Bench()
    bench.run(
        words.move(1, 3000.0, X=2.0, Y=-3.0),
        words.probe(2, 600.0, X=20.0),
        words.wait(3),
        words.end(),
    )
    assert bench.channel.alarms == []
    assert bench.channel.measured_acs_mm("X") == SWITCH_MM
    assert SWITCH_MM < bench.drives[0].wire.actual_mm < SWITCH_MM + 0.2
    assert bench.drives[1].wire.actual_mm == -3.0
    assert bench.wires.cycles > 100


def test_a_cut_wire_is_an_alarm_of_its_watch() -> None:
    words, bench = Words(), Bench()
    bench.run(words.move(1, 3000.0, X=400.0), words.end(), cut_after_ns=100 * MS)
    assert [alarm.id for alarm in bench.channel.alarms] == [900030]
    assert bench.drives[0].wire.actual_mm < 400.0


@pytest.mark.parametrize("name", ["control", "servo", "keys", "family"])
def test_it_needs_nothing_of_can_or_cia_402(name: str) -> None:
    """By its own imports; what a machine is made of knows CANopen."""
    tree = ast.parse((Path(__file__).parent / "wire" / f"{name}.py").read_text(encoding="utf-8"))
    ours = {name for _, name in imported_names(tree) if name.startswith("axisrig.")}
    assert ours
    assert not [name for name in ours if "canopen" in name or "cia402" in name or ".bus." in name]
