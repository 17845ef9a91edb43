"""The way of a run to a fixed stop: which axes move on it, and what of it is sent to the drives."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass

from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.motion.curves import Positions
from axisrig.kernel.motion.tool_path import NO_WAY_MM, ToolCurve


@dataclass(frozen=True)
class StopWay:
    """moved: the axes that go anywhere on it. length_mm: of the path.

    sent: gives what was sent last as a place on the path; None: the positions of these axes.
    """

    moved: Collection[str]
    length_mm: float
    sent: Callable[[], Positions] | None = None


def straight_way(path: Path, links: Collection[Drive], target_mm: Mapping[str, float]) -> StopWay:
    """Give the way of a block, whose target may be in tool coordinates; links: of the whole path.

    Under a kinematic an axis moves where its target or that of others wants it to, and the steps of
    the axes grow and shrink while the tool has one speed: what is sent is then seen from the tool.
    """
    curve = path.straight(target_mm)
    if not isinstance(curve, ToolCurve):
        return StopWay(tuple(target_mm), curve.length_mm)
    ways = zip(path.position_mm(), *curve.box_mm(), strict=True)
    moved = tuple(name for name, low, high in ways if high - low > NO_WAY_MM)

    def sent() -> Positions:
        axes = tuple(link.set_mm - path.superposed_mm(link.name) for link in links)
        return path.transformation.coordinates(axes)

    return StopWay(moved, curve.length_mm, sent)


def sent_to(links: Iterable[Drive]) -> Callable[[], Positions]:
    """Give what was sent last to these axes."""
    links = tuple(links)
    return lambda: tuple(link.set_mm for link in links)
