"""Faults injected into a machine: hooks of segments, nodes that do not belong, drives that fail.

Every fault draws from a random sequence of its own, made of the seed of the run, its kind, target
and place among its like; so a further fault changes nothing about the others.
"""

import random
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from axisrig.bench.bus.can.faults import (
    Alter,
    Delay,
    Drop,
    Duplicate,
    ErrorAtBit,
    FaultAction,
    FrameFault,
    Swap,
    Window,
)
from axisrig.bench.bus.can.frame import IFS_BITS, Frame, frame_bits
from axisrig.bench.bus.can.intruders import Babbler, SecondSender
from axisrig.bench.machine.faults.beside import ROOMS, Act, drawn
from axisrig.bench.machine.faults.moments import Moments, World
from axisrig.bench.rig.reading.faults import Fault, fault_kinds
from axisrig.kernel.profiles.canopen.identifiers import (
    EMERGENCY_BASE,
    ERROR_CONTROL_BASE,
    NMT_ID,
    PDO_BASE,
    SDO_ANSWER_BASE,
    SYNC_ID,
)
from axisrig.kernel.time.clock import MS, Phase, TimeNs

_COMMANDS = {"reset": 129, "reset_communication": 130, "stop": 2, "pre_operational": 128}
_AXIS_IDS = {
    "SDO": SDO_ANSWER_BASE, "EMCY": EMERGENCY_BASE, "HEARTBEAT": ERROR_CONTROL_BASE, **PDO_BASE
}  # fmt: skip
_BUS_IDS = {"SYNC": SYNC_ID, "NMT": NMT_ID}
_TELEGRAM_OF_KIND = {
    "sync_loss": "SYNC", "sync_jitter": "SYNC", "slow_sdo": "SDO", "heartbeat_loss": "HEARTBEAT",
}  # fmt: skip

Make = Callable[[dict[str, Any], Frame, random.Random], FaultAction]


def _alter(values: dict[str, Any], frame: Frame, numbers: random.Random) -> FaultAction:
    """Turn bits of one byte; a frame without data is lost instead."""
    if not frame.data:
        return Drop()
    data = bytearray(frame.data)
    place = numbers.randrange(len(data)) if values["byte"] is None else values["byte"] - 1
    bits = 1 << numbers.randrange(8) if values["xor"] is None else values["xor"]
    data[min(place, len(data) - 1)] ^= bits
    return Alter(bytes(data))


def _destroy(values: dict[str, Any], frame: Frame, numbers: random.Random) -> FaultAction:
    bits = frame_bits(frame) - IFS_BITS
    return ErrorAtBit(values["bit"] or numbers.randint(1, bits))


def _wait(values: dict[str, Any], _frame: Frame, numbers: random.Random) -> FaultAction:
    return Delay(values.get("by", 0) + numbers.randint(0, values["jitter"]))


def _miss(values: dict[str, Any], _frame: Frame, _numbers: random.Random) -> FaultAction:
    """Lose a frame for one drive, whose port has the name of its axis, or for all."""
    return Drop(frozenset({values["receiver"]}) if values["receiver"] else None)


_FRAME_ACTIONS: dict[str, Make] = {
    "drop": lambda _values, _frame, _numbers: Drop(),
    "duplicate": lambda values, _frame, _numbers: Duplicate(values["after"]),
    "delay": _wait,
    "corrupt": _destroy,
    "alter": _alter,
    "swap": lambda _values, _frame, _numbers: Swap(),
    "sync_loss": _miss,
    "sync_jitter": _wait,
    "slow_sdo": _wait,
    "heartbeat_loss": lambda _values, _frame, _numbers: Drop(),
}


@dataclass
class Injected:
    """What became of one fault: when it began, ended by its time, and which frames it hit.

    hits: None for a kind that is not about frames of others. axis: empty for a whole bus.
    """

    label: str
    axis: str
    hits: int | None = None
    begin_ns: TimeNs | None = None
    end_ns: TimeNs | None = None
    last_hit_ns: TimeNs = 0

    def marks(self) -> list[tuple[TimeNs, str]]:
        """Return it as instants with words; nothing when its moment has not come."""
        if self.begin_ns is None:
            return []
        marks = [(self.begin_ns, f"{self.label} begins")]
        if self.hits:
            frames = "frame hit" if self.hits == 1 else "frames hit, the last"
            marks.append((self.last_hit_ns, f"{self.label}: {self.hits} {frames}"))
        if self.end_ns is not None:
            marks.append((self.end_ns, f"{self.label} ends"))
        return marks

    def in_words(self) -> str:
        """Say in a line what came of it."""
        if self.begin_ns is None:
            return f"fault {self.label}: its moment has not come"
        hit = "" if self.hits is None else f", frames hit: {self.hits}"
        return f"fault {self.label}: from {self.begin_ns / MS:g} ms{hit}"


def inject(world: World, seed: int) -> list[Injected]:
    """Inject the faults of the settings into a machine of which everything else is built.

    Returns the record of each, written while the machine runs.
    """
    injected = []
    moments, acts = Moments(world), iter(world.beside.acts)
    for fault, numbers in drawn(seed, world.settings.faults):
        act = next(acts) if fault_kinds()[fault.kind].room in ROOMS else None
        injection = _Injection(world, moments, fault, numbers, act)
        injection.build()
        injected.append(injection.record)
    return injected


class _Injection:
    """One fault on its way into the machine."""

    def __init__(
        self,
        world: World,
        moments: Moments,
        fault: Fault,
        numbers: random.Random,
        act: Act | None,
    ) -> None:
        self._world, self._moments, self._fault, self._random = world, moments, fault, numbers
        self._values, self._act = dict(fault.values), act
        self.record = Injected(f"{fault.kind} {fault.target}", fault.axis)
        axes = world.settings.rig.axis
        if act is not None:
            self._axes = list(act.axes)
            return
        name = fault.segment or axes[fault.axis].segment
        self._segment = world.segments[name]
        self._axes = [fault.axis] if fault.axis else [a for a in axes if axes[a].segment == name]

    def build(self) -> None:
        kind, act = self._fault.kind, self._act
        if act is not None:
            self._at(act.begin, act.end, self._values.get("for"))
        elif kind in _FRAME_ACTIONS:
            self._frame_fault()
        elif kind == "babble":
            data = bytes(self._values["bytes"])
            Babbler(self._segment, self._values["id"], data, self._values["period"], self._window())
        elif kind == "second_sender":
            self._second_sender()
        elif kind == "reset":
            self._reset()
        else:
            self._drive_fault()

    def _drive_fault(self) -> None:
        node = self._world.nodes[self._fault.axis]
        for_ns = self._values["for"]
        if self._fault.kind == "power_loss":
            self._at(node.power_off, node.power_on, for_ns)
            return
        port = next(p for p in self._segment.ports if p.port_name == self._fault.axis)

        def leave() -> None:
            port.force_bus_off()
            if for_ns is not None:  # else the controller recovers by itself, as the bus has it
                port.power_off()

        self._at(leave, port.power_on, for_ns)

    # When

    def _at(self, begin: Callable[[], None], end: Callable[[], None], for_ns: int | None) -> None:
        """Let something begin at the moment of the fault, or now, and end after its time."""
        clock, record = self._world.scheduler, self.record

        def stop() -> None:
            end()
            record.end_ns = clock.now_ns

        def start() -> None:
            begin()
            record.begin_ns = clock.now_ns
            if for_ns is not None:
                clock.call_at(clock.now_ns + for_ns, Phase.APPLICATION, stop)

        if self._values.get("at") is None:
            clock.call_at(clock.now_ns, Phase.APPLICATION, start)
        else:
            self._moments.when(self._values["at"], self._values["nth"], self._axes, start)

    def _window(self) -> Window:
        window = Window(is_open=False)
        if self._values["at"] is None:
            window.begin()  # before the first event, not with it
        self._at(window.begin, window.end, self._values["for"])
        return window

    # What

    def _cob_id(self) -> int:
        telegram = self._fault.telegram or _TELEGRAM_OF_KIND[self._fault.kind]
        if telegram in _BUS_IDS:
            return _BUS_IDS[telegram]
        task = self._world.settings.rig.plc_task
        if not self._fault.axis and task is not None and task.terminal is not None:
            return _AXIS_IDS[telegram] + (task.terminal.node or 0)
        return _AXIS_IDS[telegram] + self._world.settings.rig.axis[self._fault.axis].node_id

    def _frame_fault(self) -> None:
        fault, values = self._fault, self._values
        if fault.kind == "sync_loss":
            values["receiver"] = fault.axis
        act, record = _FRAME_ACTIONS[fault.kind], self.record
        clock, record.hits = self._world.scheduler, 0

        def counted(frame: Frame, numbers: random.Random) -> FaultAction:
            record.hits, record.last_hit_ns = (record.hits or 0) + 1, clock.now_ns
            return act(values, frame, numbers)

        self._segment.add_fault(
            FrameFault(
                self._cob_id(),
                counted,
                self._window(),
                self._random,
                share=values["p"],
                skip=values["skip"],
                count=values["count"],
                is_each_attempt=fault.kind == "corrupt",
            )
        )

    def _second_sender(self) -> None:
        values = self._values
        wanted = values["data"]

        def content(last: bytes, numbers: random.Random) -> bytes:
            if isinstance(wanted, bytes):
                return wanted
            return last if wanted == "last" else numbers.randbytes(len(last))

        SecondSender(
            self._segment,
            self._cob_id(),
            content,
            values["after"],
            self._window(),
            self._random,
            share=values["p"],
            skip=values["skip"],
            count=values["count"],
        )

    def _reset(self) -> None:
        port = self._segment.port("foreign master")
        port.attach_data(lambda _id, _data, _time: None)
        node = self._world.settings.rig.axis[self._fault.axis].node_id
        data = bytes([_COMMANDS[self._values["command"]], node])
        self._at(partial(port.send_raw, NMT_ID, data), lambda: None, None)
