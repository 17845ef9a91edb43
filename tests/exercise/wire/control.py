"""A toy family: a drive on a wire. This is the control's end; nothing of it is a word on a bus.

There are no frames and no objects, and the start-up does nothing.
"""

from collections.abc import Callable
from dataclasses import dataclass

from axisrig.kernel.drives.carrier import Carrier
from axisrig.kernel.drives.interface import Drive, DriveHoming, DriveWatch
from axisrig.kernel.drives.power import Power, PowerRequest
from axisrig.kernel.drives.settings import DriveSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.time.clock import Clock


@dataclass
class Wire:
    """What both ends see, mm: the control gives set position and orders, the drive the others.

    An order for the latch forgets what was latched.
    """

    set_mm: float = 0.0
    is_on: bool = False
    is_ordered: bool = False
    actual_mm: float = 0.0
    is_armed: bool = False
    latched_mm: float | None = None
    level: bool | None = None


class WireDrive(Drive):
    """The control's end of a wire."""

    def __init__(self, settings: DriveSettings, wire: Wire) -> None:
        super().__init__(settings, Arrival(is_new=False))
        self.wire = wire

    def begin_cycle(self) -> None:
        """A wire shows what is there; nothing has to be forgotten."""

    def take(self) -> None:
        self._has_sent = False
        self.arrival.is_new = True
        self._take_actual(round(self.wire.actual_mm * self._per_mm))

    def send(self, set_mm: float) -> None:
        self._note_sent(set_mm)
        self.wire.set_mm, self.wire.is_on = set_mm, self.keeps_operating
        self.power = Power.OPERATING if self.keeps_operating else Power.OFF

    @property
    def state_name(self) -> str:
        return self.power.name

    @property
    def is_in_fault(self) -> bool:
        return False

    @property
    def has_reported(self) -> bool:
        return False

    def ask_for_fault(self) -> None:
        """There is nobody to ask."""

    @property
    def is_asked(self) -> bool:
        return False

    def forget_fault(self) -> None:
        self.acknowledges_faults = False

    def choose_latch(self, probe_input: int, edge: str) -> None:
        if (probe_input, edge) != (1, "POS"):
            raise Alarm(900223, axis=self.name, input=probe_input, edge=edge, object="a wire")

    def arm(self) -> None:
        self.wire.is_ordered, self.wire.latched_mm = True, None

    def disarm(self) -> None:
        self.wire.is_ordered = self.wire.is_armed = False

    @property
    def is_probing(self) -> bool:
        return self.wire.is_ordered

    @property
    def is_clear(self) -> bool:
        return not self.wire.is_armed

    @property
    def is_armed(self) -> bool:
        return self.wire.is_armed

    @property
    def is_prepared(self) -> bool:
        return True

    @property
    def is_actuated(self) -> bool | None:
        return self.wire.level

    @property
    def has_latched(self) -> bool:
        return self.wire.latched_mm is not None

    @property
    def latched_mm(self) -> float | None:
        return self.wire.latched_mm

    @property
    def latched_speed_mm(self) -> float:
        return 0.0

    def is_confirmed(self) -> bool:
        return True

    def home(self, clock: Clock) -> DriveHoming:
        return HomeAtOnce()


class HomeAtOnce(DriveHoming):
    """It is home where it stands."""

    def step(self) -> None:
        """Nothing."""

    def abort(self) -> None:
        """Nothing."""

    @property
    def is_done(self) -> bool:
        return True


class WireWatch(DriveWatch):
    """Whether the wire is cut, and whether the drive operates."""

    def __init__(self, drive: WireDrive, is_cut: Callable[[], bool]) -> None:
        self._drive, self._is_cut = drive, is_cut

    def begin(self) -> None:
        """Nothing."""

    def end(self) -> None:
        """Nothing."""

    def communication(self) -> Alarm | None:
        return Alarm(900030, segment="wire") if self._is_cut() else None

    def condition(self) -> Alarm | None:
        is_stopped = self._drive.request is PowerRequest.STOP
        if self._drive.power is Power.OPERATING or is_stopped:
            return None
        return Alarm(900027, axis=self._drive.name, statusword="none", state=self._drive.state_name)


class Wires(Carrier):
    """Lets the far ends of some wires look at them, at the begin of each cycle."""

    def __init__(self, name: str, ends: list[Callable[[], None]]) -> None:
        self.name, self.ends, self.cycles = name, ends, 0

    def begin_cycle(self) -> None:
        self.cycles += 1
        for end in self.ends:
            end()

    @property
    def holds_back(self) -> bool:
        return False

    def late(self) -> Alarm:
        return Alarm(900031, segment=self.name)

    def check(self) -> Alarm | None:
        return None


class AtOnceStart:
    """The start-up of a drive that needs none."""

    def begin(self, ended: Callable[[Alarm | None], None]) -> None:
        """It has ended before it began."""
        ended(None)
