"""Between the axes and the tool: the positions of the first axes through a kinematic."""

from collections.abc import Mapping, Sequence

from axisrig.kernel.kinematics import Kinematic


def tool_coordinates(
    axes: Sequence[str], kinematic: Kinematic | None, acs_mm: dict[str, float]
) -> dict[str, float]:
    """Give BASE of axis positions: the same positions without a kinematic."""
    if kinematic is None:
        return acs_mm
    inside = axes[: kinematic.count]
    tool = kinematic.forward(tuple(acs_mm[axis] for axis in inside))
    return {**acs_mm, **dict(zip(inside, tool, strict=True))}


def axis_positions(
    axes: Sequence[str],
    kinematic: Kinematic,
    base_mm: Mapping[str, float],
    near_mm: Mapping[str, float],
) -> dict[str, float]:
    """Give the axis positions of BASE, the pose that is nearest to `near_mm`."""
    inside = axes[: kinematic.count]
    near = tuple(near_mm[axis] for axis in inside)
    found = kinematic.inverse(tuple(base_mm[axis] for axis in inside), near)
    return {**base_mm, **dict(zip(inside, found, strict=True))}
