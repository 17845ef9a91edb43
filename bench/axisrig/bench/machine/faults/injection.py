"""Builds the faults of the settings into a machine, each by the table of its room."""

import random
from collections.abc import Callable, Mapping, Sequence

from axisrig.bench.machine.faults import (
    clock,
    drives,
    frames,
    idents,
    images,
    lines,
    plants,
    plc,
    sensors,
    wires,
)
from axisrig.bench.machine.faults.acts import Act, Injected, drawn
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.machine.faults.beside import Make as MakeBeside
from axisrig.bench.machine.faults.when import Moments
from axisrig.bench.rig.reading.fault_targets import axes_of
from axisrig.bench.rig.reading.faults import Fault, fault_kinds
from axisrig.bench.rig.settings import Settings

BESIDE: Mapping[str, MakeBeside] = {
    **wires.KINDS, **sensors.KINDS, **plants.KINDS, **plc.KINDS, **clock.KINDS
}  # fmt: skip
"""Kinds of what is between the plant and its readers: built in before these."""
ON_CAN: Mapping[str, frames.Make] = {**frames.KINDS, **drives.KINDS}
"""Kinds of frames on CAN and of drives."""
ON_LINES: Mapping[str, lines.Make] = {**lines.KINDS, **drives.KINDS, **idents.KINDS}
"""Kinds of EtherCAT lines and of drives on them."""
ON_IMAGES: Mapping[str, images.Make] = {**images.KINDS, **drives.KINDS}
"""Kinds of cyclic segments and of drives on them."""

BuildIn = Callable[[Fault, random.Random, Injected], Act]


def build_beside(beside: Beside, seed: int) -> list[Act]:
    """Build in what is no matter of frames and drives; return the acts in the order of the faults.

    seed: of the run.
    """
    return [
        BESIDE[fault.kind](beside, fault, numbers)
        for fault, numbers in drawn(seed, beside.settings.faults)
        if fault.kind in BESIDE
    ]


def inject(
    settings: Settings, moments: Moments, built: Sequence[Act], build: BuildIn, seed: int
) -> list[Injected]:
    """Let the faults of the settings act on a machine of which everything else is built.

    built: what `build_beside` has returned. build: builds a fault of frames or of a drive in.
    Returns the record of each, written while the machine runs.
    """
    injected, before = [], iter(built)
    for fault, numbers in drawn(seed, settings.faults):
        record = Injected(f"{fault.kind} {fault.target}", fault.axis)
        is_beside = fault.kind in BESIDE
        act = next(before) if is_beside else build(fault, numbers, record)
        axes = axes_of(fault.target, fault_kinds()[fault.kind].targets, settings.rig)
        moments.run(fault, act, axes, record)
        injected.append(record)
    return injected
