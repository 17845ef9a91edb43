"""What differs from drive to drive: scaling of the position and behaviour of the latch inputs."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import cached_property
from typing import Literal

from axisrig.bench.drive.axis.habits import LATCH_MODES, AxisHabits
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import US, TimeNs

OPTION_DEFAULTS = {0x605A: 2, 0x605B: 0, 0x605C: 1, 0x605D: 1, 0x605E: 2}  # CiA 402-2
_OPTION_VALUES = "|".join(
    f"{name}:[{values}](,[{values}])*"
    for name, values in (("605A", "0-8"), ("605[BC]", "01"), ("605D", "1-4"), ("605E", "0-4"))
)
CLOCK_NS = {"ns": 1, "us": 1000}


@dataclass(frozen=True)
class DriveProfile(AxisHabits):
    """Parameters of a drive model; the defaults are a usual servo on a ball screw.

    position_factor: position units of the bus per increment; 1 = the bus speaks increments.
    option_codes: values that option codes take, `605A:2,6`, the first one at power on.
    lacks: objects that the drive does not have, `60D1` or `60D0.2`.
    The other fields are in `profiles.csv` with their meaning.
    Raises UserError for a value that cannot be.
    """

    position_factor: Fraction = Fraction(1)
    dead_time_ns: TimeNs = 0
    latch_encoder: Literal["motor", "second", "function_bit"] = "motor"
    index_edges: Literal["both", "positive"] = "both"
    rearm: Literal["edge", "enable", "zero_first"] = "edge"
    probe_edges: Literal["both", "one"] = "both"
    source_bits: Literal["used", "ignored"] = "used"
    probe_function: int = 0
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
    second_delay_cycles: int = 0
    homing: Literal["independent", "probe_1_off", "off", "clears"] = "independent"
    home_offset: Literal["zero", "value"] = "zero"
    homing_torque: int = 500
    homing_stop_ms: int = 100
    option_codes: str = ""
    lacks: str = ""
    fixed_pdos: bool = False
    tick_ns: TimeNs = 250 * US
    rated_torque_mnm: int = 2200
    rated_current_ma: int = 4490
    sync_loss_periods: int = 0
    sdo_answer_ns: TimeNs = 0
    velocity_demand: Literal["interpolated", "held"] = "interpolated"
    mode_change: Literal["always", "not_halted"] = "always"
    homing_bit_10: bool = True
    boot_up: Literal["always", "power_on"] = "always"
    first_heartbeat_ns: TimeNs = 0

    def __post_init__(self) -> None:
        for name in (
            "encoder_increments",
            "lead_um",
            "position_factor",
            "grid_ns",
            "tick_ns",
            "rated_torque_mnm",
            "rated_current_ma",
        ):
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
        self._check_sources()
        if not re.fullmatch(rf"(({_OPTION_VALUES})( |$))*", self.option_codes):
            raise _refused("option_codes", self.option_codes, "codes such as 605A:2,6 605E:2,0")
        if not re.fullmatch(r"([0-9A-Fa-f]{4}(\.\d+)?( |$))*", self.lacks):
            raise _refused("lacks", self.lacks, "objects such as 60D1 60D0.2")

    def _check_sources(self) -> None:
        """Refuse sources that 60D0 cannot hold."""
        low, high = (-0x8000, 0x7FFF) if self.source_type == "I16" else (0, 0xFFFF)
        if not all(low <= value <= high for value in self.source_values):
            raise _refused("trigger_sources", self.trigger_sources, f"{low} to {high}")
        for name in ("source_1", "source_2"):
            if not low <= getattr(self, name) <= high:
                raise _refused(name, getattr(self, name), f"{low} to {high}")

    @cached_property
    def option_values(self) -> Mapping[int, tuple[int, ...]]:
        """Values of the option codes that do not take all of them, by index."""
        parts = [name.partition(":") for name in self.option_codes.split()]
        return {int(index, 16): tuple(map(int, codes.split(","))) for index, _, codes in parts}

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
    def units_per_mm(self) -> Fraction:
        """Position units of the bus (607A, 6064, 60BA ...) per millimetre of the load, exact."""
        return self.increments_per_mm * self.position_factor

    @property
    def units_per_revolution(self) -> int:
        """Feed constant 6092:1: position units per revolution."""
        return int(self.encoder_increments * self.position_factor)

    @property
    def rated_force_n(self) -> float:
        """Force at the load at rated torque: 2 pi M / lead (N; N.m for a rotary axis)."""
        return 2.0 * math.pi * self.rated_torque_mnm * 1e3 / self.lead_um

    @cached_property
    def object_defaults(self) -> Mapping[str, int]:
        """Defaults of the objects that follow from the profile, by their names in the table."""
        per_mm = self.units_per_mm

        def units(millimetres: Fraction | int, most: int = 0xFFFF_FFFF) -> int:
            return max(1, min(round(millimetres * per_mm), most))

        return {
            "encoder_increments": self.encoder_increments,
            "units_per_revolution": self.units_per_revolution,
            "rated_torque_mnm": self.rated_torque_mnm,
            "rated_current_ma": self.rated_current_ma,
            "probe_function": self.probe_function,
            "source_1": self.source_1,
            "source_2": self.source_2,
            "position_window": units(Fraction(1, 100)),
            "velocity_window": units(Fraction(1, 2), 0xFFFF),
            "profile_velocity": units(100),
            "profile_acceleration": units(1000),
            "homing_speed": units(20),
            "homing_speed_zero": units(2),
            "quick_stop_deceleration": units(5000),
            **{
                f"option_{index:X}": self.option_values.get(index, (usual,))[0]
                for index, usual in OPTION_DEFAULTS.items()
            },
        }


def _refused(name: str, value: object, allowed: str) -> UserError:
    return UserError(f"drive profile: {name} cannot have this value", value=value, allowed=allowed)
