"""The path of a channel as a run to a fixed stop sees it when slaves follow its axes."""

from collections.abc import Iterable

from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import AxisSettings
from axisrig.kernel.channel.path.settling import Rest
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.time.clock import Clock, TimeNs


class PathWithSlaves:
    """A slave has a stop of its own that may hold it off its place beside its master.

    slaves: settings and link of each. The path is in position when its axes are in their
    exact-stop windows and every slave either is in its own or rests, wherever that is.
    """

    def __init__(
        self,
        path: Path,
        slaves: Iterable[tuple[AxisSettings, Drive]],
        clock: Clock,
        period_ns: TimeNs,
    ) -> None:
        self._path, self._slaves = path, tuple(slaves)
        self._names = tuple(settings.name for settings, _ in self._slaves)
        self._clock, self._period_ns = clock, period_ns
        self._rest: Rest | None = None

    @property
    def travelled_mm(self) -> float:
        """How far the interpolation has come on the present path."""
        return self._path.travelled_mm

    @property
    def has_stopped(self) -> bool:
        """Whether the same set positions are sent again and again."""
        return self._path.has_stopped

    def is_in_position(self) -> bool:
        """Whether the run may end; raises Alarm 70082, and 900200 for a slave that sways."""
        if not self._path.is_in_position(self._names):
            self._rest = None
            return False
        away = [(of, link) for of, link in self._slaves if abs(link.lag_mm) > of.window_mm]
        if not away:
            return True
        if self._rest is None:
            self._rest = Rest(self._clock, self._period_ns, self._slaves)
        return self._rest.judge()
