"""What follows for a row of testplans/fixed_stop_timing.csv, from closed forms written out here.

Nothing of the bench is imported. Along the axis everything counts in the direction of the run, from
the start of its block. Lengths in mm, times in s, forces in N, stiffness in N/mm, mass in kg.
Source of the numbered formulas: physics of the bench, "Measurement run to fixed stop", as quoted.
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace

from tests.plans.fixed_stop_setup import (
    FRICTION_BREAKAWAY,
    FRICTION_COULOMB,
    GRAVITY,
    PLANS,
    ROTOR_INERTIA,
    SCREW_STIFFNESS,
    STRIBECK_MM_S,
    VISCOUS,
    Setup,
)

# At SYNC k the drive stands at the set position of cycle k - 2: docs/architecture.md
DEMAND_CYCLES = 2
BRISTLES = 20e3  # stiffness of LuGre friction
VELOCITY_LOOP_S = 1 / (2 * math.pi * 60)


@dataclass(frozen=True)
class Axis(Setup):
    """One axis of a row with its laws."""

    @property
    def weight_n(self) -> float:
        """What the motor must carry; pulls towards negative."""
        if self.model != "GravityAxis":
            return 0.0
        return self.plant("mass_kg") * GRAVITY - self.plant("counterbalance_n")

    @property
    def friction_n(self) -> float:
        """Friction that may hold a share of the force at rest."""
        return self.plant("coulomb_friction_n") if self.model == "ServoAxis" else FRICTION_COULOMB

    @property
    def pressing_n(self) -> float:
        """What is left at the stop of the torque limit without friction."""
        viscous = VISCOUS * self.stop_speed * 1e-3
        return self.limit_n - self.direction * self.weight_n - viscous

    @property
    def k(self) -> float:
        """Stiffness of the stop, N/mm."""
        return self.plant("stop_stiffness_n_um") * 1e3

    @property
    def m_eff(self) -> float:
        """m + J (2 pi / lead)²."""
        lead_m = float(self.rig["drive"]["servo"]["lead_mm"]) * 1e-3
        return self.plant("mass_kg") + ROTOR_INERTIA * (2 * math.pi / lead_m) ** 2

    @property
    def penetration(self) -> tuple[float, float]:
        """physics 2(d)8: encoder behind x_stop at rest, least and most with friction."""
        twist = 0.0
        if self.model == "ScrewAxis":
            twist = self.limit_n / SCREW_STIFFNESS + self.plant("backlash_um") * 5e-4
        low, high = self.pressing_n - self.friction_n, self.pressing_n + self.friction_n
        return low / self.k + twist, high / self.k + twist

    @property
    def decay_s(self) -> float:
        """physics 2(d)9: 2 m / (viscous + F a)."""
        return 2 * self.m_eff / (VISCOUS + self.pressing_n * self.plant("stop_damping"))

    @property
    def swing(self) -> float:
        """Amplitude about the rest position: energy of the impact and of the step of the force."""
        static = self.pressing_n / self.k
        return math.hypot(static, self.impact_n / self.k)

    @property
    def impact_n(self) -> float:
        """v sqrt(k m): what an undamped stop takes of the motion alone."""
        return self.v * 1e-3 * math.sqrt(self.k * 1e3 * self.m_eff)

    def ringing(self, since_contact_s: float) -> float:
        """What is left of the amplitude."""
        return self.swing * math.exp(-since_contact_s / self.decay_s)

    # Lags and instants, from the contact on

    @property
    def lag(self) -> float:
        """Demand less encoder in steady motion: physics 2(c)."""
        return (1 - self.plant("feed_forward")) * self.v / self.plant("kv")

    @property
    def cnc_lag(self) -> float:
        """s(k - d) - x(k) in steady motion; d = 2 is what the drive itself sees."""
        # s(k) is not made yet when cycle k judges: 0 counts as 1
        delay = max(self.delay_cycles, 1)
        return self.lag + (DEMAND_CYCLES - delay) * self.v * self.T

    @property
    def ahead(self) -> float:
        """Encoder ahead of the slide when it touches: the screw is twisted by the friction."""
        if self.model != "ScrewAxis":
            return 0.0
        more = (FRICTION_BREAKAWAY - FRICTION_COULOMB) * math.exp(-((self.v / STRIBECK_MM_S) ** 2))
        dragged = FRICTION_COULOMB + more + VISCOUS * self.v * 1e-3
        return dragged / SCREW_STIFFNESS + self.plant("backlash_um") * 5e-4

    @property
    def stop_moves(self) -> float:
        """How far the stop moves in all, with its sign."""
        time_s = (self.plant("stop_end_ms") - self.plant("stop_begin_ms")) * 1e-3
        return self.plant("stop_speed_mm_s") * time_s

    @property
    def stop_speed(self) -> float:
        """Of a stop that moves while it is touched; 0 for one that stands again by then."""
        end = self.plant("stop_position_mm") + self.stop_moves
        way = abs(end - self.plant("position_start_mm"))
        stands = self.plant("stop_end_ms") * 1e-3 < way / self.v
        return 0.0 if stands else self.direction * self.plant("stop_speed_mm_s")

    @property
    def stop(self) -> float:
        """Path of the slide from the start of the run to the stop."""
        at = self.plant("stop_position_mm") + (0.0 if self.stop_speed else self.stop_moves)
        return self.direction * (at - self.plant("position_start_mm"))

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
        """physics 2(d)1: SYNC from which the lag is beyond its limit."""
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
        """physics 2(d)4: SYNC from which the window holds."""
        width, tau = self.criteria.window_mm, self.criteria.tau_cycles * self.T
        assert width is not None
        low, high = (tau - (width - depth + self.ahead) / self.v for depth in self.penetration)
        return self._quantised(low, high)

    @property
    def detection(self) -> tuple[float, float]:
        """From contact to the NC cycle that finds the stop; physics 2(d)2, 4, 5."""
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
        cycles and the buffer ahead of that, and brakes from there: physics 2(d)2, notes C.3.
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

    @property
    def free(self) -> tuple[float, float]:
        """Path of the axis at a detection without a stop, behind the arming in steady motion."""
        cycles = self.criteria.tau_cycles if self.criteria.lag_mm is not None else 0
        demand = self.armed_from + (cycles - self.buffer_cycles) * self.v * self.T
        steady = (demand - self.v * self.v / (2 * self.a)) / self.v
        loose = self.lag * math.exp(-self.plant("kv") * steady)
        return demand - self.v * self.T - self.lag - loose, demand - self.lag + loose

    @property
    def place(self) -> tuple[float, float]:
        """Latched position at rest against the stop, low and high."""
        low, high = sorted(self.position(self.stop + depth) for depth in self.penetration)
        return low, high

    @property
    def force(self) -> tuple[float, float]:
        """Contact force at detection: what presses, friction, an increment, the last ringing."""
        rest = self.k * (self.increment + self.ringing(self.detection[0]))
        return self.pressing_n - self.friction_n - rest, self.pressing_n + self.friction_n + rest

    @property
    def end_n(self) -> float:
        """No more than the limit gives, up to an increment of the latched position."""
        return self.pressing_n + self.friction_n + self.k * self.increment

    @property
    def peak(self) -> tuple[float, float]:
        """physics 2(d)10; the lower bound for an undamped stop."""
        most = self.pressing_n + math.hypot(self.pressing_n, self.impact_n)
        if self.plant("stop_damping") > 0:
            return 0.0, most
        return self.impact_n, most

    @property
    def deepest(self) -> float:
        """Path to the deepest place in the stop, without damping."""
        return self.stop + self.pressing_n / self.k + self.swing

    @property
    def at_start(self) -> tuple[float, float]:
        """Path in the first cycles: the axis is judged from rest on, two cycles are on the way."""
        return 0.0, self.a * (3 * self.T) ** 2 / 2

    @property
    def in_ramp(self) -> tuple[float, float]:
        """Path at a detection by a lag limit that the run-up exceeds; armed at once.

        physics 2(c): e' = v(t) - Kv e, up to what the velocity loop shifts.
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

    @property
    def held(self) -> tuple[float, float]:
        """Position of an axis that its friction holds against a load f.

        LuGre: the bristles give g (1 - c exp(-s0 x/g)), c = 1 + their first share; g is the
        breakaway force, lower at the speed that the load can bring about. The load has done more
        work than they take until x with f x = their integral.
        """
        balanced = abs(self.weight_n) < 1.0
        load = self.limit_n if balanced else self.weight_n - self.limit_n
        first, g = (1.0 if balanced else 2.0), FRICTION_BREAKAWAY
        for _ in range(20):
            assert load < g
            fastest = math.log(first / (1 - load / g))  # there the forces balance
            work = g / BRISTLES * ((load - g) * fastest + g * first * (1 - math.exp(-fastest)))
            v = math.sqrt(2 * work * 1e-3 / self.m_eff) * 1e3
            more = (FRICTION_BREAKAWAY - FRICTION_COULOMB) * math.exp(-((v / STRIBECK_MM_S) ** 2))
            g = FRICTION_COULOMB + more
        bent = solve(lambda z: (1 - load / g) * z - first * (1 - math.exp(-z)), 1e-6, 1e3)
        way = bent * g / BRISTLES
        start = self.plant("position_start_mm")
        return (start, start + way) if balanced else (start - way, start)

    @property
    def receded(self) -> float:
        """Latched position behind a stop that has given way."""
        moved = self.plant("stop_position_mm") + self.stop_moves
        return moved + self.direction * self.limit_n / self.k

    def shared(self, other: "Axis") -> tuple[float, float]:
        """Path of this axis when another one has found its stop, both on one straight path.

        At the detection s(k - 2) is e before x: physics 2(d)2.
        """
        limit = other.criteria.lag_mm
        assert limit is not None
        assert other.delay_cycles == DEMAND_CYCLES
        least = other.stop + other.penetration[0] + limit
        least += other.criteria.tau_cycles * other.v * other.T
        ratio = self.v / other.v
        return least * ratio - self.lag, (least + other.v * other.T) * ratio - self.lag


def solve(function: Callable[[float], float], low: float, high: float) -> float:
    """Return where a function that is negative at low and positive at high is 0."""
    assert function(low) < 0 < function(high)
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (low, middle) if function(middle) > 0 else (middle, high)
    return high


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
