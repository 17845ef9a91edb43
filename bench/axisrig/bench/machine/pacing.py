"""Rigs in real time: what they need of the command line, and their scheduler."""

from collections.abc import Callable
from dataclasses import dataclass

from axisrig.bench.bus.deadlines import Deadlines
from axisrig.bench.bus.paced import PacedScheduler, Pacing, RealTime
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.time.clock import MS, US


@dataclass(frozen=True)
class Hardware:
    """What a run outside needs of the command line.

    stop: returns whether the operator wants the run to end (Ctrl-C).
    """

    real_time: RealTime
    stop: Callable[[], bool] = lambda: False


def master_scheduler(settings: Settings, hardware: Hardware) -> PacedScheduler:
    """Make the clock of a kernel that drives a real bus.

    A cycle that is late by a quarter of the period moves the plan: the answers of the drives would
    come too late for it otherwise.
    """
    cycle, realtime = settings.rig.cycle, settings.rig.realtime
    patience_ns = (
        round(realtime.wait_ms * MS)
        if realtime.wait_ms is not None
        else max((table.answer_wait_ns for table in settings.segment.values()), default=0)
    )
    pacing = Pacing(
        slip_ns=cycle.period_us * US // 4,
        wait_ns=patience_ns,
        answer_ns=cycle.cycle_offset_us * US,
    )
    return PacedScheduler(hardware.real_time, pacing, Deadlines(round(realtime.late_us * US)))
