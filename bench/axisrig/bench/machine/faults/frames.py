"""Faults of frames on CAN: hooks of segments, and nodes that do not belong."""

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from axisrig.bench.bus.can.faults import (
    Alter,
    Delay,
    Drop,
    Duplicate,
    ErrorAtBit,
    FaultAction,
    FrameFault,
    Swap,
)
from axisrig.bench.bus.can.frame import IFS_BITS, Frame, frame_bits
from axisrig.bench.bus.can.intruders import Babbler, SecondSender
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.hits import Window
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.bench.machine.faults.acts import Act, Injected, nothing
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.machine.faults.when import hits_of, windowed
from axisrig.bench.rig.canopen.schedule import axis_telegrams
from axisrig.bench.rig.reading.faults import Fault
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.profiles.canopen.identifiers import (
    EMERGENCY_BASE,
    ERROR_CONTROL_BASE,
    NMT_ID,
    PDO_BASE,
    SDO_ANSWER_BASE,
    SYNC_ID,
)
from axisrig.kernel.profiles.canopen.nmt import (
    ENTER_PRE_OPERATIONAL,
    RESET_COMMUNICATION,
    RESET_NODE,
    STOP,
)
from axisrig.kernel.time.scheduler import Scheduler

_COMMANDS = {
    "reset": RESET_NODE, "reset_communication": RESET_COMMUNICATION,
    "stop": STOP, "pre_operational": ENTER_PRE_OPERATIONAL,
}  # fmt: skip
_AXIS_IDS = {
    "SDO": SDO_ANSWER_BASE, "EMCY": EMERGENCY_BASE, "HEARTBEAT": ERROR_CONTROL_BASE, **PDO_BASE
}  # fmt: skip
_BUS_IDS = {"SYNC": SYNC_ID, "NMT": NMT_ID}
_TELEGRAM_OF_KIND = {
    "sync_loss": "SYNC", "sync_jitter": "SYNC", "slow_sdo": "SDO", "heartbeat_loss": "HEARTBEAT",
}  # fmt: skip


@dataclass(frozen=True)
class OnCan:
    """The buses of a machine and the nodes of its virtual drives, by axis."""

    settings: Settings
    clock: Scheduler
    segments: Mapping[str, Segment]
    nodes: Mapping[str, DriveNode]

    def segment(self, fault: Fault) -> Segment:
        """Return the segment that a fault acts on."""
        return self.segments[fault.segment or self.settings.rig.axis[fault.axis].segment]

    def cob_id(self, fault: Fault) -> int:
        """Return the identifier of the telegram that a fault is about."""
        telegram = fault.telegram or _TELEGRAM_OF_KIND[fault.kind]
        if telegram in _BUS_IDS:
            return _BUS_IDS[telegram]
        task = self.settings.rig.plc_task
        if not fault.axis and task is not None and task.terminal is not None:
            return _AXIS_IDS[telegram] + (task.terminal.node or 0)
        node_id = self.settings.rig.axis[fault.axis].node_id
        mapped = axis_telegrams(self.settings, fault.axis).get(telegram)
        return _AXIS_IDS[telegram] + node_id if mapped is None else mapped.cob_id(node_id)


Make = Callable[[OnCan, Fault, random.Random, Injected], Act]
"""Builds a fault into the buses; writes into the record what it hits."""
_Action = Callable[[Fault, Frame, random.Random], FaultAction]


# What becomes of a frame that is hit


def _alter(fault: Fault, frame: Frame, numbers: random.Random) -> FaultAction:
    """Turn bits of one byte; a frame without data is lost instead."""
    values = fault.values
    if not frame.data:
        return Drop()
    data = bytearray(frame.data)
    place = numbers.randrange(len(data)) if values["byte"] is None else values["byte"] - 1
    bits = 1 << numbers.randrange(8) if values["xor"] is None else values["xor"]
    data[min(place, len(data) - 1)] ^= bits
    return Alter(bytes(data))


def _destroy(fault: Fault, frame: Frame, numbers: random.Random) -> FaultAction:
    bits = frame_bits(frame) - IFS_BITS
    return ErrorAtBit(fault.values["bit"] or numbers.randint(1, bits))


def _wait(fault: Fault, _frame: Frame, numbers: random.Random) -> FaultAction:
    return Delay(fault.values.get("by", 0) + numbers.randint(0, fault.values["jitter"]))


def _lose(_fault: Fault, _frame: Frame, _numbers: random.Random) -> FaultAction:
    return Drop()


def _miss(fault: Fault, _frame: Frame, _numbers: random.Random) -> FaultAction:
    """Lose a frame for one drive, whose port has the name of its axis, or for all."""
    return Drop(frozenset({fault.axis}) if fault.axis else None)


_ACTIONS: Mapping[str, _Action] = {
    "drop": _lose,
    "duplicate": lambda fault, _frame, _numbers: Duplicate(fault.values["after"]),
    "delay": _wait,
    "corrupt": _destroy,
    "alter": _alter,
    "swap": lambda _fault, _frame, _numbers: Swap(),
    "sync_loss": _miss,
    "sync_jitter": _wait,
    "slow_sdo": _wait,
    "heartbeat_loss": _lose,
}


# How a fault gets onto the wire


def _frame_fault(
    action: _Action, on: OnCan, fault: Fault, numbers: random.Random, record: Injected
) -> Act:
    hits, record.hits = hits_of(fault, numbers), 0

    def counted(frame: Frame, numbers: random.Random) -> FaultAction:
        record.count(on.clock.now_ns)
        return action(fault, frame, numbers)

    on.segment(fault).add_fault(
        FrameFault(on.cob_id(fault), counted, hits, is_each_attempt=fault.kind == "corrupt")
    )
    return windowed(hits.window)


def _babble(on: OnCan, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    window, values = Window(is_open=False), fault.values
    Babbler(on.segment(fault), values["id"], bytes(values["bytes"]), values["period"], window)
    return windowed(window)


def _second_sender(on: OnCan, fault: Fault, numbers: random.Random, _record: Injected) -> Act:
    hits, wanted = hits_of(fault, numbers), fault.values["data"]

    def content(last: bytes, numbers: random.Random) -> bytes:
        if isinstance(wanted, bytes):
            return wanted
        return last if wanted == "last" else numbers.randbytes(len(last))

    after_ns = fault.values["after"]
    SecondSender(on.segment(fault), on.cob_id(fault), content, after_ns, hits)
    return windowed(hits.window)


def _reset(on: OnCan, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    port = on.segment(fault).port("foreign master")
    port.attach_data(lambda _id, _data, _time: None)
    node = on.settings.rig.axis[fault.axis].node_id
    data = bytes([_COMMANDS[fault.values["command"]], node])
    return Act(partial(port.send_raw, NMT_ID, data), nothing)


def _bus_off(on: OnCan, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    port = next(p for p in on.segment(fault).ports if p.port_name == fault.axis)

    def leave() -> None:
        port.force_bus_off()
        if fault.values["for"] is not None:  # else it recovers by itself, as the bus has it
            port.power_off()

    return Act(leave, port.power_on)


def _cable_off(on: OnCan, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    """Take the controller of a drive off the wire; the drive itself does not notice."""
    port = next(p for p in on.segment(fault).ports if p.port_name == fault.axis)
    return Act(port.power_off, port.power_on)


KINDS: Mapping[str, Make] = {
    **{kind: partial(_frame_fault, action) for kind, action in _ACTIONS.items()},
    "babble": _babble,
    "second_sender": _second_sender,
    "reset": _reset,
    "bus_off": _bus_off,
    "cable_off": _cable_off,
}
"""How each kind of the room `frames` is built in."""


def points(machine: Equipped) -> Points:
    """Return telegrams, buses and drives whose frames can be disturbed."""
    return points_of(machine, KINDS)
