"""Both ends of a drive that only takes a speed on one segment, before an axis of known motion."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from tests.drive_node.conftest import FakeAxis

from axisrig.bench.bus.cyclic.segment import CyclicSegment, Instants
from axisrig.bench.drive.conventional.unit import CounterCard
from axisrig.bench.drive.encoder_terminal.unit import EncoderTerminal
from axisrig.bench.drive.lightbus.unit import LightbusUnit
from axisrig.bench.drive.speed_drive.node import SpeedDriveNode
from axisrig.bench.oracles.phases import Phases
from axisrig.bench.rig.conventional.keys import DriveTable as ConventionalTable
from axisrig.bench.rig.encoder_terminal.keys import DriveTable as EncoderTerminalTable
from axisrig.bench.rig.lightbus.keys import DriveTable as LightbusTable
from axisrig.bench.rig.speed_drive.keys import SpeedDriveTable
from axisrig.kernel.drives.conventional.link import IMAGES as CARD_IMAGES
from axisrig.kernel.drives.conventional.link import ConventionalDrive
from axisrig.kernel.drives.cyclic.carrier import CyclicCarrier, ImagePort
from axisrig.kernel.drives.encoder_terminal.link import IMAGES, EncoderTerminalDrive
from axisrig.kernel.drives.lightbus.link import IMAGES as LIGHTBUS_IMAGES
from axisrig.kernel.drives.lightbus.link import LightbusDrive
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.drives.speed_drive.link import SpeedDrive
from axisrig.kernel.drives.speed_drive.settings import SpeedDriveSettings
from axisrig.kernel.profiles.speed_drive.words import Image
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

SETTINGS = SpeedDriveSettings(
    axis="Z",
    increments_per_mm=409.6,
    loop=LoopSettings(kv_per_s=10.0, period_s=1e-3),
    speed_counts=32767 / 500,
    period_s=1e-3,
    missing_cycles=1,
    acceleration_mm_s2=1000.0,
)


@dataclass(frozen=True)
class Family:
    """What a family is made of. link: from settings, port and the kept place in increments."""

    table: SpeedDriveTable
    images: tuple[Image, Image]
    unit: Callable[[], Any]
    link: Callable[[SpeedDriveSettings, ImagePort, Callable[[], int]], SpeedDrive]


LIGHTBUS = LightbusTable.model_validate({"family": "lightbus", "in2mode": 26})
FAMILIES = {
    "conventional": Family(
        ConventionalTable.model_validate({"family": "conventional"}),
        CARD_IMAGES,
        CounterCard,
        lambda settings, port, _kept: ConventionalDrive(settings, port),
    ),
    "lightbus": Family(
        LIGHTBUS,
        LIGHTBUS_IMAGES,
        lambda: LightbusUnit(LIGHTBUS.make(), LIGHTBUS.in2mode, is_in_turn=False),
        lambda settings, port, _kept: LightbusDrive(settings, port),
    ),
    "encoder_terminal": Family(
        EncoderTerminalTable.model_validate({"family": "encoder_terminal"}),
        IMAGES,
        EncoderTerminal,
        EncoderTerminalDrive,
    ),
}


class Pulses:
    """A signal with edges known beforehand, that shows those until the axis' now."""

    def __init__(self, axis: FakeAxis, edges_ns: list[int]) -> None:
        self._axis, self._coming = axis, edges_ns
        self._shown: list[tuple[int, bool]] = []

    @property
    def edges(self) -> list[tuple[int, bool]]:
        shown, coming = self._shown, self._coming
        while len(shown) < len(coming) and coming[len(shown)] <= self._axis.now_ns:
            shown.append((coming[len(shown)], len(shown) % 2 == 0))
        return shown

    @property
    def level(self) -> bool:
        return len(self.edges) % 2 == 1


class Ends:
    """One axis. cycle: begins one of the control, `then` is called in it before it sends."""

    def __init__(
        self,
        family: str,
        motion: Callable[[float], float],
        edges_ns: list[int],
        at: Instants,
        *,
        cycle_ns: int = 600 * US,
        edge: str = "POS",
        **settings: Any,
    ) -> None:
        made = FAMILIES[family]
        self.scheduler = new_scheduler()
        self.axis = FakeAxis(motion=motion)
        self.at, self._cycle_ns = at, cycle_ns
        self.node = SpeedDriveNode(
            "Z", self.scheduler, self.axis, (Pulses(self.axis, edges_ns), None),
            made.table.make(), made.images, made.unit(),
        )  # fmt: skip
        self.port = ImagePort()
        sampled_ns = (at.period_ns - at.input_ns) % at.period_ns
        phases = Phases(at.period_ns, cycle_ns, 0, at.output_ns, sampled_ns, at.bus_ns, at.bus_ns)
        own = replace(
            SETTINGS, increments_per_mm=float(made.table.per_mm), edge=edge,
            echo_cycles=phases.way, **settings,
        )  # fmt: skip
        self.link = made.link(own, self.port, lambda: self.node.image.position_actual)
        self.segment = CyclicSegment(
            self.scheduler, {"Z": self.node}, at, lambda _axis, inputs: self.port.receive(inputs)
        )
        self.carrier = CyclicCarrier("bus", {"Z": self.port}, self.segment.begin)
        self.number = 0
        self.link.order(PowerOrder.SWITCH_ON)

    @property
    def now_ns(self) -> int:
        """The instant of the NC cycle that was run last."""
        return (self.number - 1) * self.at.period_ns + self._cycle_ns

    def cycle(self, then: Callable[[SpeedDrive], None] | None = None) -> None:
        """Run one cycle of the control."""
        self.scheduler.run_until(self.number * self.at.period_ns)
        self.link.begin_cycle()
        self.carrier.begin_cycle()
        self.scheduler.run_until(self.number * self.at.period_ns + self._cycle_ns)
        self.number += 1
        self.link.take()
        self.link.find_place()
        if then is not None:
            then(self.link)
        self.link.send(self.link.actual_mm)


MILLISECOND = Instants(MS)
