"""How an axis at its force limit and a stop press on each other.

Symbols: k stiffness of the stop, F_lim force limit of the drive, F_g weight against the motion into
the stop (negative: the weight helps), F_c dry friction, m moving mass (slide and rotor), v speed.
Sources: equilibrium of the slide; energy of a mass on a spring under a constant force; K. H. Hunt,
F. R. E. Crossley, J. Applied Mechanics 42 (1975) for the damping.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

UM = 1e-3
# Up to this product of damping share and speed a damped stop never presses harder than one
# without damping: its smaller penetration weighs more than the damping force
DAMPED_MAX = 1.0
OF_SUMMIT = 0.0303
"""Largest of |u (u - 1) (u - 2) (u - 3) (u - 4)| from 0 to 4, 3.632, over 5!."""


@dataclass(frozen=True)
class Stop:
    """F = k p (p/p_r)^(n-1) (1 + a dp/dt), SI units; direction: 1 = met going upwards."""

    direction: int
    stiffness_n_m: float
    exponent: float = 1.0
    reference_m: float = 1e-5
    damping_s_m: float = 0.0

    def penetration_mm(self, force_n: float) -> float:
        """Return how far a static force presses in."""
        linear_m: float = max(force_n, 0.0) / self.stiffness_n_m
        if self.exponent == 1.0:
            return linear_m * 1e3
        share = math.pow(linear_m / self.reference_m, 1.0 / self.exponent)
        return self.reference_m * share * 1e3

    def doubt_n(self, force_n: float, off_mm: float) -> float:
        """Return what a penetration that is known to off_mm says of a force: dF = n F dp/p."""
        deep_mm = self.penetration_mm(force_n)
        return self.exponent * force_n * off_mm / deep_mm if deep_mm > 0.0 else 0.0

    def summit_doubt_n(self, force_n: float, mass_kg: float, step_s: float) -> float:
        """Return how far a polynomial through five forces, step_s apart, misses the largest one.

        At most 0.03 h^5 |d^5F/dt^5| (interpolation of degree 4). What m s^2 + d s + k = 0 gives
        for a mass on a stop is at most L = d/m + sqrt(k/m), with k = n F/p and d = a F at the
        force F. It is the product of the force of a spring and 1 + a dp/dt: (2 L)^5 F.
        """
        deep_m = self.penetration_mm(force_n) * UM
        if deep_m <= 0.0:
            return 0.0
        rate = self.damping_s_m * force_n / mass_kg
        rate += math.sqrt(self.exponent * force_n / deep_m / mass_kg)
        return OF_SUMMIT * force_n * (2.0 * rate * step_s) ** 5


def drive_limit_n(rated_torque_mnm: int, lead_um: float, per_mille: Sequence[int]) -> float:
    """Return the force of a motor at its torque limits, of which the least acts.

    F = 2 pi M / lead (a screw without loss); per_mille: of the rated torque M, 6072 and 60E0 or
    60E1. Source: CiA 402-2, objects 6072 and 60E0.
    """
    rated_n = 2.0 * math.pi * rated_torque_mnm * 1e3 / lead_um
    return min(per_mille) * rated_n / 1000


@dataclass(frozen=True)
class Axis:
    """What presses, SI units.

    weight_n: pulls towards smaller positions. friction_n: dry friction at standstill. joint_n_m:
    stiffness between motor encoder and load, None = rigid; backlash_mm: free travel in it. mass_kg:
    everything that moves.
    """

    mass_kg: float
    weight_n: float = 0.0
    friction_n: float = 0.0
    viscous_n_s_m: float = 0.0
    joint_n_m: float | None = None
    backlash_mm: float = 0.0

    def give_mm(self, force_n: float) -> float:
        """Return how far the motor is ahead of the load under a static force of the motor."""
        if self.joint_n_m is None:
            return 0.0
        return self.backlash_mm / 2.0 + force_n / self.joint_n_m * 1e3


@dataclass(frozen=True)
class Pressing:
    """Axis against stop at the force limit `limit_n` of the drive."""

    stop: Stop
    axis: Axis
    limit_n: float

    @property
    def pushing_n(self) -> float:
        """Force at the limit less the weight, F_lim - F_g: at the stop without friction."""
        return self.limit_n - self.stop.direction * self.axis.weight_n

    @property
    def force_n(self) -> tuple[float, float]:
        """Return least and largest static force at the stop, max(0, F_lim - F_g -+ F_c)."""
        low, high = (self.pushing_n + sign * self.axis.friction_n for sign in (-1.0, 1.0))
        return max(low, 0.0), max(high, 0.0)

    @property
    def penetration_mm(self) -> float:
        """Return delta without friction."""
        return self.stop.penetration_mm(self.pushing_n)

    def latched_mm(self, stop_mm: float) -> tuple[float, float]:
        """Return the band of the position at the motor encoder when the axis is at standstill.

        x_stop + delta of both ends of the friction band, further by what the joint gives under the
        force of the motor: backlash/2 + F_lim/k_joint.
        """
        ends = [self.stop.penetration_mm(force) for force in self.force_n]
        give_mm = self.axis.give_mm(self.limit_n)
        low, high = sorted(stop_mm + self.stop.direction * (end + give_mm) for end in ends)
        return low, high

    def peak_force_n(self, speed_mm_s: float) -> tuple[float, float | None]:
        """Return bounds of the largest contact force of an axis that meets the stop with a speed.

        At most F + sqrt(F^2 + k m v^2) with F = max(0, F_lim - F_g): energy of mass and drive. At
        least v sqrt(k m) without damping. Only for a straight stop that damps little at the highest
        speed inside, sqrt(v^2 + F^2/k m); None: no bound is known.
        """
        speed_m_s = speed_mm_s * UM
        low = 0.0
        if self.stop.exponent != 1.0:
            return low, None
        force_n = max(self.pushing_n, 0.0)
        impedance = math.sqrt(self.stop.stiffness_n_m * self.axis.mass_kg)
        impact_n = speed_m_s * impedance
        fastest_m_s = math.hypot(speed_m_s, force_n / impedance)
        if self.stop.damping_s_m == 0.0 and self.axis.friction_n == 0.0:
            low = impact_n
        if self.stop.damping_s_m * fastest_m_s > DAMPED_MAX:
            return low, None
        return low, force_n + math.hypot(force_n, impact_n)

    @property
    def decay_s(self) -> float:
        """Return the decay time of the ringing, t_d = 2 m / (d + F a), inf without damping."""
        damping = self.axis.viscous_n_s_m + self.pushing_n * self.stop.damping_s_m
        return 2.0 * self.axis.mass_kg / damping if damping > 0.0 else math.inf

    @property
    def is_held(self) -> bool:
        """Whether the limit overcomes weight and friction, so that the axis reaches a stop."""
        return self.pushing_n > self.axis.friction_n
