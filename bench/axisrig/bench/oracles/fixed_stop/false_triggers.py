"""Where a run to a fixed stop finds one in free motion, or never: what its settings foretell.

Sources: the closed forms of `timing`; balance of force limit, weight and friction.
"""

from dataclasses import dataclass

from axisrig.bench.oracles.fixed_stop.lists import Limits
from axisrig.bench.oracles.fixed_stop.pressing import Pressing
from axisrig.bench.oracles.fixed_stop.timing import least_path_mm
from axisrig.kernel.time.clock import S


@dataclass(frozen=True)
class Motion:
    """How an axis moves freely in the run.

    speed_mm_s: its feed. acceleration_mm_s2: of the ramp up. running_lag_mm: e0, None where the
    plant does not give the gain. arming_mm: None = it depends on the length of the block.
    breakaway_n: force that sets the axis in motion.
    """

    speed_mm_s: float
    acceleration_mm_s2: float
    running_lag_mm: float | None
    arming_mm: float | None
    breakaway_n: float = 0.0


def lag_reasons(limits: Limits, motion: Motion) -> list[str]:
    """Say why the lag criterion holds in free motion, empty when it does not."""
    limit_mm, running_mm = limits.lag_limit_mm, motion.running_lag_mm
    if limit_mm is None or running_mm is None or limit_mm > abs(running_mm):
        return []
    return [f"the lag limit {limit_mm:g} mm is not above the running lag {abs(running_mm):.4g} mm"]


def window_reasons(limits: Limits, motion: Motion) -> list[str]:
    """Say why the window criterion holds in free motion, empty when it does not."""
    if limits.window_mm is None:
        return []
    tau_s = limits.min_time_ns / S
    least_mm = least_path_mm(limits.window_mm, limits.min_time_ns, motion.acceleration_mm_s2)
    if motion.arming_mm is not None and motion.arming_mm < least_mm:
        return [
            f"the window counts from {motion.arming_mm:g} mm on, but in the ramp it holds up to"
            f" {least_mm:.4g} mm"
        ]
    if limits.window_mm >= motion.speed_mm_s * tau_s:
        return [
            f"window {limits.window_mm:g} mm in {tau_s * 1e3:g} ms is not below the feed"
            f" {motion.speed_mm_s:.4g} mm/s"
        ]
    return []


def force_reasons(pressing: Pressing | None, motion: Motion) -> list[str]:
    """Say why the axis does not follow its set value to the stop, empty when it does."""
    if pressing is None or pressing.pushing_n > motion.breakaway_n:
        return []
    return [
        f"force limit {pressing.limit_n:.4g} N less weight leaves {pressing.pushing_n:.4g} N"
        f" against {motion.breakaway_n:.4g} N of friction: the axis does not follow"
    ]


def false_triggers(limits: Limits, motion: Motion, pressing: Pressing | None) -> list[str]:
    """Say why the criteria of an axis hold without a stop; empty when they must not.

    With both criteria on each of them needs a reason, since both must hold.
    """
    force = force_reasons(pressing, motion)
    by_lag, by_window = lag_reasons(limits, motion), window_reasons(limits, motion)
    active = []
    if limits.lag_limit_mm is not None:
        active.append([*by_lag, *force])
    if limits.window_mm is not None:
        active.append([*by_window, *force])
    if not active or not all(active):
        return []
    return list(dict.fromkeys(reason for reasons in active for reason in reasons))
