"""Both ends of a PROFIdrive drive on one segment, before an axis of known motion."""

from collections.abc import Callable

from tests.drive_node.conftest import FakeAxis
from tests.speed_drive.ends import Pulses

from axisrig.bench.bus.cyclic.segment import CyclicSegment, Instants
from axisrig.bench.drive.profidrive.node import ProfidriveDrive as VirtualProfidrive
from axisrig.bench.oracles.phases import Phases
from axisrig.bench.rig.profidrive.keys import DriveTable
from axisrig.kernel.drives.cyclic.carrier import CyclicCarrier, ImagePort
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.drives.profidrive.link import ProfidriveDrive
from axisrig.kernel.drives.profidrive.settings import ProfidriveSettings
from axisrig.kernel.profiles.profidrive.words import telegrams
from axisrig.kernel.time.scheduler import new_scheduler

SECOND_M = 1e-3
"""The second encoder, where the telegram has one, is so far beside the first."""


class Ends:
    """Both ends; cycle: one of the control, which has not sent yet."""

    def __init__(
        self,
        telegram: int,
        motion: Callable[[float], float],
        edges_ns: list[int],
        at: Instants,
        cycle_ns: int,
        edge: str = "POS",
    ) -> None:
        self.table = DriveTable.model_validate(
            {"family": "profidrive", "telegram": telegram, "p0660": 80, "input_delay_us": 4.0}
        )
        made = self.table.make()
        self.scheduler = new_scheduler()
        has_second = telegrams()[telegram].has_second
        self.axis = FakeAxis(motion=motion, encoder_2_m=SECOND_M if has_second else None)
        signal = Pulses(self.axis, edges_ns)
        self.node = VirtualProfidrive("Z", self.scheduler, self.axis, (signal, None), made)
        self.port = port = ImagePort()
        sampled_ns = (at.period_ns - at.input_ns) % at.period_ns
        phases = Phases(at.period_ns, cycle_ns, 0, at.output_ns, sampled_ns, at.bus_ns, at.bus_ns)
        is_dsc = made.telegram.has_dsc
        settings = ProfidriveSettings(
            axis="Z",
            increments_per_mm=float(self.table.per_mm),
            edge=edge,
            telegram=made.telegram,
            speed_counts=393_216.0,
            period_s=at.period_ns * 1e-9,
            gain=10_000 if is_dsc else 0,
            loop=None if is_dsc else LoopSettings(kv_per_s=10.0, period_s=at.period_ns * 1e-9),
            proves_places=False,
            echo_cycles=phases.way,
        )
        self.link = ProfidriveDrive(settings, port)
        segment = CyclicSegment(
            self.scheduler, {"Z": self.node}, at, lambda _axis, inputs: port.receive(inputs)
        )
        self.carrier = CyclicCarrier("bus", {"Z": port}, segment.begin)
        self._at, self._cycle_ns, self.number = at, cycle_ns, 0
        self.link.order(PowerOrder.SWITCH_ON)

    def cycle(self) -> ProfidriveDrive:
        self.scheduler.run_until(self.number * self._at.period_ns)
        self.link.begin_cycle()
        self.carrier.begin_cycle()
        self.scheduler.run_until(self.number * self._at.period_ns + self._cycle_ns)
        self.number += 1
        self.link.take()
        self.link.find_place()
        return self.link
