"""The slopes of a measurement run, read from what the parameter lists say.

Which parameters act: FCT-C4 2.1, second table, by P-CHAN-00296, 00214 and 00097. Their defaults,
units and what 0 means: texts of P-AXIS-00005, 00006, 00011, 00012, 00024, 00211, 00221, 00280 and
00281, and of P-CHAN-00097, 00214 and 00296 in FCT-C4 8.2.1. Where these are silent or contradict
each other: docs/ambiguities.md, "Dynamics and parameters".
"""

from dataclasses import dataclass

from axisrig.bench.oracles.fixed_stop.lists import Written

_SLOPE = "getriebe[0].lslope_profil."
STEP_MM_S2 = 1000.0
"""Default of P-AXIS-00005, 00006, 00011 and 00012."""
CHANGE_OVER_UM_S = 100_000.0
"""Default of P-AXIS-00211 and 00221."""
UM_PER_MM = 1000.0


@dataclass(frozen=True)
class Slope:
    """The linear slope with two steps: one acceleration up to the change-over speed, one above."""

    low_mm_s2: float
    high_mm_s2: float
    change_over_mm_s: float

    def way_mm(self, speed_mm_s: float) -> float:
        """Return the way between standstill and a speed.

        Source: v dv = a ds, so that s = v^2/2a below the change-over speed c, and
        s = c^2/2a_1 + (v^2 - c^2)/2a_2 above it.
        """
        low_mm_s2, high_mm_s2, change_mm_s = self.low_mm_s2, self.high_mm_s2, self.change_over_mm_s
        if speed_mm_s <= change_mm_s:
            return speed_mm_s**2 / (2.0 * low_mm_s2)
        first_mm = change_mm_s**2 / (2.0 * low_mm_s2)
        return first_mm + (speed_mm_s**2 - change_mm_s**2) / (2.0 * high_mm_s2)


@dataclass(frozen=True)
class MeasuringSlopes:
    """What an axis does in a measurement run: up to its feed, and down when the signal comes."""

    up: Slope
    on_signal: Slope


def has_ramps(channel: Written) -> bool:
    """Return whether the list of the channel chooses a profile with a limited jerk (P-CHAN-00071).

    What is here is of the linear slope: nothing of it holds then.
    """
    return bool(_number(channel, "prog_start.slope.profile", 0.0))


def slopes_as_written(axis: Written, channel: Written) -> MeasuringSlopes:
    """Return the slopes of an axis from its list and that of the channel.

    With P-CHAN-00296 the feed blocks count, and the signal always brakes with P-AXIS-00024. Else
    the rapid values count, and the signal brakes with the rapid acceleration (P-CHAN-00214), with
    P-AXIS-00024 (P-CHAN-00097), or with the rapid deceleration. Source: FCT-C4 2.1, second table.
    """
    if _number(channel, "meas_use_std_dynamic", 0.0):
        return MeasuringSlopes(_acceleration(axis, "", "vb_stufe_1_2"), _feedhold(axis))
    up = _acceleration(axis, "grenz_", "vb_grenz_stufe_1_2")
    if _number(channel, "meas_deceleration_mode", 0.0):
        return MeasuringSlopes(up, up)
    if _number(channel, "use_drive_curr_limit", 0.0):
        return MeasuringSlopes(up, _feedhold(axis))
    return MeasuringSlopes(up, _rapid_deceleration(axis, up))


def _number(written: Written, name: str, otherwise: float) -> float:
    value = written.get(name, otherwise)
    assert isinstance(value, int | float)
    return float(value)


def _acceleration(axis: Written, kind: str, change_over: str) -> Slope:
    """Read both steps. kind: `grenz_` for rapid blocks, nothing for feed blocks."""
    return Slope(
        _number(axis, f"{_SLOPE}a_{kind}stufe_1", STEP_MM_S2),
        _number(axis, f"{_SLOPE}a_{kind}stufe_2", STEP_MM_S2),
        _number(axis, _SLOPE + change_over, CHANGE_OVER_UM_S) / UM_PER_MM,
    )


def _rapid_deceleration(axis: Written, up: Slope) -> Slope:
    """Return P-AXIS-00280 and 00281; each 0 (default) is the acceleration of the same step."""
    return Slope(
        _number(axis, f"{_SLOPE}d_grenz_stufe_1", 0.0) or up.low_mm_s2,
        _number(axis, f"{_SLOPE}d_grenz_stufe_2", 0.0) or up.high_mm_s2,
        up.change_over_mm_s,
    )


def _feedhold(axis: Written) -> Slope:
    """Return P-AXIS-00024, one step; 0 (default) is the smaller step of the rapid acceleration."""
    rapid = _acceleration(axis, "grenz_", "vb_grenz_stufe_1_2")
    hold_mm_s2 = _number(axis, f"{_SLOPE}a_feedh", 0.0)
    hold_mm_s2 = hold_mm_s2 or min(rapid.low_mm_s2, rapid.high_mm_s2)
    return Slope(hold_mm_s2, hold_mm_s2, rapid.change_over_mm_s)
