"""Software limit switches: where an axis may be sent, and where it may be.

Set positions are checked before a motion begins, actual positions in every cycle with a tolerance
(P-AXIS-00177 to 00179). Whether the offset of distance control counts says P-AXIS-00428. Source:
TF5200 software limit switches 15311258251 and 91635723; P-AXIS-00705.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.parameters import ParameterSet

TARGET_ABOVE, TARGET_BELOW = 120002, 120003
ACTUAL_ABOVE, ACTUAL_BELOW = 70021, 70022


@dataclass(frozen=True)
class SoftLimits:
    """The switches of an axis in mm; tolerance_mm: of actual positions."""

    negative_mm: float
    positive_mm: float
    tolerance_mm: float

    @classmethod
    def read(cls, axis: ParameterSet) -> "SoftLimits | None":
        """Take them from the parameters of an axis; None where they are not monitored.

        Rotary axes have them only where P-AXIS-00705 says so.
        """
        check = axis.integer("kenngr.swe_check")
        if check == 0 or (check < 0 and axis.is_rotary):
            return None
        return cls(
            axis.mm("kenngr.swe_neg"), axis.mm("kenngr.swe_pos"), axis.mm("kenngr.swe_toleranz")
        )

    def require_target(self, axis: str, target_mm: float) -> None:
        """Raise Alarm 120002 or 120003 for a set position past a switch; at it is allowed."""
        if target_mm > self.positive_mm:
            raise _alarm(TARGET_ABOVE, axis, target_mm, self.positive_mm)
        if target_mm < self.negative_mm:
            raise _alarm(TARGET_BELOW, axis, target_mm, self.negative_mm)


def _alarm(alarm_id: int, axis: str, position_mm: float, limit_mm: float) -> Alarm:
    return Alarm(alarm_id, axis=axis, position_mm=f"{position_mm:.4f}", limit_mm=f"{limit_mm:.4f}")


@dataclass(frozen=True)
class _Watched:
    """One axis: where its actual position may be, in increments; counts: its offset counts."""

    link: Drive
    lowest: float
    highest: float
    lowest_mm: float
    highest_mm: float
    counts: bool


class SoftLimitWatch:
    """Watches the actual positions of all axes that have switches.

    uncounted_mm: by axis, the part of its position that does not count: the offset of distance
    control without P-AXIS-00428. An axis that its drive leads (homing) is not watched.
    """

    def __init__(
        self,
        limits: Mapping[str, SoftLimits | None],
        links: Mapping[str, Drive],
        uncounted_mm: Mapping[str, Callable[[], float]],
    ) -> None:
        self._uncounted_mm = uncounted_mm
        self._axes = [
            _watched(links[axis], found, counts=axis not in uncounted_mm)
            for axis, found in limits.items()
            if found is not None
        ]

    def check(self) -> None:
        """Raise Alarm 70021 or 70022 for the first axis that is past a switch."""
        for axis in self._axes:
            if not axis.counts or not axis.lowest <= axis.link.actual_increments <= axis.highest:
                self._judge(axis)

    def _judge(self, axis: _Watched) -> None:
        name, position_mm = axis.link.name, axis.link.actual_mm
        if axis.link.leads_itself:
            return
        if not axis.counts:
            position_mm -= self._uncounted_mm[name]()
        if position_mm > axis.highest_mm:
            raise _alarm(ACTUAL_ABOVE, name, position_mm, axis.highest_mm)
        if position_mm < axis.lowest_mm:
            raise _alarm(ACTUAL_BELOW, name, position_mm, axis.lowest_mm)


def _watched(link: Drive, limits: SoftLimits, *, counts: bool) -> _Watched:
    lowest_mm = limits.negative_mm - limits.tolerance_mm
    highest_mm = limits.positive_mm + limits.tolerance_mm
    per_mm = link.settings.increments_per_mm
    return _Watched(link, lowest_mm * per_mm, highest_mm * per_mm, lowest_mm, highest_mm, counts)
