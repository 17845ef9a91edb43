"""A drive with its supply whose carrier swaps one image in and out in each cycle."""

from collections.abc import Callable, Mapping

from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.node import Cia402Node
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import Clock, Phase


class ImageNode(Cia402Node):
    """One drive with one probe signal; the carrier samples it and swaps its image.

    Arguments as those of `Cia402Node`. inputs: its image as it was sampled last, empty while it has
    no power.
    """

    def __init__(
        self,
        name: str,
        clock: Clock,
        axis: AxisPort,
        probe: SignalPort | None,
        profile: DriveProfile,
        seed: int,
        switches: Mapping[str, SignalPort] | None,
        entered: Callable[[State], None] | None,
    ) -> None:
        super().__init__(
            name, clock, axis, (probe, None), profile, seed, switches=switches, entered=entered
        )
        self.inputs = b""
        self._outputs: bytes | None = None
        self._control = 0
        clock.call_at(clock.now_ns, Phase.APPLICATION, self._switched_on)

    def _stop(self) -> None:
        self.inputs = b""

    def _send_emergency(self, code: int, register: int, info: int) -> None:
        """A fault is a bit of the image; nothing is sent by itself."""

    def _changed(self) -> None:
        """Between two samples the image stays as it is."""
