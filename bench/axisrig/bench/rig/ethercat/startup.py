"""How the drives of an EtherCAT line are started: the keys of `[drive.D]` that count there."""

from fractions import Fraction

from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.canopen.startup import drive_dictionary, start_up_settings
from axisrig.bench.rig.ethercat.members import axis_telegrams, position_of
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.canopen.startup_steps import Scaling, Step, object_steps

CAN_ONLY = {
    "heartbeat_ms": "there is no heartbeat: the states of the slaves are asked for in each cycle",
    "consumer_ms": "there is no heartbeat: the watchdog of the outputs is in its place",
    "guard_time_ms": "there is no node guarding: the states are asked for in each cycle",
    "heartbeat_timeout_ms": "there is no heartbeat",
    "sync_window_us": "there is no SYNC message: set values count with SYNC0",
    "rpdo_timeout_ms": "the watchdog of the outputs is in the place of time-outs of RPDOs",
}
"""Keys of `[drive.D]` that are about CAN alone, and what there is on EtherCAT."""
BOOT_ONLY = ("reset_communication",)
"""Ways to pre-operational that the default of the key names; others are about NMT."""


@once
def axis_steps(settings: Settings, name: str) -> tuple[Step, ...]:
    """Return what is asked of the drive of an axis, and written to it, over SDO.

    Raises UserError for what the drive cannot do by its EDS.
    """
    keys, position = drive_of(settings, name), position_of(settings, name)
    profile = keys.make()
    return object_steps(
        start_up_settings(keys),
        settings.rig.cycle.period_us,
        axis_telegrams(settings, name),
        Scaling(profile.encoder_increments, Fraction(profile.units_per_revolution)),
        drive_dictionary(keys, position, profile),
    )
