"""The kernel's end of one drive: set values out, actual values and latches in, over PDOs only.

Everything the kernel knows of the machine comes through here. Positions are millimetres on the
kernel's side and increments on the bus.
"""

from collections import deque
from dataclasses import dataclass
from typing import Any

from kernel.drives.ds402 import (
    STATES,
    State,
    controlword_towards,
    enabled_bit,
    input_bit,
    latch_object,
    probe_function,
    state_of,
    stored_bit,
)
from kernel.drives.mapping import Telegram, telegrams
from kernel.errors import Alarm

# A cyclic telegram may stay out this often before the drive counts as lost
MISSING_CYCLES_MAX = 3
POSITION_MAX = 1 << 31  # INTEGER32 of 607A and 6064, increments


@dataclass(frozen=True)
class LinkSettings:
    """What the kernel must know of a drive.

    increments_per_mm: scaling of 607A, 6064 and the latch objects. probe_input: 1 or 2
    (P-AXIS-00517). edge: POS or NEG (P-AXIS-00518). lag_delay_cycles: P-AXIS-00191. pdo_map:
    path of a mapping table, None for the kernel's own.
    """

    axis: str
    node_id: int
    increments_per_mm: float
    probe_input: int = 1
    edge: str = "POS"
    lag_delay_cycles: int = 0
    pdo_map: str | None = None


class AxisLink:
    """One drive on a canopen network (simulated or real), read and written once per cycle."""

    def __init__(self, settings: LinkSettings, network: Any) -> None:
        self.settings, self.network = settings, network
        self.name = settings.axis
        self.latch_object = latch_object(settings.probe_input, settings.edge)
        self.telegrams: dict[str, Telegram] = telegrams(self.latch_object, settings.pdo_map)
        self._function = probe_function(settings.probe_input, settings.edge)
        self._enabled_bit = enabled_bit(settings.probe_input)
        self._stored_bit = stored_bit(settings.probe_input, settings.edge)
        self._input_bit = input_bit(settings.probe_input)
        self._per_mm = settings.increments_per_mm
        self._codec = {name: t.codec for name, t in self.telegrams.items()}
        self._rpdo_id = self.telegrams["RPDO1"].cob_id(settings.node_id)
        self._received: dict[str, bytes | None] = {"TPDO1": None, "TPDO2": None}
        self._contradicted: set[str] = set()
        self.statusword = 0
        self.state = state_of(0)
        self.actual_increments = 0
        self._probe_status = 0
        self._latch_increments: int | None = None
        self._inputs: int | None = None
        self._missing = 0
        self.emergency_code = 0
        self.controlword = 0
        self.power = False
        self._function_word = 0
        self.set_mm = 0.0
        self._set_history: deque[float] = deque(maxlen=settings.lag_delay_cycles + 1)
        self._subscribe()

    def _subscribe(self) -> None:
        node_id = self.settings.node_id
        for name in ("TPDO1", "TPDO2"):
            self.network.subscribe(
                self.telegrams[name].cob_id(node_id),
                lambda _id, data, _time, name=name: self._on_cyclic(name, data),
            )
        self.network.subscribe(self.telegrams["TPDO3"].cob_id(node_id), self._on_inputs)
        self.network.subscribe(0x80 + node_id, self._on_emergency)

    def _on_cyclic(self, name: str, data: bytearray) -> None:
        if len(data) != self._codec[name].size:
            return
        known = self._received[name]
        if known is not None and known != data:
            self._contradicted.add(name)  # one of both is late or of another node: which one?
        self._received[name] = bytes(data)

    def _on_inputs(self, _cob_id: int, data: bytearray, _time: float) -> None:
        if len(data) == self._codec["TPDO3"].size:
            (self._inputs,) = self._codec["TPDO3"].unpack(data)

    def _on_emergency(self, _cob_id: int, data: bytearray, _time: float) -> None:
        self.emergency_code = int.from_bytes(data[:2], "little")

    def can_reach(self, position_mm: float) -> bool:
        """Whether a set position fits into the 32 bits of 607A."""
        return abs(position_mm * self._per_mm) < POSITION_MAX

    def begin_cycle(self) -> None:
        """Forget what is there: a SYNC counts with its own answers only.

        Called with every SYNC as well as after taking, because an answer may come late.
        """
        self._received["TPDO1"] = self._received["TPDO2"] = None
        if self._contradicted:
            self._contradicted.clear()

    def take(self) -> None:
        """Take what this cycle's SYNC brought.

        A telegram that came twice with different contents, or whose statusword cannot be, counts
        as one that stayed out. Raises Alarm 900006, 900080 or 900081 when that lasts.
        """
        first, second = self._received["TPDO1"], self._received["TPDO2"]
        alarm_id = 900006
        if self._contradicted:
            if "TPDO1" in self._contradicted:
                first, alarm_id = None, 900080
            if "TPDO2" in self._contradicted:
                second = None
        self.begin_cycle()
        self._latch_increments = None
        if first is not None:
            statusword, actual, probe_status = self._codec["TPDO1"].unpack(first)
            try:
                self.state = state_of(statusword)
            except ValueError:
                first, alarm_id = None, 900081
        if first is None:
            self._missing += 1
            if self._missing > MISSING_CYCLES_MAX:
                raise Alarm(alarm_id, axis=self.name, pdo="TPDO1", cycles=self._missing)
            return
        self._missing = 0
        self.statusword, self.actual_increments, self._probe_status = (
            statusword, actual, probe_status,
        )  # fmt: skip
        # 60B9 and the latch object are one measured value only when one SYNC sampled both
        if second is not None and self._probe_status & self._stored_bit:
            (self._latch_increments,) = self._codec["TPDO2"].unpack(second)

    @property
    def actual_mm(self) -> float:
        """Actual position 0x6064."""
        return self.actual_increments / self._per_mm

    @property
    def lag_mm(self) -> float:
        """The CNC's position lag e(k) = s(k - d) - x(k), d = P-AXIS-00191.

        Source: docs/ambiguities.md, "Two position lags".
        """
        return (self._set_history[0] if self._set_history else self.set_mm) - self.actual_mm

    # The latch, as the measuring run sees it

    def arm(self) -> None:
        """Enable the touch probe with the next telegram."""
        self._function_word = self._function

    def disarm(self) -> None:
        """Switch the touch probe off with the next telegram."""
        self._function_word = 0

    @property
    def is_clear(self) -> bool:
        """Whether the drive shows neither an enabled probe nor a stored edge."""
        return not self._probe_status & (self._enabled_bit | self._stored_bit)

    @property
    def is_armed(self) -> bool:
        """Whether the drive has acknowledged the enabled probe."""
        return bool(self._probe_status & self._enabled_bit)

    @property
    def has_latched(self) -> bool:
        """Whether the drive reports a stored edge."""
        return bool(self._probe_status & self._stored_bit)

    @property
    def latched_mm(self) -> float | None:
        """The latched position, or None while it is not proved to be of the reported edge."""
        if self._latch_increments is None:
            return None
        return self._latch_increments / self._per_mm

    @property
    def is_actuated(self) -> bool | None:
        """Whether the probe input has the level that the edge brings; None without 0x60FD."""
        if self._inputs is None:
            return None
        level = bool(self._inputs & self._input_bit)
        return level == (self.settings.edge == "POS")

    def _controlword(self) -> int:
        """Lead the drive on; out of a fault only the operator leads, never a running program."""
        state = self.state
        if state in (State.FAULT, State.FAULT_REACTION_ACTIVE):
            return STATES[state].hold
        wanted = State.OPERATION_ENABLED if self.power else State.READY_TO_SWITCH_ON
        return controlword_towards(state, wanted)

    def send(self, set_mm: float) -> None:
        """Send set position, controlword and latch control word of this cycle."""
        self.controlword = self._controlword()
        self.set_mm = set_mm
        self._set_history.append(set_mm)
        self.network.send_message(
            self._rpdo_id,
            self._codec["RPDO1"].pack(
                self.controlword, round(set_mm * self._per_mm), self._function_word
            ),
        )
