"""Faults of EtherCAT lines: cyclic frames that get lost, come late or are not acted on."""

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

from axisrig.bench.bus.ethercat.frame import datagrams
from axisrig.bench.machine.faults.acts import Act, Injected, nothing
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.machine.faults.when import hits_of, windowed
from axisrig.bench.rig.reading.faults import Fault
from axisrig.kernel.profiles.ethercat.tables import Command
from axisrig.kernel.time.clock import Clock, TimeNs

Passing = Callable[[bytearray], TimeNs | None]
"""Gets a cyclic frame that leaves; returns how much later it goes, None = it is lost."""


class Disturbed(Protocol):
    """A line as its faults see it."""

    def disturb(self, passing: Passing) -> None:
        """Let each cyclic frame pass there too."""
        ...

    def fall(self, axis: str, code: str) -> None:
        """Let the slave of an axis fall to SAFEOP with an AL status code by its name."""
        ...


@dataclass(frozen=True)
class OnLine:
    """The line that a fault acts on."""

    clock: Clock
    line: Disturbed


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


def _fall(on: OnLine, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    return Act(partial(on.line.fall, fault.axis, "WATCHDOG"), nothing)


KINDS: Mapping[str, Make] = {
    "line_lost": partial(_of_frames, _lose),
    "line_late": partial(_of_frames, _wait),
    "line_unanswered": partial(_of_frames, _spoil),
    "slave_falls": _fall,
}
"""How each kind of the room `lines` is built in."""


def points(machine: Equipped) -> Points:
    """Return lines whose frames can be disturbed, and axes whose slaves can fall."""
    return points_of(machine, KINDS)
