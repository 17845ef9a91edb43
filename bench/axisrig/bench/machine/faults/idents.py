"""Faults of drives with idents: real-time bits on the wire, the service channel, its commands."""

import random
from collections.abc import Callable, Mapping
from typing import Protocol, cast

from axisrig.bench.machine.faults.acts import Act, Injected, nothing
from axisrig.bench.machine.faults.lines import OnLine
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.machine.faults.when import hits_of, windowed
from axisrig.bench.rig.reading.faults import Fault


class WithIdents(Protocol):
    """A virtual drive with idents as its faults see it."""

    def hold_bit(self, name: str, *, level: bool | None) -> None:
        """Let a real-time bit keep its level on the wire; None: it passes again."""
        ...

    def disturb_channel(self, answers: Callable[[], str | None]) -> None:
        """Ask this before each request: None, "" = no answer, name of the code that refuses it."""
        ...

    def interrupt_probing(self) -> None:
        """Let the probing cycle end by itself."""
        ...


Make = Callable[[OnLine, Fault, random.Random, Injected], Act]


def _drive(on: OnLine, fault: Fault) -> WithIdents:
    return cast(WithIdents, on.nodes[fault.axis])


def _stick(on: OnLine, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    drive, name, level = _drive(on, fault), fault.values["real_time"], bool(fault.values["level"])
    return Act(lambda: drive.hold_bit(name, level=level), lambda: drive.hold_bit(name, level=None))


def _answer(on: OnLine, fault: Fault, numbers: random.Random, record: Injected) -> Act:
    hits, record.hits = hits_of(fault, numbers), 0
    code = fault.values.get("soe", "")

    def answers() -> str | None:
        if not hits.falls():
            return None
        record.count(on.clock.now_ns)
        return str(code)

    _drive(on, fault).disturb_channel(answers)
    return windowed(hits.window)


def _interrupt(on: OnLine, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    return Act(_drive(on, fault).interrupt_probing, nothing)


KINDS: Mapping[str, Make] = {
    "bit_stuck": _stick,
    "soe_silent": _answer,
    "soe_refused": _answer,
    "command_ends": _interrupt,
}
"""How each kind of the room `idents` is built in."""


def points(machine: Equipped) -> Points:
    """Return the axes whose drives have idents."""
    return points_of(machine, KINDS)
