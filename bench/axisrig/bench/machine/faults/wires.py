"""Faults of wires: signals of probes and switches, and encoders."""

import random
from collections.abc import Mapping

from axisrig.bench.machine.faults.acts import Act, nothing
from axisrig.bench.machine.faults.beside import Beside, Make
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.machine.wiring.signals import (
    ChatteringWire,
    LateWire,
    SignalWire,
    StickingWire,
)
from axisrig.bench.rig.reading.faults import Fault


def _wired(beside: Beside, fault: Fault, wire: SignalWire) -> Act:
    """Put a wire behind those that are there: a further fault has this one before it."""
    beside.put_signal(fault.target, wire)
    return Act(wire.begin, wire.end)


def _stick(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    advance = beside.plant.advance_to
    wire = StickingWire(beside.signal(fault.target), beside.clock, advance)
    return _wired(beside, fault, wire)


def _chatter(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    pulses, period_ns = fault.values["pulses"], fault.values["period"]
    wire = ChatteringWire(beside.signal(fault.target), beside.clock, pulses, period_ns)
    return _wired(beside, fault, wire)


def _late(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    wire = LateWire(beside.signal(fault.target), beside.clock, fault.values["by"])
    return _wired(beside, fault, wire)


def _crossed(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    beside.cross(fault.target)
    return Act(nothing, nothing)


def _freeze(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    wire = beside.encoder(fault.target)
    return Act(wire.begin_freeze, wire.end_freeze)


def _lose(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    wire, rig = beside.encoder(fault.target), beside.settings.rig
    drive = rig.drive[rig.axis[fault.target].drive].facts()
    way_m = fault.values["increments"] / float(drive.units_per_mm) * 1e-3
    return Act(lambda: wire.lose(way_m), nothing)


KINDS: Mapping[str, Make] = {
    "probe_stick": _stick,
    "probe_chatter": _chatter,
    "probe_late": _late,
    "crossed": _crossed,
    "encoder_freeze": _freeze,
    "encoder_loss": _lose,
}
"""How each kind of the room `wires` is built in."""


def points(machine: Equipped) -> Points:
    """Return the signals and axes whose wires can fail."""
    return points_of(machine, KINDS)
