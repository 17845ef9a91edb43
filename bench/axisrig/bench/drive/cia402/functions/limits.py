"""Limits of a drive: software position limits, speeds, accelerations, torque."""

import math
from typing import Final

from axisrig.bench.drive.axis.ports import AxisPort
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.units import U32_MAX, Units

PER_MILLE: Final = 1000
NO_TORQUE_LIMIT: Final = 0xFFFF  # 6072, 60E0, 60E1: the motor's own limit alone
NEGATIVE_END, POSITIVE_END = 0b01, 0b10  # bits of the limit switches in 60FD
REACHED: Final = 0.99  # share of a torque limit from which on it counts as reached


class Limits:
    """The limits as they are in the objects, in SI units; `update` reads them again.

    low_m, high_m: where a position demand may be. speed_m_s: 6080. profile_m_s: the least of 6080
    and 607F. negative, positive: torque in per mille of 6076, the least of 6072 and 60E1 or 60E0;
    homing_torque: a further limit while homing presses against a stop, None = none. blocked:
    directions whose limit switch is on, bit 0 negative, bit 1 positive.
    """

    def __init__(
        self, axis: AxisPort, profile: DriveProfile, image: ProcessImage, units: Units
    ) -> None:
        self._axis, self._image, self._units = axis, image, units
        self._lead_m = profile.lead_um * 1e-6
        self.rated_n = profile.rated_force_n
        self.negative = self.positive = NO_TORQUE_LIMIT
        self._limits_acting: tuple[int, int, int, int | None] = (*(NO_TORQUE_LIMIT,) * 3, None)
        self.is_limiting = False
        self.homing_torque: int | None = None
        self.blocked = 0
        self._ends_m = (-math.inf, math.inf)
        self.update()

    def update(self) -> None:
        """Read every limit but those of the torque again."""
        image, units = self._image, self._units
        low, high = image.software_limit_min, image.software_limit_max
        self.low_m, self.high_m = -math.inf, math.inf
        if low < high:
            # Relative to the machine home position: less the home offset
            home = units.home_units
            self.low_m, self.high_m = units.position_m(low + home), units.position_m(high + home)
        if self.blocked:
            self.low_m = max(self.low_m, self._ends_m[0])
            self.high_m = min(self.high_m, self._ends_m[1])
        speed = image.max_motor_speed
        self.speed_m_s = math.inf if speed == U32_MAX else speed * self._lead_m / 60.0
        profile = image.max_profile_velocity
        profile_m_s = math.inf if profile == U32_MAX else units.metres(profile)
        self.profile_m_s = min(self.speed_m_s, profile_m_s)

    def forget(self) -> None:
        """Lift what homing and limit switches have limited, as after power on."""
        self.homing_torque = None
        self.blocked = 0

    def block(self, word: int, position_m: float) -> None:
        """Allow no motion past a place in the directions whose limit switch is on.

        A direction that is blocked already keeps its place.
        """
        new, (low_m, high_m) = word & ~self.blocked, self._ends_m
        low_m = position_m if new & NEGATIVE_END else low_m
        high_m = position_m if new & POSITIVE_END else high_m
        self._ends_m = (
            low_m if word & NEGATIVE_END else -math.inf,
            high_m if word & POSITIVE_END else math.inf,
        )
        self.blocked = word
        self.update()

    def rates_m_s2(self) -> tuple[float, float]:
        """Return acceleration and deceleration of a profile; 0, that only a PDO can write, is 1."""
        image = self._image
        return (
            self._units.metres(max(1, min(image.profile_acceleration, image.max_acceleration))),
            self._units.metres(max(1, min(image.profile_deceleration, image.max_deceleration))),
        )

    def quick_stop_m_s2(self) -> float:
        """Return the deceleration of the quick-stop ramp."""
        image = self._image
        return self._units.metres(min(image.quick_stop_deceleration, image.max_deceleration))

    def position_m(self, position_m: float) -> float:
        """Return a position demand within the software limits."""
        return max(self.low_m, min(position_m, self.high_m))

    def velocity_m_s(self, velocity_m_s: float) -> float:
        """Return a velocity demand within the speed limit of the motor, in no blocked direction."""
        low = 0.0 if self.blocked & NEGATIVE_END else -self.speed_m_s
        high = 0.0 if self.blocked & POSITIVE_END else self.speed_m_s
        return max(low, min(velocity_m_s, high))

    def torque(self, per_mille: int) -> int:
        """Return a torque demand within the limits, in no blocked direction."""
        low = 0 if self.blocked & NEGATIVE_END else -self.negative
        high = 0 if self.blocked & POSITIVE_END else self.positive
        return max(low, min(per_mille, high))

    def limit_torque(self) -> None:
        """Hand the torque limits over to the axis when they have changed."""
        image = self._image
        limits = (
            image.max_torque,
            image.negative_torque_limit,
            image.positive_torque_limit,
            self.homing_torque,
        )
        if limits == self._limits_acting:
            return
        self._limits_acting = limits
        most, negative, positive, homing = limits
        if homing is not None:
            most = min(most, homing)
        negative, positive = min(most, negative), min(most, positive)
        if negative != self.negative or positive != self.positive:
            self.negative, self.positive = negative, positive
            self.is_limiting = min(negative, positive) != NO_TORQUE_LIMIT
            scale = self.rated_n / PER_MILLE
            self._axis.limit_force(negative * scale, positive * scale)

    def torque_per_mille(self) -> int:
        """Return the actual torque in per mille of the rated one; 0 where the plant gives none."""
        force_n = self._axis.force_n()
        if force_n is None:
            return 0
        return max(-0x8000, min(round(force_n / self.rated_n * PER_MILLE), 0x7FFF))

    def is_torque_limited(self, per_mille: int) -> bool:
        """Whether the actual torque is at one of the limits that the objects set."""
        limit = self.positive if per_mille >= 0 else self.negative
        return limit != NO_TORQUE_LIMIT and abs(per_mille) >= REACHED * limit
