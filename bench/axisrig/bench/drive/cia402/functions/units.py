"""Position units of the bus and SI units, as the drive reckons with its scaling objects."""

from fractions import Fraction
from typing import Final

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

U32_MAX: Final = 0xFFFF_FFFF


class Units:
    """Metres to position units of the bus and back.

    The encoder quantises first (increments), then comes the position factor. A position outside 32
    bits wraps as the object does. origin_units: added to every position, what homing sets;
    home_units: the position at the machine home position (0 before homing). is_homed: homing has
    found it, under the present scaling.
    Source: CiA 402-2, position = increments * feed / (encoder resolution * gear ratio) with the
    objects 608F, 6091, 6092; whole numbers throughout, so that no intermediate value overflows.
    """

    __slots__ = (
        "_factor",
        "_image",
        "_second_factor",
        "_units_per_m",
        "home_units",
        "increments_per_m",
        "is_homed",
        "origin_units",
    )

    def __init__(self, profile: DriveProfile, image: ProcessImage) -> None:
        self.increments_per_m = float(profile.increments_per_mm * 1000)
        self._image = image
        self._units_per_m = 0.0
        self.forget_home()
        self.update()

    def forget_home(self) -> None:
        """Count from the zero of the encoder, as after power on."""
        self.origin_units = self.home_units = 0
        self.is_homed = False

    def set_home(self, position_m: float, units: int) -> None:
        """Give a place, the machine home position, a position on the bus."""
        self.origin_units = 0
        self.origin_units = units - self.position_units(position_m)
        self.home_units = units
        self.is_homed = True

    def update(self) -> None:
        """Read the scaling objects again; with another position unit home is forgotten."""
        image = self._image
        factor = Fraction(
            image.feed * image.encoder_revolutions * image.gear_shaft,
            image.feed_shaft * image.encoder_increments * image.gear_motor,
        )
        self._factor = None if factor == 1 else factor
        second_factor = Fraction(
            image.feed * image.second_revolutions * image.gear_shaft,
            image.feed_shaft * image.second_increments * image.gear_motor,
        )
        self._second_factor = None if second_factor == 1 else second_factor
        units_per_m = self.increments_per_m * float(factor)
        if units_per_m != self._units_per_m:
            self.forget_home()
        self._units_per_m = units_per_m

    def position_units(self, position_m: float) -> int:
        """Return a position as the encoder and the bus give it."""
        units = round(position_m * self.increments_per_m)
        if self._factor is not None:
            units = scaled(units, self._factor)
        return (units + self.origin_units + 0x8000_0000 & 0xFFFF_FFFF) - 0x8000_0000

    def second_units(self, position_m: float) -> int:
        """Return the value of the second encoder: with 60E6 and 60EB in the place of 608F."""
        units = self.increments(position_m)
        if self._second_factor is not None:
            units = scaled(units, self._second_factor)
        return (units + 0x8000_0000 & U32_MAX) - 0x8000_0000

    def increments(self, position_m: float) -> int:
        """Return a position in increments of the encoder; wraps at 32 bits."""
        return (round(position_m * self.increments_per_m) + 0x8000_0000 & U32_MAX) - 0x8000_0000

    def position_m(self, units: float) -> float:
        """Return the position that position units of the bus mean."""
        return (units - self.origin_units) / self._units_per_m

    def velocity_units_s(self, velocity_m_s: float) -> int:
        """Return a velocity in position units per second, limited to 32 bits."""
        return limit_i32(round(velocity_m_s * self._units_per_m))

    def deviation_units(self, deviation_m: float) -> int:
        """Return a difference of positions in position units, limited to 32 bits."""
        return limit_i32(round(deviation_m * self._units_per_m))

    def metres(self, units: float) -> float:
        """Return a difference of positions in m, a velocity in m/s, an acceleration in m/s2."""
        return units / self._units_per_m


def scaled(value: int, factor: Fraction) -> int:
    """Return `round(value * factor)`, halves to the even number, without a new Fraction."""
    denominator: int = factor.denominator
    whole, rest = divmod(value * factor.numerator, denominator)
    if 2 * rest > denominator or (2 * rest == denominator and whole & 1):
        whole += 1
    return whole


def limit_i32(value: int) -> int:
    """Limit to the range of INTEGER32."""
    if -0x8000_0000 <= value <= 0x7FFF_FFFF:
        return value
    return max(-0x8000_0000, min(value, 0x7FFF_FFFF))
