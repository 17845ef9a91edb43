"""What every mode of operation offers to the drive that runs it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

from axisrig.bench.drive.axis.index_pulse import IndexPulse
from axisrig.bench.drive.axis.motion import Motion
from axisrig.bench.drive.axis.ports import ControlKind
from axisrig.bench.drive.axis.switches import Switches
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.functions.interpolation import InterpolationTime
from axisrig.bench.drive.cia402.functions.limits import Limits
from axisrig.bench.drive.cia402.functions.stop import Standstill
from axisrig.bench.drive.cia402.functions.touch_probe import TouchProbe
from axisrig.bench.drive.cia402.functions.units import Units
from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True, slots=True)
class Parts:
    """The parts of a drive that a mode works with.

    set_home: makes a place (m) the machine home position. homing_torque: in per mille, with
    which homing presses against a stop; homing_stop_ms: for how long it must be at rest there.
    holds_velocity: a velocity of csv acts at once, not evenly over a period. homing_bit_10: homing
    says too that its target is reached.
    """

    image: ProcessImage
    units: Units
    limits: Limits
    motion: Motion
    standstill: Standstill
    tick_ns: TimeNs
    switches: Switches
    index: IndexPulse
    touch_probe: TouchProbe
    set_home: Callable[[float], None]
    homing_torque: int
    homing_stop_ms: int
    interpolation: InterpolationTime
    holds_velocity: bool
    homing_bit_10: bool


class Mode:
    """A mode of operation; `begin` and `end` are around its time, ticks and SYNCs in it.

    number: its value of 6060; it has bit number - 1 of 6502. needs: the control that the plant
    must offer. follows_position: whether there is a following error to monitor; is_following:
    whether there is one now. limits_speed: whether the speed is monitored, since nothing else
    limits it. minds_limits: it acts on limit switches itself.
    needs_ticks: whether it has something to do between two SYNCs. is_limited: whether a limit of
    the drive keeps it from its target (bit 11 of 6041).
    """

    number: ClassVar[int]
    needs: ClassVar[ControlKind] = ControlKind.POSITION
    follows_position: ClassVar[bool] = False
    limits_speed: ClassVar[bool] = False
    minds_limits: ClassVar[bool] = False

    def __init__(self, parts: Parts) -> None:
        self.parts = parts
        self.needs_ticks = False
        self.is_limited = False
        self.is_following = self.follows_position

    def begin(self, now_ns: TimeNs) -> None:
        """Take the axis over as it is, moving or not."""

    def resume(self, now_ns: TimeNs) -> None:
        """Go on after a halt."""
        self.begin(now_ns)

    def command(self, now_ns: TimeNs) -> None:
        """Look at the bits of the controlword that belong to the mode."""

    def cycle(self, now_ns: TimeNs) -> None:
        """Act at a SYNC, under its values."""
        self.tick(now_ns)

    def tick(self, now_ns: TimeNs) -> None:
        """Act at a tick between two SYNCs."""

    def status(self) -> int:
        """Return bits 10, 12 and 13 of the statusword, as far as they are the mode's."""
        return 0

    def end(self, now_ns: TimeNs) -> None:
        """Leave: the next mode, a stop or power off follows."""
