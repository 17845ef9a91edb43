"""The kernel's end of one drive: set values out, actual values and latches in, over PDOs only.

All data of the machine that the kernel gets come through here. Positions are millimetres on the
kernel's side and increments on the bus.
"""

from collections import deque
from typing import Any, Final

from axisrig.kernel.drives.canopen.latch_check import LatchCheck, StandstillRoom
from axisrig.kernel.drives.canopen.latch_watch import LatchWatch
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.canopen.mapping import Telegram, telegrams
from axisrig.kernel.drives.canopen.process_data import ProcessData
from axisrig.kernel.drives.canopen.sdo import SdoClient
from axisrig.kernel.drives.canopen.sparse import SparseData
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.profiles.canopen.emergency import Emergency
from axisrig.kernel.profiles.canopen.identifiers import EMERGENCY_BASE
from axisrig.kernel.profiles.cia402.ds402 import (
    COMMANDS,
    STATES,
    Command,
    State,
    controlword_towards,
    counter_object,
    enabled_bit,
    input_bit,
    latch_object,
    probe_function,
    state_of,
    stored_bit,
)

RESET = COMMANDS[Command.FAULT_RESET].value
OPERATING: Final = State.OPERATION_ENABLED
HOLD_OPERATION: Final = STATES[OPERATING].hold
POSITION_MAX = 1 << 31  # INTEGER32 of 607A and 6064, increments


class AxisLink:
    """One drive on a canopen network (simulated or real), read and written once per cycle.

    mode_bits: bits of the controlword that belong to the mode. leads_itself: the drive moves by
    itself (homing), so that there is no lag and its position may jump to a new reference.
    watches_lag: the CNC monitors the position lag, which it does not in a run to a fixed stop.
    second_age_cycles: since a telegram has delivered the second encoder. unproved_latches: how many
    latches were believed by telegrams alone. doubt_mm: how far the last of them may be wrong, None
    where SDO has proved it. second_telegram: the one that carries the second encoder, if any does.
    """

    def __init__(self, settings: LinkSettings, network: Any, sdo: SdoClient | None = None) -> None:
        self.settings, self.network, self.sdo = settings, network, sdo
        self.name = settings.axis
        self.latch_object = latch_object(settings.probe_input, settings.edge)
        self.telegrams: dict[str, Telegram] = telegrams(
            self.latch_object,
            settings.pdo_map,
            counter=settings.has_counter,
            inputs=settings.has_inputs,
            second=settings.has_second,
        )
        seconds = [
            t for t in self.telegrams.values() if any(o.field == "second" for o in t.objects)
        ]
        self.second_telegram: Telegram | None = seconds[0] if seconds else None
        self.arrival = Arrival(
            settings.status_delay_cycles, settings.missing_cycles, settings.stamps, is_new=False
        )
        self._checked_by: SdoClient | None = None
        self._room: StandstillRoom | None = None
        self.unproved_latches = 0
        self.doubt_mm: float | None = None
        self._watches: dict[tuple[int, str], LatchWatch] = {}
        self._take_up(settings.probe_input, settings.edge)
        self._per_mm = settings.increments_per_mm
        pdos = self._pdos = ProcessData(self.telegrams, settings.node_id, network)
        self._control_out, self._target_out = _needed(pdos, "controlword"), _needed(pdos, "target")
        self._function_out = pdos.sent_place("probe_function") or ([0], 0)
        self._jump_increments = settings.jump_mm * self._per_mm
        self.statusword = 0
        self.state = State.NOT_READY_TO_SWITCH_ON
        self.actual_increments = 0
        self.jump_mm: float | None = None
        self._actual_age: int | None = None  # cycles since the last actual position
        self._inputs: int | None = None
        self._second: int | None = None
        self.second_age_cycles = 0
        self.emergency: Emergency | None = None
        self.controlword = 0
        self.power = False
        self.resets_fault = False
        self.mode_bits = 0
        self.leads_itself = False
        self.watches_lag = True
        self._is_held_back = self.stops_quickly = False
        self._function_word = 0
        self.set_mm = 0.0
        self._set_history: deque[float] = deque(maxlen=settings.lag_delay_cycles + 1)
        self._has_sent = False  # in this cycle
        self.is_still = False  # its last two set positions were the same
        self._sparse = SparseData(
            self.telegrams.values(), settings.node_id, network, self._note_length
        )
        network.subscribe(EMERGENCY_BASE + settings.node_id, self._on_emergency)

    def _note_length(self, found: tuple[str, int, int]) -> None:
        self._pdos.wrong_length = found

    def _on_emergency(self, _cob_id: int, data: bytearray, _time: float) -> None:
        emergency = Emergency.read(data)
        if emergency.reaction != "none":
            self.emergency = emergency

    def can_reach(self, position_mm: float) -> bool:
        """Whether a set position fits into the 32 bits of 607A."""
        return abs(position_mm * self._per_mm) < POSITION_MAX

    def begin(self) -> None:
        """Begin the exchange: what came during the start-up does not count."""
        self._pdos.begin()
        self._sparse.begin()
        self.emergency = None

    def begin_cycle(self) -> None:
        """Forget what is there: a SYNC counts with its own answers only.

        Called with every SYNC as well as after taking, because an answer may come late.
        """
        self._pdos.begin_cycle()

    def take(self) -> None:
        """Take what this cycle's SYNC delivered.

        A telegram that came twice with different contents, or whose status word cannot be, counts
        as one that stayed out. Raises Alarm 900006, 900080 or 900081 when that lasts, 900028 for
        one that does not fit its mapping.
        """
        pdos = self._pdos
        self._has_sent = False
        word, actual, probe, latch, count, inputs, second, stamp = pdos.take()
        if word is not None and word != self.statusword:
            self.statusword, self.state = word, state_of(word)
        if actual is not None:
            self._take_actual(actual)
        elif self._actual_age is not None:
            self._actual_age += 1
        self.arrival.is_new = probe is not None
        if stamp is not None:
            self.arrival.stamp = stamp
        if probe is None:
            self._latch.miss()
        else:
            self._latch.take(probe, latch, count, self.actual_increments)
        if inputs is not None:
            self._inputs = inputs
        self._note_second(second)
        if pdos.wrong_length is not None:
            name, length, expected = pdos.wrong_length
            raise Alarm(900028, axis=self.name, pdo=name, length=length, expected=expected)
        if pdos.is_disturbed:
            self._judge_missing()
        if self._sparse.is_watched:
            self._sparse.step(self.name, self.settings.missing_cycles)

    def _note_second(self, second: int | None) -> None:
        has_come = second is not None or "second" in self._sparse.news
        self._sparse.news.clear()
        if second is not None:
            self._second = second
        self.second_age_cycles = 0 if has_come else self.second_age_cycles + 1

    @property
    def is_disturbed(self) -> bool:
        """Whether a telegram of the last SYNC is missing."""
        return self._pdos.is_disturbed

    def _take_actual(self, increments: int) -> None:
        moved, age = abs(increments - self.actual_increments), self._actual_age
        limit = self._jump_increments
        if (
            moved > limit
            and not self.leads_itself
            and age is not None
            and moved > limit * (age + 1)
        ):
            self.jump_mm = moved / self._per_mm
        self.actual_increments, self._actual_age = increments, 0

    def _judge_missing(self) -> None:
        pdos = self._pdos
        for name, missing, cause in zip(pdos.names, pdos.missing, pdos.causes, strict=True):
            if missing > self.settings.missing_cycles:
                raise Alarm(cause, axis=self.name, pdo=name, cycles=missing)

    def get_object(self, index: int, sub: int) -> int:
        """Return the value that an RPDO carries for an object; KeyError when none carries it."""
        values, position = self._object(index, sub)
        return values[position]

    def set_object(self, index: int, sub: int, value: int) -> None:
        """Let the RPDOs carry a value from the next one on; KeyError when none carries it."""
        values, position = self._object(index, sub)
        values[position] = value

    def _object(self, index: int, sub: int) -> tuple[list[int], int]:
        found = self._pdos.sent_object(index, sub)
        if found is None:
            raise KeyError(f"0x{index:04X}:{sub:X} is in no RPDO of axis {self.name}")
        return found

    def forget(self) -> None:
        """Forget latch and state: the drive has restarted, its positions mean something else."""
        self._function_word = 0
        for watch in self._watches.values():
            watch.restart()
        self.statusword, self.state = 0, State.NOT_READY_TO_SWITCH_ON

    def hold_back(self) -> None:
        """Never lead the drive into operation again: it may go on with what it does, or stop.

        Without `power` it is led out of operation.
        """
        self._is_held_back = True

    def quick_stop(self) -> None:
        """Let the drive stop by itself: it does not follow its targets."""
        self._is_held_back = self.stops_quickly = True

    def let_go(self) -> None:
        """Lead the drive again as `power` says, after a reset."""
        self._is_held_back = self.stops_quickly = False

    @property
    def has_actual(self) -> bool:
        """Whether this cycle's SYNC has delivered 0x6064."""
        return self._actual_age == 0

    @property
    def actual_mm(self) -> float:
        """Actual position 0x6064."""
        return self.actual_increments / self._per_mm

    @property
    def second_increments(self) -> int | None:
        """Position of the second encoder 0x60E4:1; None until a telegram has delivered it."""
        return self._sparse.values.get("second", self._second)

    @property
    def has_second(self) -> bool:
        """Whether a telegram carries the second encoder."""
        return self.second_telegram is not None

    @property
    def lag_mm(self) -> float:
        """The CNC's position lag e(k) = s(k - d) - x(k), d = P-AXIS-00191.

        Before s(k) is sent, d = 0 has to do with s(k - 1).
        Source: docs/ambiguities.md, "Two position lags".
        """
        if self.leads_itself:
            return 0.0
        history = self._set_history
        older = self.settings.lag_delay_cycles - (not self._has_sent)
        place = len(history) - 1 - max(older, 0)
        return (history[max(place, 0)] if history else self.set_mm) - self.actual_mm

    # The latch, as the measuring run sees it

    def choose_latch(self, probe_input: int, edge: str) -> None:
        """Measure with another input or edge from the next run on.

        Raises Alarm 900223 when no cyclic telegram carries the latch object of both.
        """
        wanted = latch_object(probe_input, edge)
        if not self._pdos.choose_latch(wanted, counter_object(probe_input, edge)):
            raise Alarm(
                900223, axis=self.name, input=probe_input, edge=edge, object=f"0x{wanted:04X}"
            )
        self._take_up(probe_input, edge)

    def _take_up(self, probe_input: int, edge: str) -> None:
        self.probe_input, self.edge = probe_input, edge
        self.arrival.stamp = None
        source = "object" if self.settings.trigger_source == "DRIVE_DEFINED" else "input"
        self._function = probe_function(probe_input, edge, source=source)
        self._input_bit = input_bit(probe_input)
        if (probe_input, edge) not in self._watches:
            self._watches[probe_input, edge] = LatchWatch(
                self.name,
                enabled_bit(probe_input),
                stored_bit(probe_input, edge),
                self.settings.increments_per_mm,
            )
        self._latch = self._watches[probe_input, edge]
        self._check = self._checker()

    def _checker(self) -> LatchCheck | None:
        if self._checked_by is None:
            return None
        probe, edge = self.probe_input, self.edge
        return LatchCheck(
            self._checked_by,
            stored_bit(probe, edge),
            latch_object(probe, edge),
            counter_object(probe, edge),
            self._room,
        )

    def check_latches(self, sdo: SdoClient, room: StandstillRoom | None = None) -> None:
        """Believe a latch only when the drive reports it by SDO too; else telegrams are enough.

        room: where a cycle has none for SDO, see `LatchCheck`.
        """
        self._checked_by, self._room = sdo, room
        self._check = self._checker()

    def arm(self) -> None:
        """Enable the touch probe with the next telegram."""
        self._function_word = self._function
        self.doubt_mm = None
        self._latch.arm()
        if self._check is not None:
            self._check.begin()

    def disarm(self) -> None:
        """Switch the touch probe off with the next telegram."""
        self._function_word = 0
        self._latch.disarm()

    @property
    def is_probing(self) -> bool:
        """Whether the probe has been ordered on and not off again."""
        return self._latch.is_ordered

    @property
    def is_clear(self) -> bool:
        """Whether the drive shows neither an enabled probe nor a stored edge."""
        return self._latch.is_clear

    @property
    def is_armed(self) -> bool:
        """Whether the drive has acknowledged the enabled probe."""
        return self._latch.is_armed

    @property
    def has_latched(self) -> bool:
        """Whether the drive reports a stored edge."""
        return self._latch.has_latched

    @property
    def latched_mm(self) -> float | None:
        """The latched position, or None while it is not proved to be of the reported edge."""
        increments = self._latch.increments
        return None if increments is None else increments / self._per_mm

    @property
    def latched_speed_mm(self) -> float:
        """Travel in one cycle at the speed that the axis had at the latch."""
        return self._latch.speed_increments / self._per_mm

    @property
    def is_prepared(self) -> bool:
        """Whether everything is known that a latch will be checked with."""
        return self._check is None or self._check.is_ready

    def is_confirmed(self) -> bool:
        """Whether SDO has reported the latch too, or cannot: asks, or notes it as unproved."""
        increments = self._latch.increments
        if increments is None:
            return False
        if self._check is not None and self._check.agrees(increments):
            return True
        if self._check is not None and self._check.is_possible:
            return False
        self.unproved_latches += 1
        low, high = self._latch.plausible_increments
        self.doubt_mm = max(increments - low, high - increments) / self._per_mm
        return True

    @property
    def digital_inputs(self) -> int | None:
        """The digital inputs 0x60FD; None until a telegram has delivered them."""
        return self._sparse.values.get("inputs", self._inputs)

    @property
    def is_actuated(self) -> bool | None:
        """Whether the probe input has the level that the edge leads to; None without 0x60FD."""
        inputs = self.digital_inputs
        if inputs is None:
            return None
        level = bool(inputs & self._input_bit)
        return level == (self.edge == "POS")

    def _controlword(self) -> int:
        """Lead the drive on; out of a fault only the operator leads, never a running program."""
        state = self.state
        if state is State.FAULT and self.resets_fault:
            return ~self.controlword & RESET  # only a rising edge counts
        if state in (State.FAULT, State.FAULT_REACTION_ACTIVE):
            return STATES[State.FAULT].hold
        if self.stops_quickly and state is State.OPERATION_ENABLED:
            return COMMANDS[Command.QUICK_STOP].value
        if self._is_held_back:
            if state not in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE):
                return 0
            if self.power:
                return STATES[state].hold
        wanted = State.OPERATION_ENABLED if self.power else State.READY_TO_SWITCH_ON
        return controlword_towards(state, wanted)

    def send(self, set_mm: float) -> None:
        """Send set position, controlword and latch control word of this cycle."""
        is_usual = self.state is OPERATING and self.power and not self.stops_quickly
        self.controlword = (HOLD_OPERATION if is_usual else self._controlword()) | self.mode_bits
        self.set_mm = set_mm
        self._set_history.append(set_mm)
        self._has_sent = True
        values, position = self._control_out
        values[position] = self.controlword
        values, position = self._target_out
        target = round(set_mm * self._per_mm)
        self.is_still = target == values[position]
        values[position] = target
        values, position = self._function_out
        values[position] = self._function_word
        self._pdos.send()


def _needed(pdos: ProcessData, field: str) -> tuple[list[int], int]:
    found = pdos.sent_place(field)
    assert found is not None, f"the mapping table has been read without {field}"
    return found
