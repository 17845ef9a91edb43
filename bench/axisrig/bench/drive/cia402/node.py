"""A drive of CiA 402 with its supply; what carries its objects derives from it."""

from collections.abc import Callable, Mapping

from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.servo import Servo
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import Clock, TimeNs


class Cia402Node:
    """One drive: a servo that moves an axis and has up to two probe signals.

    probes: the signals wired to probe input 1 and 2, None for an open input. switches, entered,
    seed, device_time: as those of `Servo`. is_on: it has power.
    """

    def __init__(  # noqa: PLR0913
        self,
        name: str,
        clock: Clock,
        axis: AxisPort,
        probes: tuple[SignalPort | None, SignalPort | None],
        profile: DriveProfile,
        seed: int,
        *,
        switches: Mapping[str, SignalPort] | None = None,
        entered: Callable[[State], None] | None = None,
        device_time: Callable[[TimeNs], int] | None = None,
    ) -> None:
        self.name, self.profile = name, profile
        self.is_on = True
        self._clock = clock
        self.servo = Servo(
            axis,
            probes,
            profile,
            self._send_emergency,
            clock,
            self._changed,
            seed,
            switches,
            entered=entered,
            device_time=device_time,
        )

    @property
    def image(self) -> ProcessImage:
        """The object values that change while the drive runs."""
        return self.servo.image

    @property
    def state(self) -> State:
        """State of the power drive system."""
        return self.servo.state

    # Power

    def power_off(self) -> None:
        """Take the power away: the axis is free, and what carries the drive loses it.

        Stored parameters and settings of the carrier stay. To be called from an event.
        """
        if self.is_on:
            self.is_on = False
            self._stop()
            self.servo.reset(self._clock.now_ns)

    def power_on(self) -> None:
        """Give the power back: the drive boots with its stored parameters."""
        if not self.is_on:
            self.is_on = True
            self._boot()

    def restart(self) -> None:
        """Reset the drive as its watchdog would: power off and on at once."""
        self.power_off()
        self.power_on()

    def _switched_on(self) -> None:
        """Boot for the first time, unless the power has gone before."""
        if self.is_on:
            self._boot()

    # Of a carrier

    def _boot(self) -> None:
        raise NotImplementedError

    def _stop(self) -> None:
        """Leave the carrier."""
        raise NotImplementedError

    def _send_emergency(self, code: int, register: int, info: int) -> None:
        raise NotImplementedError

    def _changed(self) -> None:
        """Act on an object value that has changed between two cycles."""
        raise NotImplementedError
