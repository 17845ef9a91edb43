"""Kinematic 98: the tool is virtually extended where tilting would bring the head too low.

It follows another kinematic as second step and moves the TCP along the tool. With the tilt t, the
length L1 of the tool and HD2 <= HD3:

    t <= HD2         L2 = L1
    HD2 < t <= HD3   L2 = L1 cos HD2 / cos t    the clamping point keeps its height
    t > HD3          L2 = L1 cos HD2 / cos HD3  frozen

HD1 is a further length of the lever. Facts: ISG kernel, KIN_TYP_98 (1093483659), FCT-M3 12.4.2;
what they leave open: docs/ambiguities.md.
"""

import math
from collections.abc import Callable
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics.kinematic import Kinematic, Positions, Vector

TOLERANCE_DEG: Final = 1e-9  # of a tilt that is exactly the largest one
STEPS, HALVINGS = 256, 50  # of the search for the places where the length begins or ends to grow


class ExtendedTool(Kinematic):
    """The kinematic of the first step with the tool extended.

    hd1_mm: further length. start_deg, end_deg: HD2 and HD3, end_deg = largest_deg where HD3 is
    missing. largest_deg: HD4.
    """

    def __init__(
        self,
        first: Kinematic,
        hd1_mm: float,
        start_deg: float,
        end_deg: float,
        largest_deg: float,
    ) -> None:
        super().__init__(f"{first.name}, 98", first.rotary, first.axes)
        self._first = first
        self._hd1_mm = hd1_mm
        self._start_deg, self._end_deg, self._largest_deg = start_deg, end_deg, largest_deg

    def forward(self, axes: Positions) -> Positions:
        """Give the tool coordinates; a tilt above HD4 counts as it is."""
        tool = self._first.forward(axes)
        return self._shifted(tool, -1.0)

    def inverse(self, tool: Positions, near: Positions) -> Positions:
        """Give the axis positions.

        Raises Alarm for a tilt above HD4, and what the first step raises.
        """
        tilt_deg = self.tilt_deg(tool)
        if tilt_deg > self._largest_deg + TOLERANCE_DEG:
            limit, tilt = f"{self._largest_deg:g}", f"{tilt_deg:.4f}"
            raise Alarm(900444, tilt_deg=tilt, limit_deg=limit)
        return self._first.inverse(self._shifted(tool, 1.0), near)

    def direction(self, tool: Positions) -> Vector:
        """Give u, which the extension does not change."""
        return self._first.direction(tool)

    def length_mm(self, tool: Positions) -> float:
        """Give L2."""
        length_mm, tilt_deg = self._first.length_mm(tool), self.tilt_deg(tool)
        if tilt_deg <= self._start_deg or self._start_deg >= 90.0:
            return length_mm
        end_deg = min(tilt_deg, self._end_deg)
        start = math.cos(math.radians(self._start_deg))
        return length_mm * start / math.cos(math.radians(end_deg))

    def kinks_along(self, place: Callable[[float], Positions]) -> tuple[float, ...]:
        """Give where the tilt passes HD2 or HD3: L2 begins or ends to grow there.

        Found in 256 steps of the way and by halving. A tilt that touches HD2 or HD3 within a step
        and goes back makes no kink that counts.
        """
        if self._start_deg >= 90.0:
            return ()
        found = list(self._first.kinks_along(place))
        for limit_deg in (self._start_deg, self._end_deg):
            before = self.tilt_deg(place(0.0)) > limit_deg
            for step in range(1, STEPS + 1):
                above = self.tilt_deg(place(step / STEPS)) > limit_deg
                if above != before:
                    found.append(self._crossing(place, (step - 1) / STEPS, limit_deg, before))
                before = above
        return tuple(sorted({share for share in found if 0.0 < share < 1.0}))

    def _crossing(
        self, place: Callable[[float], Positions], low: float, limit_deg: float, before: bool
    ) -> float:
        high = low + 1.0 / STEPS
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if (self.tilt_deg(place(middle)) > limit_deg) == before:
                low = middle
            else:
                high = middle
        return high

    def nominal_length_mm(self, tool: Positions) -> float:
        """Give L1."""
        return self._first.nominal_length_mm(tool)

    def _shifted(self, tool: Positions, sign: float) -> Positions:
        """Move the TCP along the tool: +1 to the TCP of the first step, -1 from it."""
        way_mm = sign * (self._hd1_mm + self.length_mm(tool) - self._first.length_mm(tool))
        u = self._first.direction(tool)
        return (
            tool[0] + way_mm * u[0],
            tool[1] + way_mm * u[1],
            tool[2] + way_mm * u[2],
            *tool[3:],
        )
