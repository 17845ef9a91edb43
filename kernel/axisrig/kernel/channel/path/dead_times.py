"""The dead times of the probes of a run (P-AXIS-00487) and how far they may lead a value back."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from math import hypot

from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.measuring.dead_time import DeadTime, run_up
from axisrig.kernel.motion.dynamics import Dynamics
from axisrig.kernel.time.clock import S, TimeNs

# Of an axis and its speed, mm/s: how far it is behind a motion that has had that speed all along
BehindMm = Callable[[str, float], float]


@dataclass(frozen=True)
class RunUp:
    """How the axes of a path come to the speeds that they have.

    shares: by how much each axis moves in the path; None under a kinematic, where an axis has no
    share of its own and the whole run-up to speed_mm_s counts.
    """

    dynamics: Dynamics
    shares: Mapping[str, float] | None
    speed_mm_s: float = 0.0

    def behind_mm(self, axis: str, speed_mm_s: float) -> float:
        """Return how far an axis with a speed is behind one that has had it from the begin on."""
        slopes = self.dynamics.acceleration, self.dynamics.deceleration
        if self.shares is None:
            time_s, _ = run_up(*slopes, self.speed_mm_s)
            return speed_mm_s * time_s
        share = self.shares.get(axis, 0.0)
        if not share:
            return 0.0
        time_s, way_mm = run_up(*slopes, speed_mm_s / share)
        return speed_mm_s * time_s - share * way_mm


def shares_of(path: Path, target_mm: Mapping[str, float]) -> Mapping[str, float] | None:
    """Return by how much each axis of a straight path moves in it; None under a kinematic."""
    if path.transformation.kinematic is not None:
        return None
    ways_mm = {name: abs(at_mm - path.position_acs_mm(name)) for name, at_mm in target_mm.items()}
    length_mm = hypot(*ways_mm.values())
    return {name: way_mm / length_mm for name, way_mm in ways_mm.items()}


def dead_times(
    path: Path,
    links: Mapping[str, Drive],
    axes: Iterable[str],
    period_ns: TimeNs,
    behind_mm: BehindMm,
) -> dict[str, DeadTime]:
    """Give the dead times of those axes whose list has one; they stand where the block begins."""
    delays_ns = {name: path.settings(name).measuring.delay_ns for name in axes}
    return {
        name: _dead_time(path, links[name], delay_ns, period_ns, behind_mm)
        for name, delay_ns in delays_ns.items()
        if delay_ns
    }


def _dead_time(
    path: Path, link: Drive, delay_ns: TimeNs, period_ns: TimeNs, behind_mm: BehindMm
) -> DeadTime:
    axis, per_s = link.name, S / period_ns
    return DeadTime(
        axis,
        delay_ns / period_ns,
        path.position_acs_mm(axis) + path.superposed_mm(axis),
        path.settings(axis).window_mm,
        behind_mm=lambda speed_mm: behind_mm(axis, speed_mm * per_s),
        lag_mm=lambda: link.lag_mm,
    )
