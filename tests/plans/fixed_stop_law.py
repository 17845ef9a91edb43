"""What follows for a row of testplans/fixed_stop_timing.csv, from closed forms written out here.

Nothing of the bench is imported. Along the axis everything counts in the direction of the run, from
the start of its block. Lengths in mm, times in s, forces in N, stiffness in N/mm, mass in kg.
v feed, e0 running lag, F/k depth in the stop, L lag limit, W window, tau minimum time, t_c contact:
lag criterion t_c + (L - e0 + F/k)/v + tau, window criterion t_c + tau - (W - F/k)/v.
"""

import math
import re
from dataclasses import dataclass, replace

from tests.plans.fixed_stop_forces import Pressing, solve
from tests.plans.fixed_stop_setup import PLANS, VISCOUS

# At SYNC k the drive stands at the set position of cycle k - 2: docs/architecture.md
DEMAND_CYCLES = 2
VELOCITY_LOOP_S = 1 / (2 * math.pi * 60)
INTEGRAL_TIME_S = 8e-3
SETTLED_CYCLES = 10


@dataclass(frozen=True)
class Axis(Pressing):
    """One axis of a row with its laws."""

    @property
    def lag(self) -> float:
        """Demand less encoder in steady motion."""
        return (1 - self.plant("feed_forward")) * self.v / self.plant("kv")

    @property
    def cnc_lag(self) -> float:
        """s(k - d) - x(k) in steady motion; d = 2 is what the drive itself sees."""
        # s(k) is not made yet when cycle k judges: 0 counts as 1
        delay = max(self.delay_cycles, 1)
        return self.lag + (DEMAND_CYCLES - delay) * self.v * self.T

    @property
    def gaining(self) -> float:
        """How fast the demand goes on relative to the stop."""
        return self.v - self.stop_speed

    @property
    def steady_s(self) -> float:
        """How long the axis has moved with v before it touches."""
        return (self.stop - self.v * self.v / (2 * self.a)) / self.v

    @property
    def armed(self) -> tuple[float, float]:
        """SYNC of the arming cycle: the path of the interpolator is buffer + 1 cycles ahead."""
        crossed = (self.armed_from - self.stop - self.lag) / self.v
        return crossed - (self.buffer_cycles + 1) * self.T, crossed - self.buffer_cycles * self.T

    def _quantised(self, low: float, high: float) -> tuple[float, float]:
        """First SYNC behind a crossing, and what is left of ringing and of the start-up there."""
        start_up = self.lag * math.exp(-self.plant("kv") * self.steady_s) / self.v
        loose = self.ringing(low) / self.gaining + start_up
        armed_low, armed_high = self.armed
        return max(low - loose, armed_low), max(high + loose + self.T, armed_high)

    @property
    def beyond(self) -> tuple[float, float]:
        """SYNC from which the lag is beyond its limit."""
        limit = self.criteria.lag_mm
        assert limit is not None
        if limit < self.cnc_lag:
            return self.armed
        low, high = (
            (limit - self.cnc_lag + depth - self.ahead) / self.gaining for depth in self.penetration
        )
        return self._quantised(low, high)

    @property
    def window(self) -> tuple[float, float]:
        """SYNC from which the window holds."""
        width, tau = self.criteria.window_mm, self.criteria.tau_cycles * self.T
        assert width is not None
        low, high = (tau - (width - depth + self.ahead) / self.v for depth in self.penetration)
        return self._quantised(low, high)

    @property
    def detection(self) -> tuple[float, float]:
        """From contact to the NC cycle that finds the stop."""
        bands = []
        if self.criteria.lag_mm is not None:
            bands.append([at + self.criteria.tau_cycles * self.T for at in self.beyond])
        if self.criteria.window_mm is not None:
            bands.append(list(self.window))
        low, high = (max(each) + self.judged_s for each in zip(*bands, strict=True))
        return low, high

    @property
    def excess(self) -> tuple[float, float]:
        """Command behind the latched position when it stands, lag criterion.

        e(k) = s(k - d) - x(k) is between L + v tau and one cycle more; the interpolator is d - 1
        cycles and the buffer ahead of that, and brakes from there.
        """
        limit = self.criteria.lag_mm
        assert limit is not None
        ahead = max(self.delay_cycles, 1) - 1 + self.buffer_cycles
        least = (
            limit
            + self.v * self.T * (self.criteria.tau_cycles + ahead)
            + self.v * self.v / (2 * self.a)
        )
        return least, least + self.v * self.T

    def _creeping_s(self, k: float) -> float:
        """Time constant with which a PI velocity loop brings the axis back against k, N/m.

        Slowest root of m s³ + (kp + d) s² + (k + kp Kv + kp/Tn) s + kp Kv/Tn: about
        Tn (k + kp Kv)/(kp Kv) + 1/Kv; 1/Kv in free motion.
        """
        kp = self.m_eff / VELOCITY_LOOP_S
        gain = kp * self.plant("kv")
        middle, last = k + gain + kp / INTEGRAL_TIME_S, gain / INTEGRAL_TIME_S
        rate = 0.0
        for _ in range(100):
            rate = (last + (kp + VISCOUS) * rate**2 - self.m_eff * rate**3) / middle
        return 1 / rate

    def left_lag(self, later: int = 0) -> tuple[float, float]:
        """Lag at the end of a run with full feed-forward: the axis comes back from off the stop.

        It has been in its exact-stop window for ten cycles, the first of them within one cycle of
        its edge; against the stop when the edge lies inside the penetration, else in free motion.
        later: so many cycles after it was sampled a position is read; the run lasts as many longer.
        """
        pressed = self.window_mm < self.penetration[0]
        time_s = self._creeping_s(self.k * 1e3 if pressed else 0.0)
        low, high = (
            self.window_mm * math.exp(-(cycles + later) * self.T / time_s)
            for cycles in (SETTLED_CYCLES + 1, SETTLED_CYCLES)
        )
        assert pressed or low > self.penetration[1], "in free motion up to the end"
        return low - self.increment, high + self.increment

    @property
    def free(self) -> tuple[float, float]:
        """Path of the axis at a detection without a stop, behind the arming in steady motion."""
        cycles = self.criteria.tau_cycles if self.criteria.lag_mm is not None else 0
        demand = self.armed_from + (cycles - self.buffer_cycles) * self.v * self.T
        steady = (demand - self.v * self.v / (2 * self.a)) / self.v
        loose = self.lag * math.exp(-self.plant("kv") * steady)
        return demand - self.v * self.T - self.lag - loose, demand - self.lag + loose

    @property
    def force(self) -> tuple[float, float]:
        """Contact force at detection: what presses, friction, an increment, the last ringing."""
        rest = self.k * (self.increment + self.ringing(self.detection[0]))
        return self.pressing_n - self.friction_n - rest, self.pressing_n + self.friction_n + rest

    @property
    def at_start(self) -> tuple[float, float]:
        """Path in the first cycles: the axis is judged from rest on, two cycles are on the way."""
        return 0.0, self.a * (3 * self.T) ** 2 / 2

    @property
    def in_ramp(self) -> tuple[float, float]:
        """Path at a detection by a lag limit that the run-up exceeds; armed at once.

        e' = v(t) - Kv e, up to what the velocity loop shifts.
        """
        limit, kv, ramp = self.criteria.lag_mm, self.plant("kv"), self.v / self.a
        assert limit is not None
        end = self.a * ramp / kv - self.a / kv**2 * (1 - math.exp(-kv * ramp))
        assert end < limit < self.lag

        def lag(t: float) -> float:
            return self.lag - (self.lag - end) * math.exp(-kv * (t - ramp))

        at = ramp + math.log((self.lag - end) / (self.lag - limit)) / kv
        tau = self.criteria.tau_cycles * self.T
        early, late = at - VELOCITY_LOOP_S + tau, at + VELOCITY_LOOP_S + self.T + tau
        low, high = (self.v * t - self.v * ramp / 2 - lag(t) for t in (early, late))
        return low, high

    @property
    def still_ringing(self) -> tuple[float, float]:
        """Path at a detection in the first swing; lag criterion, no weight, no friction.

        The motor force is between 0 and its limit, the share of the damping between 0 and a v. So
        the axis is between a stiffer oscillator without a force and one with the whole force and
        without damping (Sturm), and so are the lag and the instants.
        """
        soft = math.sqrt(self.k * 1e3 / self.m_eff)
        stiff = soft * math.sqrt(1 + self.plant("stop_damping") * self.v * 1e-3)
        limit, static = self.criteria.lag_mm, self.pressing_n / self.k
        assert limit is not None

        def least(t: float) -> float:
            return self.v / stiff * math.sin(stiff * t)

        def most(t: float) -> float:
            return self.v / soft * math.sin(soft * t) + static * (1 - math.cos(soft * t))

        margin, half = limit - self.cnc_lag, math.pi / soft
        early = solve(lambda t: self.v * t - least(t) - margin, 0.0, half)
        late = solve(lambda t: self.v * t - most(t) - margin, 0.0, half)
        tau = self.criteria.tau_cycles * self.T
        last = late + self.T + tau
        assert last < math.pi / stiff
        low = min(least(early + tau), least(last))
        return self.stop + low, self.stop + static + math.hypot(static, self.v / soft)

    def shared(self, other: "Axis") -> tuple[float, float]:
        """Path of this axis when another one has found its stop, both on one straight path.

        At the detection s(k - 2) is e before x.
        """
        limit = other.criteria.lag_mm
        assert limit is not None
        assert other.delay_cycles == DEMAND_CYCLES
        least = other.stop + other.penetration[0] + limit
        least += other.criteria.tau_cycles * other.v * other.T
        ratio = self.v / other.v
        return least * ratio - self.lag, (least + other.v * other.T) * ratio - self.lag


def axes(row: dict[str, str]) -> dict[str, Axis]:
    """Return the axes of the measuring block; the smallest arming path counts for all."""
    program = (PLANS / row["program"]).read_text(encoding="utf-8")
    found = re.search(r"^N\d+ (?:G90 )?G100 (.*) F=?(\S+)", program, re.M)
    assert found is not None
    feed = found[2] if found[2] != "V.E.FEED" else row["plc:V.E.FEED"]
    ways = {}
    for name, target in re.findall(r"\b([A-Z])=?(V\.E\.\w+|\d+)", found[1]):
        to = float(target if target[0].isdigit() else row[f"plc:{target}"])
        ways[name] = to - Axis(row, name, 1, 0.0, 0.0).plant("position_start_mm")
    block = math.hypot(*ways.values())
    v = float(feed) / 60
    known = [
        Axis(row, name, 1 if way >= 0 else -1, v * abs(way) / block, block)
        for name, way in ways.items()
    ]
    least = min(each.arming for each in known)
    return {each.name: replace(each, armed_from=least * each.v / v) for each in known}


def axis(row: dict[str, str]) -> Axis:
    """Return the axis of a row with one."""
    (only,) = axes(row).values()
    return only
