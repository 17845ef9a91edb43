"""The feed at which a path takes a given time."""

from typing import Final

from axisrig.kernel.motion.course import AnySlope

_HALVINGS: Final = 60  # of the range of speeds: far below the resolution of a double


def speed_for(
    distance_mm: float,
    time_s: float,
    acceleration: AnySlope,
    deceleration: AnySlope,
    fastest: float,
) -> float:
    """Return the speed in mm/s at which the whole motion, with both ramps, takes `time_s`.

    A motion that cannot be so fast gets `fastest`. The duration falls with the speed, so the
    speed is between distance / time and `fastest` and is found by halving.
    """
    if acceleration.plan(distance_mm, fastest, deceleration).duration_s >= time_s:
        return fastest
    low, high = distance_mm / time_s, fastest
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        slower = acceleration.plan(distance_mm, middle, deceleration).duration_s > time_s
        low, high = (middle, high) if slower else (low, middle)
    return high
