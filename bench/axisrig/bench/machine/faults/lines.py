"""Faults of EtherCAT lines: their cyclic frames, and the slaves with their clocks."""

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

from axisrig.bench.bus.ethercat.frame import datagrams
from axisrig.bench.drive.cia402.node import Cia402Node
from axisrig.bench.machine.faults.acts import Act, Injected, nothing
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.machine.faults.when import hits_of, windowed
from axisrig.bench.rig.reading.faults import Fault
from axisrig.kernel.profiles.ethercat.tables import AlState, Command
from axisrig.kernel.time.clock import Clock, TimeNs

Passing = Callable[[bytearray], TimeNs | None]
"""Gets a cyclic frame that leaves; returns how much later it goes, None = it is lost."""


class Disturbed(Protocol):
    """A line as its faults see it."""

    def disturb(self, passing: Passing) -> None:
        """Let each cyclic frame pass there too."""
        ...

    def breaks(self, axis: str, falls: Callable[[], bool]) -> None:
        """Break each cyclic frame before the slave of an axis for which this returns true."""
        ...

    def fall(self, axis: str, state: AlState, code: str) -> None:
        """Let the slave of an axis fall to a state with an AL status code by its name."""
        ...

    def jump(self, axis: str, by_ns: TimeNs) -> None:
        """Let the clock of a slave show a later time at once."""
        ...


@dataclass(frozen=True)
class OnLine:
    """The line that a fault acts on, and the virtual drives on it by axis."""

    clock: Clock
    line: Disturbed
    nodes: Mapping[str, Cia402Node]


Make = Callable[[OnLine, Fault, random.Random, Injected], Act]
_Action = Callable[[Mapping[str, Any], bytearray, random.Random], TimeNs | None]


def _lose(_values: Mapping[str, Any], _frame: bytearray, _numbers: random.Random) -> None:
    return None


def _wait(values: Mapping[str, Any], _frame: bytearray, numbers: random.Random) -> TimeNs:
    late_ns: TimeNs = values["by"] + numbers.randint(0, values["jitter"])
    return late_ns


def _spoil(_values: Mapping[str, Any], frame: bytearray, _numbers: random.Random) -> TimeNs:
    """Make the datagram of the process image one that no slave acts on."""
    for datagram in datagrams(frame):
        if datagram.command == Command.LRW:
            frame[datagram.start] = Command.NOP
    return 0


def _of_frames(
    action: _Action, on: OnLine, fault: Fault, numbers: random.Random, record: Injected
) -> Act:
    hits, record.hits = hits_of(fault, numbers), 0

    def passing(frame: bytearray) -> TimeNs | None:
        if not hits.falls():
            return 0
        record.count(on.clock.now_ns)
        return action(fault.values, frame, numbers)

    on.line.disturb(passing)
    return windowed(hits.window)


def _corrupt(on: OnLine, fault: Fault, numbers: random.Random, record: Injected) -> Act:
    hits, record.hits = hits_of(fault, numbers), 0

    def falls() -> bool:
        is_hit = hits.falls()
        if is_hit:
            record.count(on.clock.now_ns)
        return is_hit

    on.line.breaks(fault.axis, falls)
    return windowed(hits.window)


def _fall(on: OnLine, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    state, code = AlState[fault.values["state"]], fault.values["code"]
    return Act(partial(on.line.fall, fault.axis, state, code), nothing)


def _jump(on: OnLine, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    return Act(partial(on.line.jump, fault.axis, fault.values["by"]), nothing)


KINDS: Mapping[str, Make] = {
    "line_lost": partial(_of_frames, _lose),
    "line_late": partial(_of_frames, _wait),
    "line_unanswered": partial(_of_frames, _spoil),
    "line_corrupt": _corrupt,
    "slave_falls": _fall,
    "clock_jump": _jump,
}
"""How each kind of the room `lines` is built in."""


def points(machine: Equipped) -> Points:
    """Return lines whose frames can be disturbed, and axes whose slaves can fail."""
    return points_of(machine, KINDS)
