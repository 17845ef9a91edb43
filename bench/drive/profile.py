"""What differs from drive to drive: scaling of the position and behaviour of the latch inputs."""

import re
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import cached_property
from typing import Literal

from kernel.clock import US, TimeNs
from kernel.errors import UserError

LATCH_MODES = ("interpolated", "linear", "sampled")
CLOCK_NS = {"ns": 1, "us": 1000}


@dataclass(frozen=True)
class DriveProfile:
    """Parameters of a drive model; the defaults are a usual servo on a ball screw.

    encoder_increments: increments per motor revolution (20 bit).
    lead_um: travel of the load per motor revolution.
    position_factor: position units of the bus per increment; 1 = the bus speaks increments.
    input_delay_ns: time from an edge at the terminal to the latch behind the input circuit.
    input_jitter_ns: largest further delay, drawn for each edge.
    input_filter_ns: how long a level must stay to count; the latch waits for it, and a shorter
        pulse gives neither latch nor level.
    min_pulse_ns: a shorter pulse gives neither, but the latch does not wait for it.
    latch_mode: "interpolated" = the position at the latch instant; "linear" = on the line between
        the encoder samples before and after it, `grid_ns` apart; "sampled" = the sample before.
    lacks: objects that the drive does not have, `60D1` or `60D0.2`.
    The other fields stand in `profiles.csv` with their meaning.
    Raises UserError for a value that cannot be.
    """

    encoder_increments: int = 1 << 20
    lead_um: int = 10_000
    position_factor: Fraction = Fraction(1)
    input_delay_ns: TimeNs = 4 * US
    input_jitter_ns: TimeNs = 0
    input_filter_ns: TimeNs = 0
    min_pulse_ns: TimeNs = 0
    dead_time_ns: TimeNs = 0
    delay_compensation_ns: TimeNs = 0
    latch_mode: Literal["interpolated", "linear", "sampled"] = "interpolated"
    grid_ns: TimeNs = 62_500
    latch_bits: int = 64
    latch_encoder: Literal["motor", "second", "function_bit"] = "motor"
    index_angle_deg: float = 0.0
    index_edges: Literal["both", "positive"] = "both"
    rearm: Literal["edge", "enable", "zero_first"] = "edge"
    probe_edges: Literal["both", "one"] = "both"
    source_bits: Literal["used", "ignored"] = "used"
    trigger_sources: str = "1 2 5 6"
    source_1: int = 1
    source_2: int = 2
    source_type: Literal["I16", "U16"] = "I16"
    toggle_bits: bool = False
    counters_cleared_on_disarm: bool = False
    timestamp_unit: Literal["ns", "us"] = "ns"
    timestamp_start: int = 0
    sampling: Literal["after_rpdo", "before_rpdo"] = "after_rpdo"
    status_delay_cycles: int = 0
    value_delay_cycles: int = 0
    homing: Literal["independent", "probe_1_off", "off", "clears"] = "independent"
    lacks: str = ""

    def __post_init__(self) -> None:
        for name in ("encoder_increments", "lead_um", "position_factor", "grid_ns"):
            if getattr(self, name) <= 0:
                raise _refused(name, getattr(self, name), "a value above 0")
        for field in fields(self):
            if field.name.endswith("_ns") and getattr(self, field.name) < 0:
                raise _refused(field.name, getattr(self, field.name), "0 or more")
        if self.latch_mode not in LATCH_MODES:
            raise _refused("latch_mode", self.latch_mode, ", ".join(LATCH_MODES))
        if (self.encoder_increments * self.position_factor).denominator != 1:
            raise _refused(
                "position_factor", self.position_factor, "whole position units per revolution"
            )
        if not re.fullmatch(r"(-?\d+( -?\d+)*)?", self.trigger_sources):
            raise _refused("trigger_sources", self.trigger_sources, "numbers such as 1 2 5 6")
        if not re.fullmatch(r"([0-9A-Fa-f]{4}(\.\d+)?( |$))*", self.lacks):
            raise _refused("lacks", self.lacks, "objects such as 60D1 60D0.2")

    @cached_property
    def missing_objects(self) -> frozenset[tuple[int, int | None]]:
        """Index and sub-index of what `lacks` names; sub-index None for a whole object."""
        parts = [name.partition(".") for name in self.lacks.split()]
        return frozenset((int(index, 16), int(sub) if dot else None) for index, dot, sub in parts)

    @cached_property
    def source_values(self) -> frozenset[int]:
        """Values that 60D0 takes."""
        return frozenset(int(word) for word in self.trigger_sources.split())

    def has_object(self, index: int, sub: int = 0) -> bool:
        """Whether the drive has an object (that is not in `lacks`)."""
        missing = self.missing_objects
        return not missing or ((index, None) not in missing and (index, sub) not in missing)

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

    @property
    def latch_window_ns(self) -> tuple[TimeNs, TimeNs]:
        """How long before and after an edge the positions may lie that its latch is made of."""
        delay_ns = self.input_delay_ns + self.input_filter_ns
        grid_ns = 0 if self.latch_mode == "interpolated" else self.grid_ns
        ahead_ns = self.grid_ns if self.latch_mode == "linear" else 0
        before_ns = grid_ns + self.delay_compensation_ns - delay_ns
        return max(0, before_ns), delay_ns + self.input_jitter_ns + ahead_ns


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
