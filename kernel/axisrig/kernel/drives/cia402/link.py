"""The control's end of one drive of CiA 402: set values out, actual values and latches in.

All data of the machine that the kernel gets come through here. Positions are millimetres on the
kernel's side and increments on the wire. What carries the values is `CyclicData`.
"""

from typing import Final

from axisrig.kernel.drives.cia402.active_fault import ActiveFault
from axisrig.kernel.drives.cia402.actual_position import BY_SDO, asked_by_sdo
from axisrig.kernel.drives.cia402.cyclic_data import CyclicData, Values
from axisrig.kernel.drives.cia402.homing import AxisHoming
from axisrig.kernel.drives.cia402.latch_check import LatchCheck, StandstillRoom
from axisrig.kernel.drives.cia402.latch_watch import LatchWatch
from axisrig.kernel.drives.cia402.objects import ObjectAccess, SdoError
from axisrig.kernel.drives.cia402.power_words import BEFORE_OPERATION, POWER, RESET, WORDS
from axisrig.kernel.drives.cia402.settings import Cia402Settings
from axisrig.kernel.drives.cia402.words import (
    counter_object,
    enabled_bit,
    input_bit,
    latch_object,
    probe_function,
    state_of,
    stored_bit,
)
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.drives.position_check import PositionCheck
from axisrig.kernel.drives.position_loop import PositionLoop
from axisrig.kernel.drives.power import PowerRequest
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.profiles.canopen.emergency import Emergency
from axisrig.kernel.profiles.cia402.ds402 import STATES, State
from axisrig.kernel.time.clock import Clock

SPEED_MAX: Final = (1 << 31) - 1  # 60FF is a signed number of 32 bits
CONTROLWORD, TARGET_VELOCITY = 0x6040, 0x60FF
OPERATING: Final = State.OPERATION_ENABLED
HOLD_OPERATION: Final = STATES[OPERATING].hold


class Cia402Drive(Drive):
    """One drive, read and written once per cycle.

    data: its cyclic values. sdo: asks the drive beside the cycle. proves_latches: a latch counts
    only when the drive reports it by SDO too; else cyclic values are enough. proves_places: so with
    the position from which it is led into operation. room: where a cycle has none for SDO
    (`LatchCheck`). mode_bits: bits of the controlword that belong to the mode.
    unproved_latches: those that were believed by cyclic values alone; SDO proves the others.
    """

    def __init__(
        self,
        settings: Cia402Settings,
        data: CyclicData,
        sdo: ObjectAccess | None = None,
        *,
        proves_latches: bool = False,
        proves_places: bool = False,
        room: StandstillRoom | None = None,
    ) -> None:
        arrival = Arrival(
            settings.status_delay_cycles, settings.missing_cycles, settings.stamps, is_new=False
        )
        super().__init__(settings, arrival)
        self._of_drive, self.sdo, self.node_id = settings, sdo, settings.node_id
        self._checked_by = sdo if proves_latches else None
        self._room = room
        if proves_places and sdo is not None:
            self.place_check = PositionCheck(asked_by_sdo(sdo, room), BY_SDO)
        self._watches: dict[tuple[int, str], LatchWatch] = {}
        self._take_up(settings.probe_input, settings.edge)
        self._data = data
        self._control_out = _needed(data, "controlword")
        self._target_out = _needed(data, "target" if self.loop is None else "speed")
        self._last_target = 0  # set position in increments
        self._function_out = data.sent_place("probe_function") or ([0], 0)
        self.statusword = 0
        self.state = State.NOT_READY_TO_SWITCH_ON
        self._inputs: int | None = None
        self._second: int | None = None
        self.emergency: Emergency | None = None
        self._active_fault: ActiveFault | None = None
        self.controlword = 0
        self.mode_bits = 0
        self._function_word = 0
        self._repeats = False  # by SDO, once the set position stands

    def note_emergency(self, data: bytes | bytearray) -> None:
        """Take an emergency message that the drive has sent, eight bytes."""
        emergency = Emergency.read(data)
        if emergency.reaction != "none":
            self.emergency = emergency

    def begin(self) -> None:
        """Begin the exchange: what came during the start-up does not count."""
        self._data.begin()
        self.emergency = None

    def begin_cycle(self) -> None:
        """Forget what is there: a SYNC counts with its own answers only.

        Called with every SYNC as well as after taking, because an answer may come late.
        """
        self._data.begin_cycle()

    def take(self) -> None:
        """Take what this cycle's SYNC delivered.

        A telegram that came twice with different contents, or whose status word cannot be, counts
        as one that stayed out. Raises Alarm 900006, 900080 or 900081 when that lasts, 900028 for
        one that does not fit its mapping.
        """
        data = self._data
        self._has_sent = False
        word, actual, probe, latch, count, inputs, second, stamp = data.take()
        if word is not None and word != self.statusword:
            self._enter(word)
        if actual is not None:
            self._take_place(actual)
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
        if data.wrong_length is not None:
            name, length, expected = data.wrong_length
            data.wrong_length = None
            raise Alarm(900028, axis=self.name, pdo=name, length=length, expected=expected)
        if data.is_disturbed:
            self._judge_missing()

    def _enter(self, word: int) -> None:
        """Take a new status word."""
        self.statusword, self.state = word, state_of(word)
        self._note_power(POWER[self.state])

    def _note_second(self, second: int | None) -> None:
        if second is not None:
            self._second = second
        self.second_age_cycles = 0 if second is not None else self.second_age_cycles + 1

    # Faults

    @property
    def state_name(self) -> str:
        """The state of CiA 402."""
        return self.state.name

    @property
    def is_in_fault(self) -> bool:
        """Whether the drive is in FAULT; its fault reaction is over."""
        return self.state is State.FAULT

    @property
    def has_reported(self) -> bool:
        """Whether an emergency has come."""
        return self.emergency is not None

    def ask_for_fault(self) -> None:
        """Ask the drive for a fault that no emergency has reported."""
        self._active_fault = ActiveFault(self.sdo)
        self._active_fault.ask()

    @property
    def is_asked(self) -> bool:
        """Whether an answer about a fault is still to come."""
        return self._active_fault is not None and self._active_fault.is_open

    def fault(self) -> Alarm:
        """Return Alarm 900005 with what the drive reports of its fault."""
        found = self._active_fault if self.emergency is None else self.emergency
        words = "none" if found is None else str(found)
        return Alarm(900005, axis=self.name, statusword=f"0x{self.statusword:04X}", emcy=words)

    def forget_fault(self) -> None:
        """Begin anew: what led here is over."""
        self.emergency, self._active_fault = None, None
        self.acknowledges_faults = False

    @property
    def is_disturbed(self) -> bool:
        """Whether a telegram of the last SYNC is missing."""
        return self._data.is_disturbed

    def _judge_missing(self) -> None:
        data, allowed = self._data, self._of_drive.missing_cycles
        if max(data.missing) == allowed + 1:
            self._repeats = self.leads_itself or self.loop is not None
        for slot, missing in enumerate(data.missing):
            if missing > allowed:
                raise data.missing_alarm(self.name, slot)

    def get_object(self, index: int, sub: int) -> int:
        """Return the value that an RPDO carries for an object; KeyError when none carries it."""
        values, position = self._object(index, sub)
        return values[position]

    def set_object(self, index: int, sub: int, value: int) -> None:
        """Let the RPDOs carry a value from the next one on; KeyError when none carries it."""
        values, position = self._object(index, sub)
        values[position] = value

    def _object(self, index: int, sub: int) -> Values:
        found = self._data.sent_object(index, sub)
        if found is None:
            raise KeyError(f"0x{index:04X}:{sub:X} is in no RPDO of axis {self.name}")
        return found

    def forget(self) -> None:
        """Forget latch and state: the drive has restarted, its positions mean something else."""
        self._function_word = 0
        self.forget_place()
        for watch in self._watches.values():
            watch.restart()
        self.statusword, self.state = 0, State.NOT_READY_TO_SWITCH_ON
        self.power = POWER[self.state]

    @property
    def second_increments(self) -> int | None:
        """Position of the second encoder 0x60E4:1; None until a telegram has delivered it."""
        return self._second

    def home(self, clock: Clock) -> AxisHoming:
        """Begin the homing of the axis by its drive."""
        assert self.sdo is not None, "the drive cannot be asked"
        return AxisHoming(self, clock, self.sdo, self._of_drive.homing_limit_ns)

    # The latch, as the measuring run sees it

    def choose_latch(self, probe_input: int, edge: str) -> None:
        """Measure with another input or edge from the next run on.

        Raises Alarm 900223 when no cyclic telegram carries the latch object of both.
        """
        wanted = latch_object(probe_input, edge)
        if not self._data.choose_latch(wanted, counter_object(probe_input, edge)):
            raise Alarm(
                900223, axis=self.name, input=probe_input, edge=edge, object=f"0x{wanted:04X}"
            )
        self._take_up(probe_input, edge)

    def _take_up(self, probe_input: int, edge: str) -> None:
        self.probe_input, self.edge = probe_input, edge
        self.arrival.stamp = None
        source = "object" if self._of_drive.trigger_source == "DRIVE_DEFINED" else "input"
        self._function = probe_function(probe_input, edge, source=source)
        self._input_bit = input_bit(probe_input)
        if (probe_input, edge) not in self._watches:
            self._watches[probe_input, edge] = LatchWatch(
                self.name,
                enabled_bit(probe_input),
                stored_bit(probe_input, edge),
                self._of_drive.increments_per_mm,
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
        return self._inputs

    @property
    def is_actuated(self) -> bool | None:
        """Whether the probe input has the level that the edge leads to; None without 0x60FD."""
        inputs = self.digital_inputs
        if inputs is None:
            return None
        level = bool(inputs & self._input_bit)
        return level == (self.edge == "POS")

    def _controlword(self) -> int:
        """Lead the drive as requested; out of a fault only where faults are acknowledged."""
        state = self.state
        if state is State.FAULT and self.acknowledges_faults:
            return ~self.controlword & RESET  # only a rising edge counts
        if state in BEFORE_OPERATION and self.request is PowerRequest.ON and not self.is_placed:
            return STATES[state].hold
        return WORDS[self.request, state]

    def send(self, set_mm: float) -> None:
        """Send set position, controlword and latch control word of this cycle."""
        is_usual = self.state is OPERATING and self.keeps_operating
        self.controlword = (HOLD_OPERATION if is_usual else self._controlword()) | self.mode_bits
        self._note_sent(set_mm)
        values, position = self._control_out
        values[position] = self.controlword
        values, position = self._target_out
        target = round(set_mm * self._per_mm)
        self.is_still = target == self._last_target
        self._last_target = target
        values[position] = target if self.loop is None else self._set_speed(self.loop, set_mm)
        values, position = self._function_out
        values[position] = self._function_word
        self._data.send()
        if self._repeats and self.is_still:
            self._repeat_by_sdo()

    def _repeat_by_sdo(self) -> None:
        """Write by SDO what the cyclic values say to a drive that sends none any more.

        In pre-operational it does not hear them, and homing or a set speed would go on. One that
        does hear them gets nothing new. The set speed is 0: less than an increment in the last
        cycle would be a speed for ever. Source: CiA 301, NMT states; docs/ambiguities.md.
        """
        self._repeats = False
        if self.sdo is None:
            return
        self.sdo.write(CONTROLWORD, 0, self.controlword.to_bytes(2, "little"), _not_needed)
        if self.loop is not None:
            self.sdo.write(TARGET_VELOCITY, 0, bytes(4), _not_needed)

    def _set_speed(self, loop: PositionLoop, set_mm: float) -> int:
        """Return 60FF: what the position loop says while the drive follows, else standstill."""
        if self.state is not OPERATING or self.leads_itself:
            self._hold_loop(set_mm)
            return 0
        if self._actual_age is None or self._actual_age > self._of_drive.missing_cycles:
            speed = round(loop.open_mm_s(set_mm) * self._per_mm)
        else:
            speed = round(self._loop_mm_s(set_mm) * self._per_mm)
        return max(-SPEED_MAX, min(speed, SPEED_MAX))


def _not_needed(_answer: bytes | SdoError) -> None:
    """Nothing hangs on the answer: the program has ended by then."""


def _needed(data: CyclicData, field: str) -> Values:
    found = data.sent_place(field)
    assert found is not None, f"the mapping table has been read without {field}"
    return found
