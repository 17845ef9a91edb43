"""What differs from drive to drive: scaling of the position and behaviour of the latch inputs."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from kernel.clock import US, TimeNs
from kernel.errors import UserError

LATCH_MODES = ("interpolated", "sampled")


@dataclass(frozen=True)
class DriveProfile:
    """Parameters of a drive model; the defaults are a usual servo on a ball screw.

    encoder_increments: increments per motor revolution (20 bit).
    lead_um: travel of the load per motor revolution.
    position_factor: position units of the bus per increment; 1 = the bus speaks increments.
    input_delay_ns: time from an edge at the terminal to the latch behind the input circuit.
    input_filter_ns: how long a level must stay to count; the latch waits for it, and a shorter
        pulse gives neither latch nor level.
    latch_mode: "interpolated" = the position at the latch instant; "sampled" = the position of
        the last encoder sample before it, `grid_ns` apart.
    Raises UserError for a value that cannot be.
    """

    encoder_increments: int = 1 << 20
    lead_um: int = 10_000
    position_factor: Fraction = Fraction(1)
    input_delay_ns: TimeNs = 4 * US
    input_filter_ns: TimeNs = 0
    latch_mode: Literal["interpolated", "sampled"] = "interpolated"
    grid_ns: TimeNs = 62_500

    def __post_init__(self) -> None:
        for name in ("encoder_increments", "lead_um", "position_factor", "grid_ns"):
            if getattr(self, name) <= 0:
                raise _refused(name, getattr(self, name), "a value above 0")
        for name in ("input_delay_ns", "input_filter_ns"):
            if getattr(self, name) < 0:
                raise _refused(name, getattr(self, name), "0 or more")
        if self.latch_mode not in LATCH_MODES:
            raise _refused("latch_mode", self.latch_mode, ", ".join(LATCH_MODES))
        if (self.encoder_increments * self.position_factor).denominator != 1:
            raise _refused(
                "position_factor", self.position_factor, "whole position units per revolution"
            )

    @property
    def increments_per_mm(self) -> Fraction:
        """Encoder increments per millimetre of the load, exact."""
        return Fraction(self.encoder_increments * 1000, self.lead_um)

    @property
    def units_per_mm(self) -> Fraction:
        """Position units of the bus (607A, 6064, 60BA ...) per millimetre of the load, exact."""
        return self.increments_per_mm * self.position_factor

    @property
    def units_per_revolution(self) -> int:
        """Feed constant 6092:1: position units per revolution."""
        return int(self.encoder_increments * self.position_factor)

    def latch_position_ns(self, latch_ns: TimeNs) -> TimeNs:
        """Return the instant whose position an edge with this latch instant stores."""
        if self.latch_mode == "sampled":
            return latch_ns - latch_ns % self.grid_ns
        return latch_ns


class Scaling:
    """Metres to position units of the bus and back, as the drive computes it.

    The encoder quantises first (increments), then the position factor is applied. A position
    beyond 32 bits wraps as the object does.
    Source: CiA 402-2, position = increments * feed / (encoder resolution * gear ratio).
    """

    __slots__ = ("_factor", "_increments_per_m", "_units_per_m")

    def __init__(self, profile: DriveProfile) -> None:
        self._increments_per_m = float(profile.increments_per_mm * 1000)
        self._units_per_m = float(profile.units_per_mm * 1000)
        factor = profile.position_factor
        self._factor = None if factor == 1 else factor

    def position_units(self, position_m: float) -> int:
        """Return a position as the encoder and the bus tell it."""
        units = round(position_m * self._increments_per_m)
        if self._factor is not None:
            units = round(units * self._factor)
        return (units + 0x8000_0000 & 0xFFFF_FFFF) - 0x8000_0000

    def velocity_units_s(self, velocity_m_s: float) -> int:
        """Return a velocity in position units per second, limited to 32 bits."""
        return limit_i32(round(velocity_m_s * self._units_per_m))

    def deviation_units(self, deviation_m: float) -> int:
        """Return a difference of positions in position units, limited to 32 bits."""
        return limit_i32(round(deviation_m * self._units_per_m))

    def position_m(self, units: int) -> float:
        """Return the position that position units of the bus stand for."""
        return units / self._units_per_m


def limit_i32(value: int) -> int:
    """Limit to the range of INTEGER32."""
    return max(-0x8000_0000, min(value, 0x7FFF_FFFF))


def _refused(name: str, value: object, allowed: str) -> UserError:
    return UserError(f"drive profile: {name} cannot have this value", value=value, allowed=allowed)
