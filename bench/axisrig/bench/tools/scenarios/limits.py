"""Limits of axes and of distance control, as the lists of a recording write them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.record.axes import AxisRecord, Value
from axisrig.bench.record.facts import Facts
from axisrig.bench.record.series import Signal

_ACCELERATION = re.compile(
    r"getriebe\[0\]\.(lslope_profil\.[ad]_(grenz_)?stufe_[12]|lslope_profil\.a_feedh"
    r"|slope_profil\.a_(beschl|brems|grenz|feedh)|dynamik\.a_(max|emergency))"
)
_OFFSET = "dist_ctrl[0]."
_OF_AXIS = f"kenngr.{_OFFSET}"
_UM_S, _UM, _TENTH_UM = 1e-3, 1e-3, 1e-4
"""mm/s of um/s, mm of um and of 0.1 um."""


@dataclass(frozen=True)
class Lists:
    """Limits that lists write; None where they write none.

    speed_mm_s: P-AXIS-00212 or 00415. a_mm_s2: largest acceleration of the slopes, or P-AXIS-00416.
    stroke_mm: P-AXIS-00086. deviation_mm: P-AXIS-00414. lowest_mm, highest_mm: of the sensor,
    P-AXIS-00420 and 00419 with P-AXIS-00421.
    """

    speed_mm_s: float | None = None
    a_mm_s2: float | None = None
    stroke_mm: float | None = None
    deviation_mm: float | None = None
    lowest_mm: float | None = None
    highest_mm: float | None = None

    def rate(self, derivative: int) -> float | None:
        """Return the limit of the first or second derivative, mm/s or mm/s2."""
        return (self.speed_mm_s, self.a_mm_s2)[derivative - 1]

    def allows(self, sensor_mm: Signal) -> npt.NDArray[np.bool_]:
        """Return which values of the sensor are within its range, shape (n,)."""
        low = -np.inf if self.lowest_mm is None else self.lowest_mm
        high = np.inf if self.highest_mm is None else self.highest_mm
        found: npt.NDArray[np.bool_] = np.isnan(sensor_mm) | (
            (sensor_mm >= low) & (sensor_mm <= high)
        )
        return found


def _number(written: Mapping[str, Value], name: str, unit: float = 1.0) -> float | None:
    value = written.get(name)
    return None if value is None or isinstance(value, str) else float(value) * unit


def lists_of(record: AxisRecord) -> Lists:
    """Return the limits of an axis."""
    written = record.written
    accelerations = [float(v) for n, v in written.items() if _ACCELERATION.fullmatch(n)]
    return Lists(
        speed_mm_s=_number(written, "getriebe[0].dynamik.vb_max", _UM_S),
        a_mm_s2=max(accelerations, default=None),
        stroke_mm=_number(written, "kenngr.hub_messtaster", _TENTH_UM),
    )


def offset_lists_of(facts: Facts) -> dict[str, Lists]:
    """Return the limits of each distance control: by axis, and of the channel."""
    found = {name: _of_offset(facts.axes[name].written, _OF_AXIS) for name in facts.distance}
    if facts.distance_3d is not None:
        found[CHANNEL] = _of_offset(facts.channel, _OFFSET)
    return found


def _of_offset(written: Mapping[str, Value], place: str) -> Lists:
    def mm(name: str) -> float | None:
        return _number(written, f"{place}{name}", _TENTH_UM)

    low, high, margin = mm("min_pos"), mm("max_pos"), mm("tolerance") or 0.0
    return Lists(
        speed_mm_s=_number(written, f"{place}v_max", _UM_S),
        a_mm_s2=_number(written, f"{place}a_max"),
        deviation_mm=mm("max_deviation"),
        lowest_mm=None if low is None else low + margin,
        highest_mm=None if high is None else high - margin,
    )
