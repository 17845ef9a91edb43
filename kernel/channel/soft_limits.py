"""Software limit switches: where an axis may be told to go, and where it may be.

Set positions are checked before a motion begins, actual positions in every cycle with a tolerance
(P-AXIS-00177 to 00179). Whether the offset of distance control counts says P-AXIS-00428. Source:
TF5200 software limit switches 15311258251 and 91635723; P-AXIS-00705.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from kernel.drives.link import AxisLink
from kernel.errors import Alarm
from kernel.parameters import ParameterSet

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
        """Raise Alarm 120002 or 120003 for a set position beyond a switch; at it is allowed."""
        if target_mm > self.positive_mm:
            raise _alarm(TARGET_ABOVE, axis, target_mm, self.positive_mm)
        if target_mm < self.negative_mm:
            raise _alarm(TARGET_BELOW, axis, target_mm, self.negative_mm)


def _alarm(alarm_id: int, axis: str, position_mm: float, limit_mm: float) -> Alarm:
    return Alarm(alarm_id, axis=axis, position_mm=f"{position_mm:.4f}", limit_mm=f"{limit_mm:.4f}")


class SoftLimitWatch:
    """Watches the actual positions of all axes that have switches.

    uncounted_mm: tells what of the position of an axis does not count, the offset of distance
    control without P-AXIS-00428. An axis that its drive leads (homing) is not watched.
    """

    def __init__(self, limits: Mapping[str, SoftLimits | None], links: Mapping[str, AxisLink]):
        self._axes = [
            (links[axis], found.negative_mm - found.tolerance_mm,
             found.positive_mm + found.tolerance_mm)
            for axis, found in limits.items() if found is not None
        ]  # fmt: skip
        self.uncounted_mm: Callable[[str], float] = lambda _axis: 0.0

    def check(self) -> None:
        """Raise Alarm 70021 or 70022 for the first axis that is beyond a switch."""
        for link, lowest_mm, highest_mm in self._axes:
            position_mm = link.actual_mm - self.uncounted_mm(link.name)
            if lowest_mm <= position_mm <= highest_mm or link.leads_itself:
                continue
            if position_mm > highest_mm:
                raise _alarm(ACTUAL_ABOVE, link.name, position_mm, highest_mm)
            raise _alarm(ACTUAL_BELOW, link.name, position_mm, lowest_mm)
