"""The arc of a block as the path has it."""

from collections.abc import Mapping

from axisrig.kernel.motion.curves import Arc


def arc_from(
    here_mm: Mapping[str, float],
    target_mm: Mapping[str, float],
    centre_mm: Mapping[str, float],
    tangent: Mapping[str, float],
    angle_rad: float,
) -> Arc:
    """Give the arc that begins where the axes are; the other arguments are of `canon.ArcMove`."""
    return Arc(
        start_mm=tuple(here_mm.values()),
        end_mm=tuple(target_mm.get(name, at) for name, at in here_mm.items()),
        centre_mm=tuple(centre_mm.get(name, at) for name, at in here_mm.items()),
        tangent=tuple(tangent.get(name, 0.0) for name in here_mm),
        angle_rad=angle_rad,
    )
