"""A rig in words: its axes with what belongs to each, and probes that nobody reads."""

from pathlib import Path

from axisrig.bench.rig.settings import Settings
from axisrig.kernel.measuring.rules import (
    PLC,
    PLC_FIRST_EVENT,
    PLC_TIMESTAMP,
    MeasuringAxis,
)
from axisrig.kernel.time.clock import MS, US

WHAT_PASSES = (
    "a latch that is altered alike in every telegram passes if it is at a place where the axis was"
)
"""What a measured value without a proof of its own may be."""


def unproved_place(settings: Settings, name: str, reason: str | None = None) -> str:
    """Warn that an axis is led from a position of telegrams alone; reason: else its drive's key."""
    drive = settings.rig.axis[name].drive
    return (
        f"warning: axis {name}: the position from which its drive is led into operation rests on"
        " telegrams alone: an axis jumps by what is wrong in them:"
        f" {reason or f'position_check of drive {drive} is false'}"
    )


OPEN = "telegrams are missing there, or clocks were apart"
"""Why a position between two others is not proved."""


def describe_axes(settings: Settings) -> list[str]:
    """Give of each axis node, segment, drive, plant and wiring; warn of unread sensors."""
    rig = settings.rig
    lines = []
    for name, axis in rig.axis.items():
        drive = rig.drive[axis.drive]
        at = "on" if axis.node is None else f"node {axis.node} on"
        wired = [f"{key} = {sensor}" for key, sensor in axis.signals.items()]
        wired += [f"encoder_2 = {axis.encoder_2}"] if axis.encoder_2 else []
        lines.append(
            f"axis {name}: {at} {axis.segment}, drive {axis.drive} ({drive.in_words}),"
            f" plant {axis.plant}, {', '.join(wired) or 'no probe wired'}"
        )
    moved = {axis.plant for axis in rig.axis.values()}
    read = {sensor for axis in rig.axis.values() for sensor in axis.signals.values()}
    read |= {axis.encoder_2 for axis in rig.axis.values() if axis.encoder_2}
    read |= {entry.sensor for entry in rig.plc.values()}
    task = rig.plc_task
    if task is not None:
        channels = task.terminal.inputs if task.terminal else {}
        read |= {*channels.values(), *([task.switches] if task.switches else [])}
        inputs = ", ".join(f"input {number} = {name}" for number, name in channels.items())
        late_ms = task.late_ns(rig.cycle.period_us * US) / MS
        if task.terminal is not None and task.terminal.line:
            inputs = f"last slave on {task.terminal.line}, {inputs or 'none'}"
        elif task.terminal is not None and task.terminal.is_on_can:
            inputs = f"node {task.terminal.node} on {task.terminal.segment}, {inputs or 'none'}"
        lines.append(
            f"PLC task: every {task.period_us} us from {task.offset_us} us on,"
            f" program {Path(task.program).name}; terminal: {inputs or 'none'};"
            f" an edge is in its outputs {late_ms:g} ms later at most"
        )
    lines += [f"{name} of the PLC: {entry.sensor}" for name, entry in rig.plc.items()]
    lines += _unserved_sources(settings)
    lines += [
        f"warning: {plant} is wired to no input of a drive: nobody reads it"
        for plant in rig.plant
        if plant not in moved | read
    ]
    return lines


def _unserved_sources(settings: Settings) -> list[str]:
    """Warn of axes whose measuring signal (P-AXIS-00516) nothing of the rig can give."""
    task = settings.rig.plc_task
    lines = []
    for name, parameters in settings.axis.items():
        measuring = MeasuringAxis.read(parameters)
        source = measuring.source
        if not (parameters.flag("kenngr.messachse") and measuring.needs_plc(source)):
            continue
        head = f"warning: axis {name} measures with {source}"
        if task is None:
            columns = f"; plc:{name}.probing_signal of a plan serves it"
            hint = columns if source in (PLC, PLC_FIRST_EVENT) else ""
            lines.append(f"{head} and the rig has no PLC task: alarm 900400{hint}")
        elif source == PLC_TIMESTAMP and (task.terminal is None or task.terminal.is_on_can):
            lines.append(f"{head} and the PLC has no terminal with time stamps")
    return lines
