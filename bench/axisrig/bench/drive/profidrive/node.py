"""A PROFIdrive drive: its telegrams, before the servo that other drives have too.

It takes its set values and samples its actual ones when its carrier says so. Source:
docs/profidrive.md.
"""

from collections.abc import Callable, Mapping
from typing import Final

from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.drive.cia402.functions.units import limit_i32
from axisrig.bench.drive.cyclic.node import ImageNode
from axisrig.bench.drive.profidrive import front
from axisrig.bench.drive.profidrive.encoder import EncoderInterface
from axisrig.bench.drive.profidrive.life import SignOfLife
from axisrig.bench.drive.profidrive.parameters import DriveParameters
from axisrig.bench.drive.profidrive.profile import ProfidriveProfile
from axisrig.bench.drive.profidrive.speed import SPEED_MODE, SpeedMode
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.profidrive import words
from axisrig.kernel.time.clock import Clock

LIFE_LOST: Final = 0x8130
LIFE_REGISTER: Final = 1 << 4
"""Code and bit of the fault that the drive makes of a lost sign of life."""
_STOPS: Final = {"mode": SPEED_MODE, "shutdown_option": 1, "disable_option": 0}
"""OFF1 stops by a ramp; taking away the enable bit takes the torque at once."""
_OUTPUT_WORDS: Final = ("STW1", "NSOLL_B", "STW2", "G1_STW", "XERR", "KPC", "MOMRED")


class ProfidriveDrive(ImageNode):
    """One drive: it moves an axis and has one probe signal at its fast input.

    Arguments as those of `Cia402Node`; profidrive: its profile. holds_life: by a fault; its sign of
    life stays.
    """

    def __init__(
        self,
        name: str,
        clock: Clock,
        axis: AxisPort,
        probes: tuple[SignalPort | None, SignalPort | None],
        profidrive: ProfidriveProfile,
        seed: int = 0,
        *,
        switches: Mapping[str, SignalPort] | None = None,
        entered: Callable[[State], None] | None = None,
    ) -> None:
        super().__init__(name, clock, axis, probes[0], profidrive.drive, seed, switches, entered)
        servo = self.servo
        self._made = profidrive
        self._speed_m_s = float(profidrive.speed_m_s)
        telegram = profidrive.telegram
        self._in, self._out = (
            words.codec_of(names) for names in (telegram.from_drive, telegram.to_drive)
        )
        self._places = tuple(
            telegram.to_drive.index(name) if name in telegram.to_drive else -1
            for name in _OUTPUT_WORDS
        )
        self.speed = SpeedMode(servo.mode.parts)
        servo.modes[SPEED_MODE] = self.speed
        servo.power_on.own.update(_STOPS)
        self.parameters = DriveParameters(profidrive)
        servo.watch(frozenset({"second_position"} if telegram.has_second else ()))
        self.encoder = EncoderInterface(
            servo.touch_probe, has_input=lambda: self.parameters.values[660] == words.PROBE_AT_INPUT
        )
        self.life = SignOfLife(lambda: self.parameters.values[925])
        self.holds_life = False
        self._encoder_control = self._own_life = self._heard = 0
        self._reduction = 0
        self._sampled_m = self._sent_m = self._sent_before_m = 0.0

    def _boot(self) -> None:
        self.encoder.reset()
        self.life.reset()
        self._outputs = None
        self._control = self._encoder_control = self._own_life = self._heard = 0
        self._reduction = 0
        self.parameters.reset()
        self.servo.reset(self._clock.now_ns)
        self.servo.update()
        self.sample()
        self._sent_m = self._sent_before_m = self._sampled_m

    # What the carrier wakes up

    def sample(self) -> None:
        """Sample the actual values: the telegram that goes out next."""
        if not self.is_on:
            return
        servo, image = self.servo, self.servo.image
        servo.refresh(self._clock.now_ns, is_apart=True)
        self._take_edges()
        if not self.holds_life:
            self._own_life = words.next_life(self._own_life)
        self._sampled_m = servo.scaling.position_m(image.position_actual)
        actual = servo.scaling.metres(image.velocity_actual) / self._speed_m_s
        shift = self._made.absolute_shift
        position = image.position_actual
        absolute = position << shift if shift >= 0 else position >> -shift
        values = {
            "ZSW1": front.status(servo, self._control),
            "NIST_B": limit_i32(round(actual)),
            "ZSW2": self._own_life << words.LIFE_SHIFT,
            "G1_ZSW": self.encoder.status(),
            "G1_XIST1": position,
            "G1_XIST2": self.encoder.value(words.signed(absolute)),
            "G2_XIST1": image.second_position,
        }
        self.inputs = self._in.pack(
            *(values.get(name, 0) for name in self._made.telegram.from_drive)
        )

    def exchange(self, outputs: bytes | None) -> bytes:
        """Swap telegrams. outputs: None where none has come. Return the sampled one."""
        self._outputs = outputs
        self._sent_before_m, self._sent_m = self._sent_m, self._sampled_m
        return self.inputs

    def answer(self, request: bytes) -> bytes:
        """Return the response to a request for a parameter; empty without power."""
        return self.parameters.answer(request) if self.is_on else b""

    def cycle(self) -> None:
        """Take the set values that have come: one cycle of the drive."""
        if not self.is_on:
            return
        now_ns, servo = self._clock.now_ns, self.servo
        servo.begin(now_ns)  # plant, edges: under the values of the cycle that ends
        self._take_edges()
        if self._outputs is not None:
            self._take(self._outputs)
            self._outputs = None
        self.life.take(self._heard)
        if self.life.is_lost:
            servo.fault(LIFE_LOST, LIFE_REGISTER, now_ns)
        self.encoder.command(self._encoder_control)
        image = servo.image
        image.controlword = front.controlword(servo, self._control)
        if image.controlword == front.RESET:
            self.life.reset()
        image.probe_function = self.encoder.function()
        image.max_torque = self.parameters.torque_limit(self._reduction)
        servo.cycle(now_ns)

    def _take(self, data: bytes) -> None:
        values = (*self._out.unpack(data), 0)
        control, speed, second, encoder, deviation, gain, reduction = (
            values[place] for place in self._places
        )
        self._heard = (second >> words.LIFE_SHIFT) & words.LIFE_VALUES
        if not control & words.BY_CONTROL:
            return
        self._control, self._encoder_control, self._reduction = control, encoder, reduction
        mode, metres = self.speed, self.servo.scaling.metres
        mode.speed_m_s = speed * self._speed_m_s
        mode.deviation_m = metres(deviation)
        mode.kpc_per_s = min(max(gain, 0), words.KPC_MAX) / words.KPC_PER_S
        mode.reference_m = self._sent_before_m

    def _take_edges(self) -> None:
        image = self.servo.image
        self.encoder.take_edges((image.latch_1_positive, image.latch_1_negative))
