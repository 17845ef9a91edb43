"""Working planes, and which axis of a rig is the first, second and third main axis."""

from collections.abc import Sequence
from dataclasses import dataclass

from axisrig.kernel.nc.coordinates.frames import MAIN_AXES

LETTERS = "XYZ"


@dataclass(frozen=True)
class Plane:
    """A working plane by places of the main axes: 0 is X, 1 is Y, 2 is Z.

    Source: TF5200 programming manual 206253067.
    """

    g: str
    first: int
    second: int
    third: int


XY, ZX, YZ = Plane("G17", 0, 1, 2), Plane("G18", 2, 0, 1), Plane("G19", 1, 2, 0)
PLANES = {plane.g: plane for plane in (XY, ZX, YZ)}


def main_places(axes: Sequence[str]) -> tuple[str | None, ...]:
    """Give the axis of each of the three places, None for a place without one.

    The first three axes of the channel. A rig with fewer has some of them: an axis that is named
    X, Y or Z then has the place of that letter, the others follow where there is room.
    """
    if len(axes) >= MAIN_AXES:
        return tuple(axes[:MAIN_AXES])
    places: list[str | None] = [None] * MAIN_AXES
    rest = []
    for axis in axes:
        at = LETTERS.find(axis[:1].upper())
        if at >= 0 and places[at] is None:
            places[at] = axis
        else:
            rest.append(axis)
    for axis in rest:
        places[places.index(None)] = axis
    return tuple(places)
