"""A drive that only takes a speed, with the unit that counts and latches for it.

It takes its set values and samples its actual ones when its carrier says so. A family derives its
own: its images, its unit.
"""

from collections.abc import Callable, Mapping
from typing import Final, Protocol

from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cyclic.node import ImageNode
from axisrig.bench.drive.speed_drive import front
from axisrig.bench.drive.speed_drive.profile import SpeedProfile
from axisrig.bench.drive.speed_drive.speed import SPEED_MODE, SetSpeed
from axisrig.kernel.profiles.cia402.ds402 import ProbeFunction, ProbeStatus, State
from axisrig.kernel.profiles.speed_drive.words import Image
from axisrig.kernel.time.clock import Clock

_STOPS: Final = {"mode": SPEED_MODE, "shutdown_option": 1, "disable_option": 0}
"""Without the enable it stops by a ramp."""
_ENABLE: Final = int(ProbeFunction.ENABLE_1)
_EDGES: Final = {True: int(ProbeFunction.POSITIVE_1), False: int(ProbeFunction.NEGATIVE_1)}
_STORED: Final = {
    True: int(ProbeStatus.POSITIVE_STORED_1),
    False: int(ProbeStatus.NEGATIVE_STORED_1),
}


class Unit(Protocol):
    """What counts and latches. Positions are increments of the encoder."""

    def reset(self, position: int) -> None:
        """Be as after power on."""
        ...

    @property
    def has_own_power(self) -> bool:
        """Whether it goes on counting while the drive has no power."""
        ...

    def edges(self) -> tuple[bool, ...]:
        """Return the edges that it waits for, True = rising."""
        ...

    def pulse(self, edge: bool, position: int) -> None:
        """Take the edge that it waited for."""
        ...

    def command(self, values: dict[str, int], position: int) -> None:
        """Take an image, after the edges until now."""
        ...

    def inputs(self, position: int, *, level: bool) -> dict[str, int]:
        """Return what it puts into the image. level: of the probing input."""
        ...


class SpeedDriveNode(ImageNode):
    """One drive: it moves an axis, and its unit has one probe signal.

    Arguments as those of `Cia402Node`; made: its profile. images: to it, and from it.
    """

    def __init__(  # noqa: PLR0913
        self,
        name: str,
        clock: Clock,
        axis: AxisPort,
        probes: tuple[SignalPort | None, SignalPort | None],
        made: SpeedProfile,
        images: tuple[Image, Image],
        unit: Unit,
        seed: int = 0,
        *,
        switches: Mapping[str, SignalPort] | None = None,
        entered: Callable[[State], None] | None = None,
    ) -> None:
        super().__init__(name, clock, axis, probes[0], made.drive, seed, switches, entered)
        servo = self.servo
        self._made, self.unit = made, unit
        self._speed_m_s = float(made.speed_m_s)
        self._out, self._in = images
        self.speed = SetSpeed(servo.mode.parts)
        servo.modes[SPEED_MODE] = self.speed
        servo.power_on.own.update(_STOPS)
        servo.watch(frozenset())
        self._missing = 0

    def _boot(self) -> None:
        self._outputs = None
        self._control = self._missing = 0
        self.servo.reset(self._clock.now_ns)
        self.servo.update()
        self.unit.reset(self.servo.image.position_actual)
        self.sample()

    # What the carrier wakes up

    def sample(self) -> None:
        """Sample the actual values: the image that goes out next."""
        if not (self.is_on or self.unit.has_own_power):
            return
        servo = self.servo
        servo.refresh(self._clock.now_ns, is_apart=True)
        self._take_edges()
        level = bool(servo.touch_probe.inputs & 1)
        values = self.unit.inputs(servo.image.position_actual, level=level)
        drive = front.status(servo) if self.is_on else 0
        self.inputs = self._in.packed({"DRIVE": drive, **values})

    def exchange(self, outputs: bytes | None) -> bytes:
        """Swap images. outputs: None where none has come. Return the sampled one."""
        self._outputs = outputs
        return self.inputs

    def cycle(self) -> None:
        """Take the image that has come: one cycle of the drive."""
        if not self.is_on:
            return
        now_ns, servo = self._clock.now_ns, self.servo
        servo.begin(now_ns)  # plant, edges: under the values of the cycle that ends
        self._take_edges()
        if self._outputs is not None:
            self._missing = 0
            self._take(self._out.values_of(self._outputs))
            self._outputs = None
        else:
            self._missing += 1
            if self._missing > self._made.watchdog_cycles:
                self._take({})
        image: ProcessImage = servo.image
        image.controlword = front.controlword(servo, self._control)
        edges = self.unit.edges()
        image.probe_function = _ENABLE | sum(_EDGES[edge] for edge in edges) if edges else 0
        servo.cycle(now_ns)

    def _take(self, values: dict[str, int]) -> None:
        self._control = values.get("DRIVE", 0)
        self.speed.speed_m_s = self._made.given_out(values.get("SPEED", 0)) * self._speed_m_s
        self.unit.command(values, self.servo.image.position_actual)

    def _take_edges(self) -> None:
        image, status = self.servo.image, self.servo.touch_probe.status
        for edge in self.unit.edges():
            if status & _STORED[edge]:
                self.unit.pulse(edge, image.latch_1_positive if edge else image.latch_1_negative)
