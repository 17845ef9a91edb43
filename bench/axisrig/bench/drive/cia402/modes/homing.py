"""Mode 6, homing: a switch, a stop, the zero pulse or the place itself becomes the reference.

One engine carries out every row of `homing_methods.csv`. Switches are looked at in each tick of
the drive, so that an edge is exact to speed times tick (plus the delay of the input); the zero
pulse is exact to the increment. Source: CiA 402-2, homing mode.
"""

from enum import Enum, auto
from typing import ClassVar, Final

from axisrig.bench.drive.axis.hold_time import HoldTime
from axisrig.bench.drive.axis.ramp import to_velocity
from axisrig.bench.drive.axis.switches import NEGATIVE, POSITIVE
from axisrig.bench.drive.cia402.functions.homing_methods import METHODS
from axisrig.bench.drive.cia402.functions.limits import PER_MILLE
from axisrig.bench.drive.cia402.modes.base import Mode, Parts
from axisrig.bench.drive.cia402.modes.generator import Generator
from axisrig.kernel.profiles.cia402.ds402 import Status
from axisrig.kernel.time.clock import TimeNs

START: Final = 1 << 4  # bit of the controlword
STALLED: Final = 0.1  # below this share of the demanded speed an axis counts as blocked
PRESSED: Final = 0.9  # share of the homing torque from which on a stop is felt


class Step(Enum):
    """What the engine is about."""

    REST = auto()  # not started, interrupted, or at the end
    SEARCH = auto()  # for the switch
    PRESS = auto()  # against the stop
    BACK_OFF = auto()  # off the switch, to reach its edge once more from outside
    APPROACH = auto()  # to the edge of the switch
    INDEX = auto()  # to the zero pulse
    HALT = auto()  # to rest, with home found or with an error


class Homing(Mode):
    """Bits 13, 12, 10 of 6041: error; attained; rest (CiA 402-2, table of the homing mode).

    A method that needs a switch that is not wired, an axis that is blocked on its way, a limit
    switch in the way that the method does not turn round at, and both limit switches at once end
    in an error.
    """

    number: ClassVar[int] = 6
    follows_position: ClassVar[bool] = True
    minds_limits: ClassVar[bool] = True

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self._generator = Generator(parts)
        self._method = METHODS[35]
        self._step = Step.REST
        self._direction = 0
        self._attained = self._error = self._rests = self._reversed = False
        self._bit = self._was_on = self._went_back = False
        self._blocked = HoldTime()
        self._looked_ns: TimeNs = 0
        self._looked_m: float | None = None  # up to where a way without a switch is looked at

    def begin(self, now_ns: TimeNs) -> None:
        """Come to rest; a reference that was attained stays."""
        self._bit = bool(self.parts.image.controlword & START)
        self._error, self.is_following = False, True
        self._attained = self._attained and self.parts.units.is_homed
        self._finish(now_ns)

    def resume(self, now_ns: TimeNs) -> None:
        """Go on with the method after a halt; what was passed while braking is approached anew."""
        if self._step in (Step.REST, Step.HALT):
            self._finish(now_ns)
            return
        self.parts.touch_probe.homing(True, now_ns)
        step, direction, method, is_on = self._step, self._direction, self._method, self._is_on()
        if step is Step.INDEX and method.switch == "stop":
            step, direction = Step.PRESS, method.search
        elif method.switch == "none":
            if step is Step.INDEX and self._has_passed_mark():
                step, direction = Step.BACK_OFF, -method.approach
        elif step is Step.BACK_OFF and not is_on and self._went_back:
            step, direction = Step.APPROACH, method.approach
        elif step is Step.INDEX or (step is Step.APPROACH and is_on is method.level):
            if is_on:
                self._leave_switch(now_ns)
                return
            step, direction = Step.SEARCH, -method.approach
        self._enter(now_ns, step, direction)

    def command(self, now_ns: TimeNs) -> None:
        """Start with the rising edge of bit 4, break off with its falling edge."""
        bit = bool(self.parts.image.controlword & START)
        if bit and not self._bit:
            self._start(now_ns)
        elif not bit and self._bit and self._step is not Step.REST:
            self._attained = self._attained and self._step is Step.HALT
            self._finish(now_ns)
        self._bit = bit

    def end(self, now_ns: TimeNs) -> None:
        """Give the axis away; `resume` may follow."""
        self._went_back = self._generator.on_course(now_ns)[1] * self._direction > 0.0
        if self._step is Step.INDEX and self._method.switch == "none":
            looked_m = self.parts.motion.axis.motor_position_m_at(self._looked_ns)
            if self._looked_m is None or self._is_beyond(looked_m):
                self._looked_m = looked_m
        self._release(now_ns)

    def status(self) -> int:
        """Bits 10, 12 and 13."""
        is_reached = self._rests and self.parts.homing_bit_10
        word = int(Status.TARGET_REACHED) if is_reached else 0
        word |= int(Status.HOMING_ATTAINED) if self._attained else 0
        return word | (int(Status.HOMING_ERROR) if self._error else 0)

    # Steps

    def _start(self, now_ns: TimeNs) -> None:
        parts = self.parts
        self._attained = self._error = self._reversed = False
        self._looked_m = None
        method = METHODS.get(parts.image.homing_method)
        switches = parts.switches
        is_lacking = method is None or (
            method.switch not in ("none", "stop") and method.switch not in switches.wired
        )
        if method is None or is_lacking:
            self._fail(now_ns)
            return
        self._method = method
        parts.touch_probe.homing(True, now_ns)
        if method.switch == "stop":
            self._enter(now_ns, Step.PRESS, method.search)
        elif method.switch == "none":
            if method.approach:
                self._enter(now_ns, Step.INDEX, method.approach)
            else:
                self._attain(now_ns, parts.motion.axis.motor_position_m())
        elif switches.is_on(method.switch):
            self._leave_switch(now_ns)
        else:
            self._enter(now_ns, Step.SEARCH, method.search)

    def _leave_switch(self, now_ns: TimeNs) -> None:
        """On the switch: to its edge, or first off it to reach the edge from outside."""
        method = self._method
        if method.level:
            self._enter(now_ns, Step.BACK_OFF, -method.approach)
        else:
            self._enter(now_ns, Step.APPROACH, method.approach)

    def _enter(
        self, now_ns: TimeNs, step: Step, direction: int, start: tuple[float, float] | None = None
    ) -> None:
        """Begin a step: move with its speed. start: of the demand, None = as it is."""
        parts, image = self.parts, self.parts.image
        self._step, self._direction = step, direction
        is_search = step in (Step.SEARCH, Step.PRESS)
        units_s = image.homing_speed_switch if is_search else image.homing_speed_zero
        speed = min(parts.units.metres(max(1, units_s)), parts.limits.profile_m_s)
        parts.limits.homing_torque = parts.homing_torque if step is Step.PRESS else None
        parts.limits.limit_torque()
        if step is Step.PRESS:
            self.is_following = False
        self._move(now_ns, direction * speed, start)
        self._rests = False
        self._blocked.since_ns = None
        self._was_on = self._is_on()
        self._looked_ns = now_ns

    def _move(
        self, now_ns: TimeNs, velocity_m_s: float, start: tuple[float, float] | None = None
    ) -> None:
        rate = self.parts.units.metres(max(1, self.parts.image.homing_acceleration))
        begin = start or self._generator.present(now_ns)
        self._generator.start(now_ns, to_velocity(begin, velocity_m_s, (rate, rate)))
        self._generator.go_on(now_ns)
        self.needs_ticks = True

    def tick(self, now_ns: TimeNs) -> None:
        """Lead the demand on and look at switches, zero pulse and stop."""
        # Not in the tick that leaves the stop: the demand is still that of its begin
        self.is_following = self._step is not Step.PRESS
        if self._step in (Step.REST, Step.HALT):
            self._look_for_rest(now_ns)
            return
        is_on = self._is_on()
        if self._meets_limit(now_ns) or self._is_blocked(now_ns):
            self._was_on = is_on
            return
        if self._step is Step.SEARCH and is_on:
            self._leave_switch(now_ns)
        elif self._step is Step.BACK_OFF and self._was_on and not is_on:
            self._enter(now_ns, Step.APPROACH, self._method.approach)
        elif self._step is Step.BACK_OFF and self._is_behind():
            self._enter(now_ns, Step.INDEX, self._method.approach)
        elif (
            self._step is Step.APPROACH
            and is_on is self._method.level
            and self._was_on is not self._method.level
        ):
            if self._method.zero_pulse:
                self._enter(now_ns, Step.INDEX, self._method.approach)
            else:
                self._attain(now_ns, self.parts.motion.axis.motor_position_m())
        elif self._step is Step.INDEX:
            self._look_for_index(now_ns)
        self._was_on = is_on
        if self._step not in (Step.REST, Step.HALT):
            self._generator.go_on(now_ns)

    def _is_on(self) -> bool:
        switch = self._method.switch
        return switch not in ("none", "stop") and self.parts.switches.is_on(switch)

    def _meets_limit(self, now_ns: TimeNs) -> bool:
        """Turn round or give up at a limit switch that is in the way; return whether."""
        switches, method = self.parts.switches, self._method
        is_own = self._step is Step.SEARCH and method.switch in (NEGATIVE, POSITIVE)
        if switches.is_on(NEGATIVE) and switches.is_on(POSITIVE):
            self._fail(now_ns)
            return True
        if is_own or not switches.limit(self._direction):
            return False
        if self._step is Step.SEARCH and method.reverses and not self._reversed:
            self._reversed = True
            self._enter(now_ns, Step.SEARCH, -self._direction)
        else:
            self._fail(now_ns)
        return True

    def _is_blocked(self, now_ns: TimeNs) -> bool:
        """Take an axis at rest that should move for the stop, or for an error; return whether."""
        parts = self.parts
        wanted = abs(self._generator.on_course(now_ns)[1])
        is_slow = abs(parts.motion.axis.motor_velocity_m_s()) <= STALLED * wanted
        if self._step is Step.PRESS and is_slow and parts.limits.is_limiting:
            limit = parts.limits.positive if self._direction > 0 else parts.limits.negative
            torque = parts.limits.torque_per_mille() * self._direction
            is_force_known = parts.motion.axis.force_n() is not None
            is_slow = torque >= PRESSED * min(limit, PER_MILLE * 10) or not is_force_known
        if not self._blocked.holds(now_ns, is_slow, parts.homing_stop_ms):
            return False
        if self._step is not Step.PRESS:
            self._fail(now_ns)
            return True
        here_m = parts.motion.axis.motor_position_m()
        if self._method.zero_pulse:
            self._enter(now_ns, Step.INDEX, self._method.approach, (here_m, 0.0))
        else:
            self._attain(now_ns, here_m, (here_m, 0.0))
        return True

    def _look_for_index(self, now_ns: TimeNs) -> None:
        parts = self.parts
        edges = parts.index.edges(self._looked_ns, now_ns)
        self._looked_ns = now_ns
        rising = [edge for edge in edges if edge.level and self._is_beyond(edge.position_m)]
        if rising:
            # Upwards the pulse rises at its lower side, downwards at its upper one
            width_m = 0.0 if self._direction > 0 else 1.0 / parts.units.increments_per_m
            self._attain(now_ns, rising[0].position_m - width_m)

    # Without a switch: a zero pulse in the way of a halt is approached anew

    def _has_passed_mark(self) -> bool:
        begin_m, end_m = self._looked_m, self.parts.motion.axis.motor_position_m()
        return begin_m is not None and self.parts.index.rises_between(begin_m, end_m)

    def _is_behind(self) -> bool:
        return self._method.switch == "none" and not self._is_beyond(
            self.parts.motion.axis.motor_position_m()
        )

    def _is_beyond(self, place_m: float) -> bool:
        """Return whether a place is still to be looked at."""
        looked_m = self._looked_m
        return looked_m is None or (place_m - looked_m) * self._method.approach >= 0.0

    # Ends

    def _attain(
        self, now_ns: TimeNs, home_m: float, start: tuple[float, float] | None = None
    ) -> None:
        """Take a place as home and come to rest."""
        parts = self.parts
        parts.set_home(home_m)
        self._attained = True
        self._finish(now_ns, start)

    def _fail(self, now_ns: TimeNs) -> None:
        self._error = True
        self._finish(now_ns)

    def _finish(self, now_ns: TimeNs, start: tuple[float, float] | None = None) -> None:
        """Come to rest with 609A."""
        was_pressing = self._step is Step.PRESS
        self._step, self._direction = Step.HALT, 0
        self._release(now_ns)
        if start is None and was_pressing:
            start = (self.parts.motion.axis.motor_position_m(), 0.0)
        self.parts.standstill.begin()
        self._rests = False
        self._move(now_ns, 0.0, start)
        self._look_for_rest(now_ns)

    def _look_for_rest(self, now_ns: TimeNs) -> None:
        if self._step is Step.HALT:
            self._generator.go_on(now_ns)
            has_ended = self._generator.time_s(now_ns) >= self._generator.course.duration_s
            if has_ended and self.parts.standstill.holds(now_ns):
                self._step, self._rests = Step.REST, True
                self.needs_ticks = False

    def _release(self, now_ns: TimeNs) -> None:
        """Give torque limit and probes back."""
        parts = self.parts
        if parts.limits.homing_torque is not None:
            parts.limits.homing_torque = None
            parts.limits.limit_torque()
        parts.touch_probe.homing(False, now_ns)
