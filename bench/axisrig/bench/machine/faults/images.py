"""Faults of cyclic segments: images that are lost or late, and what a PROFIdrive drive shows."""

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Protocol, cast

from axisrig.bench.bus.cyclic.segment import CyclicSegment, Falls
from axisrig.bench.drive.cia402.node import Cia402Node
from axisrig.bench.machine.faults.acts import Act, Injected, nothing
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.machine.faults.when import hits_of, windowed
from axisrig.bench.rig.reading.faults import Fault
from axisrig.kernel.time.clock import Clock


class Interface(Protocol):
    """An encoder interface as its faults see it. holds_other: another function is active."""

    holds_other: bool

    def break_off(self, code: int) -> None:
        """End all functions with an error code."""
        ...


class WithInterface(Protocol):
    """A virtual drive with an encoder interface. holds_life: its sign of life stays."""

    encoder: Interface
    holds_life: bool


@dataclass(frozen=True)
class OnImages:
    """The segment that a fault acts on, and the virtual drives on it by axis."""

    clock: Clock
    segment: CyclicSegment
    nodes: Mapping[str, Cia402Node]


Make = Callable[[OnImages, Fault, random.Random, Injected], Act]


def _of_images(
    place: str, on: OnImages, fault: Fault, numbers: random.Random, record: Injected
) -> Act:
    hits, record.hits = hits_of(fault, numbers), 0

    def falls() -> bool:
        is_hit = hits.falls()
        if is_hit:
            record.count(on.clock.now_ns)
        return is_hit

    faults: Mapping[str, list[Falls]] = getattr(on.segment, place)
    faults[fault.axis].append(falls)
    return windowed(hits.window)


def _drive(on: OnImages, fault: Fault) -> WithInterface:
    return cast(WithInterface, on.nodes[fault.axis])


def _hold_life(on: OnImages, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    drive = _drive(on, fault)
    return Act(
        partial(setattr, drive, "holds_life", True), partial(setattr, drive, "holds_life", False)
    )


def _break_off(on: OnImages, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    return Act(partial(_drive(on, fault).encoder.break_off, fault.values["error"]), nothing)


def _hold_other(on: OnImages, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    encoder = _drive(on, fault).encoder
    return Act(
        partial(setattr, encoder, "holds_other", True),
        partial(setattr, encoder, "holds_other", False),
    )


KINDS: Mapping[str, Make] = {
    "image_lost": partial(_of_images, "lost"),
    "image_missed": partial(_of_images, "missed"),
    "image_late": partial(_of_images, "late"),
    "life_stuck": _hold_life,
    "encoder_error": _break_off,
    "function_late": _hold_other,
}
"""How each kind of the room `images` is built in."""


def points(machine: Equipped) -> Points:
    """Return the axes whose images can be disturbed, and whose encoder interfaces can fail."""
    return points_of(machine, KINDS)
