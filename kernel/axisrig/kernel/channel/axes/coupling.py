"""Axis couplings: the set positions of slaves follow those of their masters (soft gantry).

A slave keeps the distance to its master at which it was coupled, and gets the offset of its
distance control with its set position. Sources: TF5200 programming manual 207120267 and 207133579;
ISG 285662475 (gantry coupling and its limits).
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace

from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import AxisSettings
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon

BEYOND_FIRST, BEYOND_SECOND = 900192, 900193


@dataclass(frozen=True)
class _Coupled:
    """A slave on its way; offset_mm: its set position less that of the master."""

    pair: canon.AxisPair
    offset_mm: float


class Couplings:
    """The couplings that are on; links: by axis. watched: whether any gantry is among them."""

    def __init__(self, path: Path, links: Mapping[str, Drive]) -> None:
        self._path, self._links = path, links
        self._follower = self._follow
        self._groups: dict[int, list[_Coupled]] = {}
        self._slaves: list[_Coupled] = []
        self._alone: dict[str, AxisSettings] = {}  # masters as they are without slaves
        self.watched = False

    def switch_on(self, command: canon.AxisLinkOn) -> None:
        """Couple axes at standstill where they are."""
        self._groups[command.group] = [self._couple(pair) for pair in command.pairs]
        self._renew()

    def switch_off(self, command: canon.AxisLinkOff) -> None:
        """Stop the slaves of a group where they are."""
        self._part(self._groups.pop(command.group, []))
        self._renew()

    def end_program(self) -> None:
        """Stop all slaves where they are."""
        if self._groups:
            for group in self._groups.values():
                self._part(group)
            self._groups.clear()
            self._renew()

    def _couple(self, pair: canon.AxisPair) -> _Coupled:
        path = self._path
        self._alone.setdefault(pair.master, path.settings(pair.master))
        self._move(pair, -1.0)
        apart_mm = path.position_acs_mm(pair.slave) - path.position_acs_mm(pair.master)
        return _Coupled(pair, apart_mm)

    def _part(self, group: Iterable[_Coupled]) -> None:
        for coupled in group:
            self._move(coupled.pair, 1.0)

    def _move(self, pair: canon.AxisPair, sign: float) -> None:
        """Let a slave stay while it gets the offset of its master, or does not get it any more."""
        offset_mm = self._path.superposed_mm(pair.master)
        if offset_mm:
            self._path.take_offset(pair.slave, sign * offset_mm)

    def _renew(self) -> None:
        path = self._path
        self._slaves = [coupled for group in self._groups.values() for coupled in group]
        self.watched = any(coupled.pair.limits_mm for coupled in self._slaves)
        if self._follower in path.leaders:
            path.leaders.remove(self._follower)
        if self._slaves:
            path.leaders.append(self._follower)
        for settings in self._alone.values():
            path.use(settings)
        for coupled in self._slaves:
            pair = coupled.pair
            path.use(_for_both(path.settings(pair.master), path.settings(pair.slave)))

    def _follow(self) -> None:
        path = self._path
        for coupled in self._slaves:
            pair = coupled.pair
            path.put_beside(pair.slave, path.position_acs_mm(pair.master) + coupled.offset_mm)

    def slaves_of(self, masters: Collection[str]) -> dict[str, str]:
        """Return the slaves that follow any of these axes, each with its master."""
        pairs = (coupled.pair for coupled in self._slaves)
        return {pair.slave: pair.master for pair in pairs if pair.master in masters}

    def watch(self) -> None:
        """Raise Alarm 900192 or 900193 when the actual positions of a gantry have come apart."""
        for coupled in self._slaves:
            pair = coupled.pair
            if pair.limits_mm is None:
                continue
            apart_mm = self._links[pair.slave].actual_mm - self._links[pair.master].actual_mm
            difference_mm = apart_mm - coupled.offset_mm
            for alarm_id, limit_mm in zip(
                (BEYOND_SECOND, BEYOND_FIRST), reversed(pair.limits_mm), strict=True
            ):
                if abs(difference_mm) > limit_mm:
                    raise Alarm(
                        alarm_id,
                        axis=pair.slave,
                        master=pair.master,
                        difference_mm=f"{difference_mm:.4f}",
                        limit_mm=f"{limit_mm:g}",
                    )


def _for_both(master: AxisSettings, slave: AxisSettings) -> AxisSettings:
    """Let the master move only as both axes may."""
    weaker = {
        motion: dynamics.weaker(slave.dynamics[motion])
        for motion, dynamics in master.dynamics.items()
    }
    limited = {
        shape: {
            motion: dynamics.weaker(slave.jerk_limited[shape][motion])
            for motion, dynamics in of_motions.items()
        }
        for shape, of_motions in master.jerk_limited.items()
    }
    return replace(master, dynamics=weaker, jerk_limited=limited)
