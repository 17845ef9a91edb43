"""Homing by the drives (G74): group by group, each axis by its own drive (docs/homing.md).

While an axis homes, the CNC lets its set position be the actual one, so that neither lag nor the
jump to the new reference means anything. Source: TF5200 programming manual 206138635.
"""

from collections.abc import Iterable, Mapping, Sequence

from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.drives.interface import Drive, DriveHoming
from axisrig.kernel.time.clock import Clock


class Homing:
    """The groups of one G74, one after the other; links: by axis. homed: in this cycle."""

    def __init__(
        self,
        groups: Iterable[Sequence[str]],
        path: Path,
        links: Mapping[str, Drive],
        clock: Clock,
    ) -> None:
        self._groups = list(groups)
        self._path, self._links, self._clock = path, links, clock
        self._axes: dict[str, DriveHoming] = {}
        self.homed: list[str] = []
        self._next()

    def _next(self) -> None:
        group = self._groups.pop(0) if self._groups else ()
        self._axes = {axis: self._links[axis].home(self._clock) for axis in group}

    def step(self) -> bool:
        """Do one cycle; return whether everything is done. Raises the alarms of an axis."""
        for axis, homing in self._axes.items():
            if not homing.is_done:  # a drive that has its mode again holds its axis
                self._path.put(axis, self._links[axis].place_mm)
                homing.step()
        self.homed = []
        if all(homing.is_done for homing in self._axes.values()):
            self.homed = list(self._axes)
            self._next()
        return not self._axes

    def abort(self) -> dict[str, DriveHoming]:
        """Break off; return what leads the drives back to their modes, by axis."""
        left = {axis: homing for axis, homing in self._axes.items() if not homing.is_done}
        for homing in left.values():
            homing.abort()
        return left
