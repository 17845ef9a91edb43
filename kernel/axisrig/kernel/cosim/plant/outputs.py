"""What is kept of the motion of an axis, and where each value is in it."""

from collections.abc import Sequence
from typing import Final

AXIS_OUTPUTS: Final = (
    *("position", "velocity", "motor_position", "motor_velocity", "demand_position"),
    *("force", "stop_force", "stop_face"),
)
POSITION: Final = 0
VELOCITY: Final = 1
MOTOR_POSITION: Final = 2
MOTOR_VELOCITY: Final = 3
DEMAND_POSITION: Final = 4
FORCE: Final = 5
STOP_FORCE: Final = 6
STOP_FACE: Final = 7
"""Places in AXIS_OUTPUTS."""
# Two SYNC periods of 20 ms in steps of 10 us: a latch is looked up at the SYNC after it. In longer
# steps that is more, but no SYNC that has been missing for a second is waited for
HISTORY_STEPS: Final = 4096
HISTORY_NS: Final = 1_000_000_000
Tick = tuple[float, float, float, float]
"""Load position and velocity at both ends of a step."""


def tick_of(begin: Sequence[float], end: Sequence[float]) -> Tick:
    """Return the tick of a step from the outputs at its ends."""
    return (begin[POSITION], begin[VELOCITY], end[POSITION], end[VELOCITY])
