"""What the control asks of a drive, whatever its words are and whatever carries them.

A family derives from `Drive`; the channel knows nothing else of it. Positions are millimetres on
the side of the control.
"""

from collections.abc import Callable
from typing import Protocol

from axisrig.kernel.drives.position_check import PositionCheck
from axisrig.kernel.drives.power import NEXT, Power, PowerOrder, PowerRequest
from axisrig.kernel.drives.set_points import SetPoints
from axisrig.kernel.drives.settings import DriveSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import Clock, TimeNs


class Drive(SetPoints):
    """One drive: set values out, actual values and latches in, once per cycle.

    It is the latch of its axis too (`measuring.run.LatchPort`), with the input and edge of
    `choose_latch`.
    power: as the drive reports it. request: as the control wants it; `acknowledges_faults`: also
    out of a fault. watches_lag: the CNC monitors the position lag, which it does not in a run to a
    fixed stop. second_age_cycles: since a value of the second encoder has come. unproved_latches:
    how many latches were taken without a proof. interpolated_latches: how many positions at the
    signal of the PLC are open. doubt_mm: how far the last of either may be wrong, None where there
    is a proof. warn: gets warnings that stop nothing. is_sercos: measuring type 6 takes its axis.
    place_check: proves where the axis stands before it follows set positions; None: nothing does.
    """

    def __init__(self, settings: DriveSettings, arrival: Arrival) -> None:
        super().__init__(
            settings.increments_per_mm, settings.lag_delay_cycles, settings.jump_mm, settings.loop
        )
        self.name, self.settings = settings.axis, settings
        self.arrival = arrival
        self.probe_input, self.edge = settings.probe_input, settings.edge
        self.power = Power.OFF
        self.request = PowerRequest.OFF
        self.keeps_operating = False  # request: on, or kept as it is
        self.acknowledges_faults = False
        self.watches_lag = True
        self.second_age_cycles = 0
        self.unproved_latches = self.interpolated_latches = 0
        self.doubt_mm: float | None = None
        self.warn: Callable[[Alarm], None] = _nobody
        self.is_sercos = False
        self.place_check: PositionCheck | None = None
        self._stood: int | None = None  # before a jump that nothing has proved yet, increments

    def order(self, order: PowerOrder) -> None:
        """Change the request for power (`power.csv`)."""
        self.request = NEXT.get((self.request, order), self.request)
        self.keeps_operating = self.request in (PowerRequest.ON, PowerRequest.KEEP)

    def _loop_mm_s(self, set_mm: float) -> float:
        """Return the set speed by the loop of the CNC, with the actual position of this cycle.

        Where the encoder counts nothing, or has jumped, it is the speed of the set positions alone:
        the axis stops with them.
        """
        assert self.loop is not None, "the CNC closes it"
        speed_mm_s = self.loop.speed_mm_s(set_mm, self.actual_mm)
        return self.loop.demand_mm_s if self._has_no_place(speed_mm_s) else speed_mm_s

    def _hold_loop(self, set_mm: float) -> None:
        """Take note of a cycle in which the drive does not follow."""
        self.close_loop()
        if self.loop is not None:
            self.loop.hold(set_mm, self.actual_mm)

    def _has_no_place(self, speed_mm_s: float) -> bool:
        """Whether no set speed may come of the actual position; at a fixed stop it may stand."""
        assert self.frozen is not None
        if not self.watches_lag:
            self.frozen.forget()
            return self.has_jumped
        self.frozen.note(speed_mm_s, self.actual_increments)
        return self.runs_open

    @property
    def runs_open(self) -> bool:
        """Whether the loop over the actual position is open, since that is none any more."""
        return self.frozen is not None and (self.has_jumped or self.frozen.is_frozen)

    def close_loop(self) -> None:
        """Believe the actual position again; the set position begins there, without a lag."""
        self.has_jumped = False
        if self.frozen is not None:
            self.frozen.forget()

    # Where the axis stands, before it follows set positions

    def _note_power(self, power: Power) -> None:
        """Take the power that the drive reports; out of operation it may stand anywhere."""
        if self.power is Power.OPERATING and power is not Power.OPERATING:
            self.forget_place()
        self.power = power

    def _take_place(self, increments: int) -> None:
        """Take an actual position; one that jumps before operation has to be proved anew."""
        before = self.actual_increments
        self._take_actual(increments)
        check = self.place_check
        if self.jump_mm is None or check is None or self.power is Power.OPERATING:
            return
        if check.is_proved:
            self._stood = before
        check.void()

    def find_place(self) -> None:
        """Ask the drive where it stands, until it reports what its telegrams do.

        Raises Alarm 900084 where it does not, 900085 where it reports nothing.
        """
        check = self.place_check
        if check is None or check.is_proved or not self.has_actual:
            return
        check.step(self.name, self.actual_increments, self._per_mm)
        if check.is_proved:
            self._stood = None

    def forget_place(self) -> None:
        """Let the place be proved anew: the axis may stand elsewhere, or has another reference."""
        self._stood = None
        if self.place_check is not None:
            self.place_check.void()

    @property
    def is_placed(self) -> bool:
        """Whether it is proved where the axis stands, or nothing proves it."""
        return self.place_check is None or self.place_check.is_proved

    @property
    def place_mm(self) -> float:
        """What a drive may be led from: the actual position; after a jump the one before it."""
        return self.actual_mm if self._stood is None else self._stood / self._per_mm

    # A cycle

    def begin_cycle(self) -> None:
        """Forget what is there: a cycle counts with its own answers only."""
        raise NotImplementedError

    def take(self) -> None:
        """Take what this cycle delivered; raises the alarms of what stayed out or cannot be."""
        raise NotImplementedError

    def send(self, set_mm: float) -> None:
        """Send the set values of this cycle."""
        raise NotImplementedError

    # Faults

    @property
    def state_name(self) -> str:
        """The state of the drive by the name that its family gives it."""
        raise NotImplementedError

    @property
    def is_in_fault(self) -> bool:
        """Whether the drive rests in a fault that may be acknowledged."""
        raise NotImplementedError

    @property
    def has_reported(self) -> bool:
        """Whether the drive has reported by itself what is wrong."""
        raise NotImplementedError

    def ask_for_fault(self) -> None:
        """Ask the drive for a fault that nobody has heard of; never waits."""
        raise NotImplementedError

    @property
    def is_asked(self) -> bool:
        """Whether an answer about a fault is still to come."""
        raise NotImplementedError

    def fault(self) -> Alarm:
        """Return the alarm of the fault that the drive is in."""
        raise NotImplementedError

    def forget_fault(self) -> None:
        """Begin anew: what led here is over."""
        raise NotImplementedError

    # The latch

    def choose_latch(self, probe_input: int, edge: str) -> None:
        """Measure with another input or edge from the next run on.

        Raises Alarm 900223 when the drive delivers no position of both.
        """
        raise NotImplementedError

    def arm(self) -> None:
        """Enable the latch."""
        raise NotImplementedError

    def disarm(self) -> None:
        """Switch the latch off."""
        raise NotImplementedError

    @property
    def is_probing(self) -> bool:
        """Whether the latch has been ordered on and not off again."""
        raise NotImplementedError

    @property
    def is_clear(self) -> bool:
        """Whether the drive shows neither an enabled latch nor a stored edge."""
        raise NotImplementedError

    @property
    def is_armed(self) -> bool:
        """Whether the drive has acknowledged the enabled latch."""
        raise NotImplementedError

    @property
    def is_prepared(self) -> bool:
        """Whether everything is known that a latch will be checked with."""
        raise NotImplementedError

    @property
    def is_actuated(self) -> bool | None:
        """Whether the input has the level that the edge leads to; None where it is not known."""
        raise NotImplementedError

    @property
    def digital_inputs(self) -> int | None:
        """The levels of the digital inputs, one bit each; None where they are not known."""
        return None

    @property
    def has_latched(self) -> bool:
        """Whether the drive reports a stored edge."""
        raise NotImplementedError

    @property
    def latched_mm(self) -> float | None:
        """The latched position, or None while it is not proved to be of the reported edge."""
        raise NotImplementedError

    @property
    def latched_speed_mm(self) -> float:
        """Travel in one cycle at the speed that the axis had at the latch."""
        raise NotImplementedError

    def is_confirmed(self) -> bool:
        """Whether there is a proof of the latch, or can be none, which is noted."""
        raise NotImplementedError

    # The second encoder

    @property
    def has_second(self) -> bool:
        """Whether the drive delivers a second encoder."""
        return False

    @property
    def second_increments(self) -> int | None:
        """Position of the second encoder; None until it has come."""
        return None

    def second_period_ns(self, cycle_ns: TimeNs) -> TimeNs | None:
        """Return how often the second encoder is promised, None where nothing promises it."""
        return None

    # Homing

    def home(self, clock: Clock) -> "DriveHoming":
        """Begin the homing of the axis by its drive."""
        raise NotImplementedError


class DriveHoming:
    """The homing of one axis by its drive; `step` is called once per cycle until `is_done`."""

    def step(self) -> None:
        """Look how far the drive is; raises the alarms of a homing that fails."""
        raise NotImplementedError

    def abort(self) -> None:
        """Break off: the drive stops the axis, and further steps lead it back to set positions."""
        raise NotImplementedError

    @property
    def is_done(self) -> bool:
        """Whether the axis is homed, or the homing broken off."""
        raise NotImplementedError


class DriveWatch:
    """The watch over one drive and its connection; asked once per cycle."""

    def begin(self) -> None:
        """Watch from now on; what came during the start-up does not count."""
        raise NotImplementedError

    def end(self) -> None:
        """Watch no more."""
        raise NotImplementedError

    def communication(self) -> Alarm | None:
        """Return what is wrong with the connection, None when nothing is."""
        raise NotImplementedError

    def condition(self) -> Alarm | None:
        """Return what is wrong with the drive itself, None when nothing is."""
        raise NotImplementedError


class DriveStart(Protocol):
    """The start-up of one drive."""

    def begin(self, ended: Callable[[Alarm | None], None]) -> None:
        """Start; `ended` is called once, with None or the alarm that it could not be started."""
        ...


class DriveAccesses:
    """What #DRIVE and #IDENT act on; as it is here, no drive has any function."""

    @property
    def is_waiting(self) -> bool:
        """Whether the program may not go on before a drive has answered."""
        return False

    @property
    def is_busy(self) -> bool:
        """Whether any answer is still to come."""
        return False

    def start(self) -> None:
        """Give parameters that are sent in every cycle the values they have from the start on."""

    def reset(self) -> None:
        """Let nothing wait for an answer any more; what is on its way goes on."""

    def check(self) -> None:
        """Begin a cycle: raise what has gone wrong with a command that ran beside the program."""

    def value(self, axis: str, key: str) -> float:
        """Return what the last read of a function returned."""
        raise KeyError(f"{axis}: {key}")

    def begin(self, command: canon.DriveCommand) -> None:
        """Begin one command; raises Alarm 900110 to 900112, 900255 and 900256."""
        if not isinstance(command, canon.DriveWait):
            raise Alarm(900110, axis=command.axis, key=command.key, known="none")


def _nobody(_alarm: Alarm) -> None:
    """Nobody listens yet."""
