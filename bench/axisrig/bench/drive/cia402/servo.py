"""The drive without its bus: states, modes, stop reactions, monitoring, touch probe.

Has object values, the axis and the probe inputs. Each method gets the present simulated time.
"""

from collections.abc import Callable, Mapping

from axisrig.bench.drive.axis.drive import VirtualDrive
from axisrig.bench.drive.axis.motion import POSITION
from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.drive.axis.ticks import Ticker
from axisrig.bench.drive.cia402.assembly import make_parts
from axisrig.bench.drive.cia402.dictionary.image import PowerOnValues, ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.error_register import (
    COMMUNICATION_ERROR,
    PROFILE_ERROR,
    ErrorRegister,
)
from axisrig.bench.drive.cia402.functions.axis_states import NEXT, AxisEvent, AxisState
from axisrig.bench.drive.cia402.functions.sampler import SELDOM, Sampler
from axisrig.bench.drive.cia402.functions.states import (
    CONTINUE,
    OPTIONS,
    QUICK_STOP,
    Reaction,
    StateMachine,
)
from axisrig.bench.drive.cia402.functions.stop import Stop
from axisrig.bench.drive.cia402.functions.transitions import automatic
from axisrig.bench.drive.cia402.modes import MODES, Mode
from axisrig.bench.drive.cia402.monitor import FOLLOWING_ERROR, Monitor
from axisrig.bench.drive.cia402.refusals import refusal
from axisrig.kernel.profiles.cia402.ds402 import STATES, State, Status
from axisrig.kernel.time.clock import Clock, TimeNs

REFERENCE_LIMIT = 0x8612  # emergency code of CiA 402: a limit switch has stopped the axis
CONNECTION_LOST = 0x8130  # emergency code of CiA 301: life guarding or heartbeat
HALT = 1 << 8  # bit of the controlword
OPERATING = AxisState.OPERATING
AWAITS_MODE = (AxisState.BEGINNING, AxisState.RESUMING)
# Plain numbers: members of a flag cost ten times as much in each cycle
INTERNAL_LIMIT, WARNING = int(Status.INTERNAL_LIMIT), int(Status.WARNING)
TARGET_REACHED = int(Status.TARGET_REACHED)
_STATUSWORD = {
    state: pattern.value | Status.VOLTAGE_ENABLED.value | Status.REMOTE.value
    for state, pattern in STATES.items()
}


class Servo(VirtualDrive):
    """The application of a drive node.

    One SYNC is `begin`, then the new object values, then `cycle`. send_emergency(code, register,
    info) sends an emergency message; changed() is called when a tick has changed the statusword,
    entered(state) when the power drive system has taken a new state. switches: limit and home
    switches by their names (`switches.SWITCHES`). device_time: its clock at an instant in ns, for
    time stamps; None = simulated time. axis_state: what has the axis, and what follows.
    """

    def __init__(  # noqa: PLR0913
        self,
        axis: AxisPort,
        signals: tuple[SignalPort | None, SignalPort | None],
        profile: DriveProfile,
        send_emergency: Callable[[int, int, int], None],
        clock: Clock,
        changed: Callable[[], None],
        seed: int = 0,
        switches: Mapping[str, SignalPort] | None = None,
        *,
        entered: Callable[[State], None] | None = None,
        device_time: Callable[[TimeNs], int] | None = None,
    ) -> None:
        super().__init__(profile.tick_ns)
        self.axis, self._profile, self._clock, self._changed = axis, profile, clock, changed
        self.image = image = ProcessImage()
        self.power_on = PowerOnValues(profile)
        self.power_on.apply(image)
        self.emergency = ErrorRegister(image, send_emergency)
        parts = make_parts(axis, profile, image, signals, switches or {}, seed, device_time)
        self.scaling, self.limits, self.motion = parts.units, parts.limits, parts.motion
        self._standstill, self.interpolation = parts.standstill, parts.interpolation
        self.switches, self.touch_probe = parts.switches, parts.touch_probe
        self.latches, self.latch_watches = self.touch_probe.probes, self.touch_probe.watches
        self.machine = StateMachine(image, entered)
        self.modes = {mode.number: mode(parts) for mode in MODES if mode.needs in axis.kinds}
        self._ticker = Ticker(clock, profile.tick_ns, self._tick)
        self._sampler = Sampler(
            image, self.scaling, self.motion, self.limits, self.touch_probe, self.switches,
            profile.second_delay_cycles,
        )  # fmt: skip
        self._restart()

    def _restart(self) -> None:
        image = self.image
        image.supported_modes = sum(1 << number - 1 for number in self.modes)
        image.mode_display = image.mode
        self.mode: Mode = self.modes[image.mode]
        self.axis_state = AxisState.OFF
        self._stop: Stop | None = None  # while the state is neither OFF nor OPERATING
        self._began_ns = -1
        self._settled_word = -1  # the controlword that was carried out last
        self._monitor = Monitor(image, self.limits, self.axis)
        self._fault_code = self._following_error = 0  # the second: bit 13 of the statusword
        self.scaling.forget_home()
        self.limits.forget()
        self.interpolation.forget()
        self.update()

    def update(self) -> None:
        """Read scaling, limits and monitoring again, after a write by SDO."""
        self.scaling.update()
        self.limits.update()
        self.interpolation.update()
        self._monitor.update()

    @property
    def state(self) -> State:
        """State of the power drive system."""
        return self.machine.state

    @property
    def torque_limits(self) -> tuple[int, int, int]:
        """Objects 6072, 60E1 and 60E0."""
        image = self.image
        return image.max_torque, image.negative_torque_limit, image.positive_torque_limit

    @property
    def latch_instants_ns(self) -> list[list[TimeNs]]:
        """Instants of the edges that it has latched, by probe input."""
        return [probe.latch_instants_ns for probe in self.touch_probe.probes]

    @property
    def origin_units(self) -> int:
        """Where its zero is, in position units of its encoder."""
        return self.scaling.origin_units

    def watch(self, names: frozenset[str]) -> None:
        """Say which values telegrams carry; seldom ones that none carries cost no sampling."""
        self._sampler.is_watched = bool(names & SELDOM)

    def reset(self, now_ns: TimeNs) -> None:
        """Do what power off and on does: no torque, no error, default values, probes off."""
        self.axis.advance_to(now_ns)
        self.touch_probe.take_edges(now_ns)
        self.power_on.apply(self.image)
        self.touch_probe.reset()
        self.emergency.forget()
        self.machine.reset()
        self._restart()
        self.motion.off(now_ns)
        self.limits.limit_torque()
        self._ticker.need(False)
        self.refresh(now_ns)

    def begin(self, now_ns: TimeNs) -> None:
        """Step the plant to now and latch the edges that came until now."""
        self.axis.advance_to(now_ns)
        self.touch_probe.take_edges(now_ns)
        if self.switches.wired:
            self.switches.take_edges(now_ns)

    def cycle(self, now_ns: TimeNs) -> None:
        """Act on the object values, give the axis its demand of this SYNC period, sample."""
        self.begin_cycle(now_ns)
        self._step(now_ns, at_sync=True)
        self._ticker.lock()

    def react(self, now_ns: TimeNs) -> None:
        """Act on object values that were written between two SYNCs.

        Commands and the probe function act at once, a target of a cyclic mode at the next SYNC.
        """
        self._control(now_ns)
        self.touch_probe.set_function(self.image.probe_function, now_ns)
        self._need_ticks()
        self.refresh(now_ns)

    def refresh(self, now_ns: TimeNs, *, is_apart: bool = False) -> None:
        """Sample now, for who reads values outside a SYNC; is_apart: to send them in each cycle."""
        self.begin(now_ns)
        self._sample()
        self._sampler.sample_seldom(is_apart=is_apart)

    def refuses(self, index: int, value: int) -> int | None:
        """Return the abort code of a write that this drive or its state does not allow."""
        return refusal(index, value, self.modes, self._profile, self.motion, self.state, self.image)

    def connection_lost(self, now_ns: TimeNs, code: int = CONNECTION_LOST) -> None:
        """Act on a lost connection to the master as 6007 says. code: of the fault that 1 makes.

        Source: CiA 402-2, object 6007: 0 nothing, 1 fault, 2 disable voltage, 3 quick stop.
        """
        option = self.image.abort_option
        if option == 1:
            self.fault(code, COMMUNICATION_ERROR, now_ns)
        elif option in (2, 3):
            self.begin(now_ns)
            self.image.controlword = 0x0000 if option == 2 else 0x0002
            self.react(now_ns)
            self._changed()

    def fault(self, code: int, register_bit: int, now_ns: TimeNs) -> None:
        """Take a fault: emergency message, then the fault reaction (transition 13).

        code: emergency code. register_bit: its bit of the error register 1001. A fault that is
        active already is not taken again.
        """
        if self.state in (State.FAULT_REACTION_ACTIVE, State.FAULT):
            return
        self.begin(now_ns)
        option = self.machine.fault()
        self._fault_code = self.image.error_code = code
        if code == FOLLOWING_ERROR:
            self._following_error = int(Status.FOLLOWING_ERROR)
        if self.motion.kind is not None:
            self._brake(now_ns, option.reaction, at_actual=code == FOLLOWING_ERROR)
        self._need_ticks()
        self._sample()
        self.emergency.report(code, register_bit)

    def _tick(self) -> None:
        now_ns = self._clock.now_ns
        self.begin(now_ns)
        self.note_lag(self.axis)
        before = self.image.statusword
        self._step(now_ns, at_sync=False)
        if self.image.statusword != before:
            self._changed()

    def _step(self, now_ns: TimeNs, at_sync: bool) -> None:
        self._mind_limits(now_ns)
        image = self.image
        if (
            self.axis_state is OPERATING
            and image.controlword == self._settled_word
            and image.mode == image.mode_display
        ):  # the usual SYNC: nothing is asked for, nothing follows by itself
            self.limits.limit_torque()
        else:
            self._settle(now_ns)
            self._control(now_ns)
        if at_sync:
            self.touch_probe.cycle(image.probe_function, now_ns)
        if self.axis_state is OPERATING:
            if self._began_ns != now_ns:
                if at_sync:
                    self.mode.cycle(now_ns)
                else:
                    self.mode.tick(now_ns)
        elif self._stop is not None:
            self._stop.go_on(now_ns, self.tick_ns)
        elif self.motion.kind is None and at_sync:
            self.motion.off(now_ns)
        self._sample()
        if self._monitor.is_active and self.axis_state is OPERATING:
            code = self._monitor.look(now_ns)
            if code is not None:
                self.fault(code, PROFILE_ERROR, now_ns)
        if self._sampler.is_watched:
            self._sampler.sample_seldom(at_sync)
        self._need_ticks()

    def _mind_limits(self, now_ns: TimeNs) -> None:
        """Stop at a limit switch with the quick-stop ramp; only the way back is free then.

        A mode that minds limit switches itself is left alone.
        """
        if not self.switches.has_limits:
            return
        word, limits = self.switches.limits, self.limits
        has_mode = self.axis_state is OPERATING
        is_left = self.mode.minds_limits if has_mode else self._is_braking
        if word == limits.blocked or (is_left and word):
            return
        speed = self.motion.velocity_m_s(now_ns)
        is_met = self.switches.limit(speed) and not limits.blocked & word
        if not is_met or not has_mode:
            limits.block(word, self.motion.position_m())
            if not word:
                self.emergency.clear(REFERENCE_LIMIT)
        else:
            self.emergency.report(REFERENCE_LIMIT, PROFILE_ERROR)
            self._enter(AxisEvent.LIMIT_SWITCH, now_ns)
            self._begin_stop(now_ns, Reaction.QUICK_STOP)

    @property
    def _is_braking(self) -> bool:
        return self._stop is not None and not self._stop.is_done

    def _settle(self, now_ns: TimeNs) -> None:
        """Take the transitions that come by themselves: 1, 12 and 14, 5 and 8 after a ramp."""
        machine = self.machine
        if machine.state is State.NOT_READY_TO_SWITCH_ON:
            machine.state, _ = automatic(machine.state)
        stop = self._stop
        if stop is not None and not stop.is_done:
            return
        ends_by_itself = (State.QUICK_STOP_ACTIVE, State.FAULT_REACTION_ACTIVE)
        if machine.waiting is not None or machine.state in ends_by_itself:
            if machine.arrive():
                self._release(now_ns)
        elif self.axis_state in AWAITS_MODE:
            self._take_over(now_ns)

    def _control(self, now_ns: TimeNs) -> None:
        """Carry out what the controlword asks for, and a change of mode."""
        self.limits.limit_torque()
        number = self.machine.command()
        if number is not None:
            self._carry_out(number, now_ns)
        if self.image.mode != self.image.mode_display:
            self._change_mode(now_ns)
        if self.state is State.OPERATION_ENABLED and self.machine.waiting is None:
            self._halt_or_go_on(now_ns)
        self._settled_word = self.image.controlword

    def _carry_out(self, number: int, now_ns: TimeNs) -> None:
        machine = self.machine
        if number in (4, CONTINUE):
            self._enter(AxisEvent.ENABLE, now_ns)
            self._take_over(now_ns)
        elif machine.waiting is not None:
            self._brake(now_ns, machine.braking(number).reaction)
        elif number == QUICK_STOP:
            self._brake(now_ns, machine.option.reaction)
        elif number == 15:
            self._following_error = 0
            self.image.error_code = 0
            self.emergency.clear(self._fault_code)
        elif self.motion.kind is not None and machine.state not in (
            State.OPERATION_ENABLED,
            State.QUICK_STOP_ACTIVE,
        ):
            self._release(now_ns)

    def _halt_or_go_on(self, now_ns: TimeNs) -> None:
        if self.image.controlword & HALT:
            if self._enter(AxisEvent.HALT, now_ns):
                self._begin_stop(now_ns, OPTIONS[0x605D, self.image.halt_option].reaction)
        elif self._enter(AxisEvent.HALT_ENDS, now_ns):
            self._take_over(now_ns)
        if self.axis_state is OPERATING:
            self.mode.command(now_ns)

    def _change_mode(self, now_ns: TimeNs) -> None:
        """Follow 6060 unless a stop is under way; an unknown mode changes nothing."""
        mode = self.modes.get(self.image.mode)
        if mode is None:
            return
        if self._enter(AxisEvent.MODE, now_ns):
            self.mode = mode
            self._take_over(now_ns)
        elif self._stop is None or (self.axis_state is AxisState.HALTED and self._stop.is_done):
            self.mode, self.image.mode_display = mode, mode.number

    def _enter(self, event: AxisEvent, now_ns: TimeNs) -> bool:
        """Follow the table; return whether the state changes. A mode that loses the axis ends."""
        before = self.axis_state
        after = self.axis_state = NEXT[before, event]
        if before is OPERATING and after is not OPERATING:
            self.mode.end(now_ns)
        return after is not before

    def _take_over(self, now_ns: TimeNs) -> None:
        """Give the axis to the mode, now or when a stop is done.

        An axis that moves under control of velocity or force is stopped (6084) before a mode that
        controls its position; else the mode takes it over as it is.
        """
        is_other = self.motion.kind not in (None, self.mode.needs)
        if self.mode.needs is POSITION and is_other:
            stop = self._stop or self._begin_stop(now_ns, Reaction.SLOW_DOWN)
            if not stop.is_done:
                return
        self._stop = None
        if self.limits.blocked:  # the end is where the axis is now
            self.limits.block(0, 0.0)
            self.limits.block(self.switches.limits, self.motion.position_m())
        self.image.mode_display = self.mode.number
        resumes = self.axis_state is AxisState.RESUMING
        self._enter(AxisEvent.READY, now_ns)
        self._began_ns = now_ns
        self._settled_word = -1
        self._monitor.begin(self.mode)
        if resumes:
            self.mode.resume(now_ns)
        else:
            self.mode.begin(now_ns)

    def _release(self, now_ns: TimeNs) -> None:
        """Take the power away."""
        self._enter(AxisEvent.POWER_OFF, now_ns)
        self._stop = None
        self.motion.off(now_ns)

    def _brake(self, now_ns: TimeNs, reaction: Reaction, at_actual: bool = False) -> None:
        if reaction is Reaction.COAST:
            self._release(now_ns)
        else:
            self._enter(AxisEvent.STOP, now_ns)
            self._begin_stop(now_ns, reaction, at_actual)

    def _begin_stop(self, now_ns: TimeNs, reaction: Reaction, at_actual: bool = False) -> Stop:
        stop = self._stop = Stop(self.motion, self.limits, self._standstill, reaction)
        stop.begin(now_ns, self.tick_ns, at_actual)
        return stop

    def _need_ticks(self) -> None:
        if self.axis_state is OPERATING:
            is_needed = self._monitor.is_active or self.mode.needs_ticks or self.switches.has_limits
        else:
            is_needed = self._is_under_way()
        if is_needed is not self._ticker.is_running:
            self.note_lag(self.axis)
            self._ticker.need(is_needed)

    def _is_under_way(self) -> bool:
        """Whether something follows by itself while no mode has the axis."""
        machine, stop = self.machine, self._stop
        if machine.state is State.FAULT_REACTION_ACTIVE:
            return True
        if machine.state is State.QUICK_STOP_ACTIVE and machine.option.then is not machine.state:
            return True
        is_awaited = machine.waiting is not None or self.axis_state in AWAITS_MODE
        return stop is not None and (is_awaited or not stop.is_done)

    def _sample(self) -> None:
        self._sampler.sample()
        self.image.statusword = self._status()

    def _status(self) -> int:
        word = _STATUSWORD[self.machine.state] | self._following_error
        if self.axis_state is OPERATING:
            word |= self.mode.status()
            if self.mode.is_limited:
                word |= INTERNAL_LIMIT
            if self._monitor.is_warning:
                word |= WARNING
        elif self._stop is not None and self._stop.is_done:
            is_quick_stop = self.machine.state is State.QUICK_STOP_ACTIVE
            if is_quick_stop or self.axis_state is AxisState.HALTED:
                word |= TARGET_REACHED
        limits = self.limits
        if limits.blocked:
            word |= INTERNAL_LIMIT
        if limits.is_limiting and limits.is_torque_limited(limits.torque_per_mille()):
            word |= INTERNAL_LIMIT
        return word
