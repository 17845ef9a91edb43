"""The drive behind its bus: state machine, set value, following error, touch probe.

Knows object values (`ProcessImage`), the axis and the probe inputs, and nothing of CAN. Every
method gets the present simulated time.
"""

from collections.abc import Callable

from bench.drive.application.index_pulse import IndexPulse
from bench.drive.application.latch_position import LatchPosition
from bench.drive.application.touch_probe import (
    HARDWARE_INDEX,
    SOFTWARE_INDEX,
    Encoders,
    TouchProbe,
)
from bench.drive.communication.emergency import COMMUNICATION_ERROR, PROFILE_ERROR, Emergency
from bench.drive.image import ProcessImage
from bench.drive.ports import AxisPort, SignalPort
from bench.drive.profile import DriveProfile, Scaling
from kernel.clock import MS, US, S, TimeNs
from kernel.drives.ds402 import STATES, State, Status, automatic, input_bit, transition

FOLLOWING_ERROR = 0x8611  # emergency code of CiA 402
CONNECTION_LOST = 0x8130  # emergency code of CiA 301: life guarding or heartbeat
NOT_MONITORED = 0xFFFF_FFFF
_INPUT_SHIFT = input_bit(1).bit_length() - 1
_STATUSWORD = {
    state: pattern.value
    | Status.VOLTAGE_ENABLED.value
    | Status.REMOTE.value
    | (Status.FOLLOWS_COMMAND.value if state is State.OPERATION_ENABLED else 0)
    for state, pattern in STATES.items()
}


class Servo:
    """The application of a drive node in mode cyclic synchronous position.

    One SYNC is `begin`, then the new object values, then `cycle`. send_emergency(code, register)
    sends an emergency message.
    """

    def __init__(
        self,
        axis: AxisPort,
        signals: tuple[SignalPort | None, SignalPort | None],
        profile: DriveProfile,
        send_emergency: Callable[[int, int], None],
        seed: int = 0,
    ) -> None:
        self.axis = axis
        self.scaling = Scaling(profile)
        self.image = ProcessImage()
        self.image.set_defaults()
        self.emergency = Emergency(self.image, send_emergency)
        self.state, _ = automatic(State.NOT_READY_TO_SWITCH_ON)
        self.touch_probe = _touch_probe(axis, signals, profile, self.scaling, self.image, seed)
        self._controlword = 0
        self._follows = False
        self._exceeded_ns: TimeNs | None = None
        self._fault_code = 0
        self._following_error = 0  # bit 13 of the statusword

    def reset(self, now_ns: TimeNs) -> None:
        """Do what power off and on does: no torque, no error, default values, probes off."""
        self.axis.advance_to(now_ns)
        self.touch_probe.take_edges(now_ns)
        self.image.set_defaults()
        self.touch_probe.reset()
        self.emergency.forget()
        self.state, _ = automatic(State.NOT_READY_TO_SWITCH_ON)
        self._controlword = self._following_error = 0
        self._release(now_ns, self.axis.motor_position_m())
        self.refresh(now_ns)

    def begin(self, now_ns: TimeNs) -> None:
        """Bring the plant to now and latch the edges that came until now."""
        self.axis.advance_to(now_ns)
        self.touch_probe.take_edges(now_ns)

    def cycle(self, now_ns: TimeNs) -> None:
        """Act on the object values, give the axis its demand of this SYNC period, sample."""
        self.state, _ = automatic(self.state)
        self._control()
        self.touch_probe.cycle(self.image.probe_function, now_ns)
        motor_m = self.axis.motor_position_m()
        if self.state is State.OPERATION_ENABLED:
            demand_m = self._follow(now_ns, motor_m)
        else:
            demand_m = motor_m
            self._release(now_ns, motor_m)
        self._sample(motor_m, demand_m)
        if self._follows:
            self._monitor(now_ns)

    def react(self, now_ns: TimeNs) -> None:
        """Act on object values that were written between two SYNCs.

        Commands and the probe function act at once, a target at the next SYNC.
        """
        self._control()
        self.touch_probe.set_function(self.image.probe_function, now_ns)
        if self._follows and self.state is not State.OPERATION_ENABLED:
            self._release(now_ns, self.axis.motor_position_m())
        self.refresh(now_ns)

    def refresh(self, now_ns: TimeNs) -> None:
        """Sample now, for who reads values outside a SYNC."""
        self.begin(now_ns)
        motor_m = self.axis.motor_position_m()
        self._sample(motor_m, self.axis.demand_position_m() if self._follows else motor_m)

    def connection_lost(self, now_ns: TimeNs) -> None:
        """Act on a lost connection to the master as 6007 says.

        Source: CiA 402-2, object 6007: 0 nothing, 1 fault, 2 disable voltage, 3 quick stop.
        """
        self.fault(CONNECTION_LOST, COMMUNICATION_ERROR, now_ns)

    def fault(self, code: int, register_bit: int, now_ns: TimeNs) -> None:
        """Take a fault: emergency message, then the fault reaction (transition 13).

        code: emergency code. register_bit: its bit of the error register 1001. A fault that stands
        already is not taken again.
        """
        if self.state in (State.FAULT_REACTION_ACTIVE, State.FAULT):
            return
        self.begin(now_ns)
        motor_m = self.axis.motor_position_m()
        self.state = State.FAULT_REACTION_ACTIVE
        self._fault_code = code
        self._release(now_ns, motor_m)
        self._sample(motor_m, motor_m)
        self.emergency.report(code, register_bit)

    def _control(self) -> None:
        controlword = self.image.controlword
        self.state, number = transition(self.state, controlword, self._controlword)
        self._controlword = controlword
        if number == 15:  # fault reset
            self._following_error = 0
            self.emergency.clear(self._fault_code)

    def _follow(self, now_ns: TimeNs, motor_m: float) -> float:
        """Command the axis from its present demand to the target; return the present demand.

        Source: CiA 402-2, cyclic synchronous position: linear interpolation over one period.
        """
        image = self.image
        if not self._follows:
            # Whatever target stands there, operation starts where the axis is
            self._follows = True
            image.target_position = self.scaling.position_units(motor_m)
            self.axis.command(now_ns, motor_m, 0.0, now_ns, True)
            return motor_m
        demand_m = self.axis.demand_position_m()
        period_ns = image.sync_period_us * US
        target_m = self.scaling.position_m(image.target_position)
        velocity_m_s = (target_m - demand_m) * S / period_ns
        self.axis.command(now_ns, demand_m, velocity_m_s, now_ns + period_ns, True)
        return demand_m

    def _release(self, now_ns: TimeNs, motor_m: float) -> None:
        self._follows = False
        self.axis.command(now_ns, motor_m, 0.0, now_ns, False)

    def _sample(self, motor_m: float, demand_m: float) -> None:
        image, scaling, probe = self.image, self.scaling, self.touch_probe
        image.statusword = _STATUSWORD[self.state] | self._following_error
        image.position_actual = scaling.position_units(motor_m)
        image.velocity_actual = scaling.velocity_units_s(self.axis.motor_velocity_m_s())
        image.following_error = scaling.deviation_units(demand_m - motor_m)
        image.probe_status = probe.status
        image.digital_inputs = probe.inputs << _INPUT_SHIFT

    def _monitor(self, now_ns: TimeNs) -> None:
        """Fault when |60F4| has been above 6065 for the time 6066, at the tick of a SYNC."""
        image = self.image
        window = image.following_window
        if window == NOT_MONITORED or abs(image.following_error) <= window:
            self._exceeded_ns = None
            return
        if self._exceeded_ns is None:
            self._exceeded_ns = now_ns
        if now_ns - self._exceeded_ns >= image.following_timeout_ms * MS:
            self._following_error = Status.FOLLOWING_ERROR.value
            self.fault(FOLLOWING_ERROR, PROFILE_ERROR, now_ns)


def _touch_probe(
    axis: AxisPort,
    signals: tuple[SignalPort | None, SignalPort | None],
    profile: DriveProfile,
    scaling: Scaling,
    image: ProcessImage,
    seed: int,
) -> TouchProbe:
    """Make the touch probe unit on the encoders of an axis."""
    position_m_at = axis.motor_position_m_at
    motor = LatchPosition(profile, lambda time_ns: scaling.position_units(position_m_at(time_ns)))
    pulses = {
        HARDWARE_INDEX: IndexPulse(profile, position_m_at),
        SOFTWARE_INDEX: IndexPulse(profile, position_m_at, angle_deg=0.0),
    }
    return TouchProbe(signals, profile, Encoders(motor), image, pulses, seed)
