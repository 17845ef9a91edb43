"""The process image of a drive: every object value that changes while it runs.

Kept in plain attributes so that a cycle writes no object dictionary; SDO and PDOs read and write
them by the names in the column `value` of the object tables.
"""

from dataclasses import dataclass
from functools import lru_cache

from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile


@dataclass(slots=True)
class DeviceImage:
    """What the process image of any device has: the error register 1001."""

    error_register: int = 0


@dataclass(slots=True)
class ProcessImage(DeviceImage):
    """Object values as they are on the bus (integers in the units of the object tables)."""

    sync_cob_id: int = 0
    sync_period_us: int = 0
    abort_option: int = 0
    error_code: int = 0
    controlword: int = 0
    statusword: int = 0
    quick_stop_option: int = 0
    shutdown_option: int = 0
    disable_option: int = 0
    halt_option: int = 0
    fault_option: int = 0
    mode: int = 0
    mode_display: int = 0
    position_demand: int = 0
    position_internal: int = 0
    position_actual: int = 0
    following_window: int = 0
    following_timeout_ms: int = 0
    position_window: int = 0
    position_window_ms: int = 0
    velocity_actual: int = 0
    velocity_window: int = 0
    velocity_window_ms: int = 0
    velocity_threshold: int = 0
    velocity_threshold_ms: int = 0
    target_torque: int = 0
    max_torque: int = 0
    torque_actual: int = 0
    current_actual: int = 0
    target_position: int = 0
    home_offset: int = 0
    software_limit_min: int = 0
    software_limit_max: int = 0
    max_profile_velocity: int = 0
    max_motor_speed: int = 0
    profile_velocity: int = 0
    profile_acceleration: int = 0
    profile_deceleration: int = 0
    quick_stop_deceleration: int = 0
    profile_type: int = 0
    encoder_increments: int = 0
    encoder_revolutions: int = 0
    gear_motor: int = 0
    gear_shaft: int = 0
    feed: int = 0
    feed_shaft: int = 0
    homing_method: int = 0
    homing_speed_switch: int = 0
    homing_speed_zero: int = 0
    homing_acceleration: int = 0
    position_offset: int = 0
    velocity_offset: int = 0
    torque_offset: int = 0
    probe_function: int = 0
    probe_status: int = 0
    latch_1_positive: int = 0
    latch_1_negative: int = 0
    latch_2_positive: int = 0
    latch_2_negative: int = 0
    interpolation_value: int = 0
    interpolation_index: int = 0
    max_acceleration: int = 0
    max_deceleration: int = 0
    source_1: int = 0
    source_2: int = 0
    stamp_1_positive: int = 0
    stamp_1_negative: int = 0
    stamp_2_positive: int = 0
    stamp_2_negative: int = 0
    count_1_positive: int = 0
    count_1_negative: int = 0
    count_2_positive: int = 0
    count_2_negative: int = 0
    positive_torque_limit: int = 0
    negative_torque_limit: int = 0
    second_position: int = 0
    second_increments: int = 0
    second_revolutions: int = 0
    following_error: int = 0
    position_demand_internal: int = 0
    digital_inputs: int = 0
    target_velocity: int = 0
    supported_modes: int = 0

    def set_defaults(self, profile: DriveProfile) -> None:
        """Give every value the default of table and profile."""
        for name, value in _defaults(profile):
            setattr(self, name, value)


class PowerOnValues:
    """What the process image of a drive has at power on. own: values beside those of the tables."""

    def __init__(self, profile: DriveProfile) -> None:
        self._profile = profile
        self.own: dict[str, int] = {}

    def apply(self, image: ProcessImage) -> None:
        """Give every value what it has at power on."""
        image.set_defaults(self._profile)
        for name, value in self.own.items():
            setattr(image, name, value)


# A drive asks at every start, and the next run has the same drives
@lru_cache(maxsize=64)
def _defaults(profile: DriveProfile) -> tuple[tuple[str, int], ...]:
    """Return name and default of every value, in the order of the tables."""
    named = profile.object_defaults
    return tuple(
        (row.value, int(row.default.format(**named), 0))
        for row in variables().values()
        if row.value
    )
