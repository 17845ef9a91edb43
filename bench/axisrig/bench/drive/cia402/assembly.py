"""How the parts of a drive are put together."""

from collections.abc import Callable, Mapping

from axisrig.bench.drive.axis.index_pulse import IndexPulse
from axisrig.bench.drive.axis.latch_position import LatchPosition
from axisrig.bench.drive.axis.motion import Motion
from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.drive.axis.switches import Switches
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.interpolation import InterpolationTime
from axisrig.bench.drive.cia402.functions.limits import Limits
from axisrig.bench.drive.cia402.functions.stop import Standstill
from axisrig.bench.drive.cia402.functions.touch_probe import (
    HARDWARE_INDEX,
    SOFTWARE_INDEX,
    Encoders,
    TouchProbe,
)
from axisrig.bench.drive.cia402.functions.units import Units
from axisrig.bench.drive.cia402.modes.base import Parts
from axisrig.kernel.time.clock import TimeNs

Signals = tuple[SignalPort | None, SignalPort | None]


def make_parts(
    axis: AxisPort,
    profile: DriveProfile,
    image: ProcessImage,
    signals: Signals,
    switches: Mapping[str, SignalPort],
    seed: int,
    device_time: Callable[[TimeNs], int] | None = None,
) -> Parts:
    """Make what the modes of a drive work with; arguments as those of `Servo`."""
    units = Units(profile, image)
    limits = Limits(axis, profile, image, units)
    motion = Motion(axis)

    def set_home(home_m: float) -> None:
        # The zero is 607C from home (CiA 402-2); in drives of the other habit home gets 607C
        offset = image.home_offset
        units.set_home(home_m, -offset if profile.home_offset == "zero" else offset)
        limits.update()

    return Parts(
        image,
        units,
        limits,
        motion,
        Standstill(image, units, motion),
        profile.tick_ns,
        Switches(switches, profile, seed),
        IndexPulse(profile, axis.motor_position_m_at),
        _touch_probe(axis, signals, profile, units, image, seed, device_time),
        set_home,
        profile.homing_torque,
        profile.homing_stop_ms,
        InterpolationTime(image),
        profile.velocity_demand == "held",
        profile.homing_bit_10,
    )


def _touch_probe(
    axis: AxisPort,
    signals: Signals,
    profile: DriveProfile,
    scaling: Units,
    image: ProcessImage,
    seed: int,
    device_time: Callable[[TimeNs], int] | None,
) -> TouchProbe:
    """Make the touch probe unit on the encoders of an axis."""
    position_m_at = axis.motor_position_m_at
    motor = LatchPosition(profile, lambda time_ns: scaling.position_units(position_m_at(time_ns)))
    second = None
    if profile.latch_encoder != "motor" and axis.second_encoder_m() is not None:
        second_m_at = axis.second_encoder_m_at
        second = LatchPosition(
            profile, lambda time_ns: scaling.position_units(second_m_at(time_ns))
        )
    pulses = {
        HARDWARE_INDEX: IndexPulse(profile, position_m_at),
        SOFTWARE_INDEX: IndexPulse(profile, position_m_at, angle_deg=0.0),
    }
    return TouchProbe(signals, profile, Encoders(motor, second), image, pulses, seed, device_time)
