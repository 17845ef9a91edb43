"""Forces and places at the stop that follow for a row of testplans/fixed_stop_timing.csv.

Nothing of the bench is imported. Along the axis everything counts in the direction of the run, from
the start of its block. Lengths in mm, times in s, forces in N, stiffness in N/mm, mass in kg.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from tests.plans.fixed_stop_setup import (
    FRICTION_BREAKAWAY,
    FRICTION_COULOMB,
    GRAVITY,
    ROTOR_INERTIA,
    SCREW_STIFFNESS,
    STRIBECK_MM_S,
    VISCOUS,
    Setup,
)

BRISTLES = 20e3  # stiffness of LuGre friction


def solve(function: Callable[[float], float], low: float, high: float) -> float:
    """Return where a function that is negative at low and positive at high is 0."""
    assert function(low) < 0 < function(high)
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (low, middle) if function(middle) > 0 else (middle, high)
    return high


@dataclass(frozen=True)
class Pressing(Setup):
    """One axis of a row against its stop."""

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
        """encoder behind x_stop at rest, least and most with friction."""
        twist = 0.0
        if self.model == "ScrewAxis":
            twist = self.limit_n / SCREW_STIFFNESS + self.plant("backlash_um") * 5e-4
        low, high = self.pressing_n - self.friction_n, self.pressing_n + self.friction_n
        return low / self.k + twist, high / self.k + twist

    @property
    def decay_s(self) -> float:
        """2 m / (viscous + F a)."""
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
    def place(self) -> tuple[float, float]:
        """Latched position at rest against the stop, low and high."""
        low, high = sorted(self.position(self.stop + depth) for depth in self.penetration)
        return low, high

    @property
    def end_n(self) -> float:
        """No more than the limit gives, up to an increment of the latched position."""
        return self.pressing_n + self.friction_n + self.k * self.increment

    @property
    def peak(self) -> tuple[float, float]:
        """the lower bound for an undamped stop."""
        most = self.pressing_n + math.hypot(self.pressing_n, self.impact_n)
        if self.plant("stop_damping") > 0:
            return 0.0, most
        return self.impact_n, most

    @property
    def deepest(self) -> float:
        """Path to the deepest place in the stop, without damping."""
        return self.stop + self.pressing_n / self.k + self.swing

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
