"""How the touch probe unit of a drive is put together."""

from bench.drive.application.index_pulse import IndexPulse
from bench.drive.application.latch_position import LatchPosition
from bench.drive.application.touch_probe import (
    HARDWARE_INDEX,
    SOFTWARE_INDEX,
    Encoders,
    TouchProbe,
)
from bench.drive.application.units import Units
from bench.drive.image import ProcessImage
from bench.drive.ports import AxisPort, SignalPort
from bench.drive.profile import DriveProfile


def make_touch_probe(
    axis: AxisPort,
    signals: tuple[SignalPort | None, SignalPort | None],
    profile: DriveProfile,
    scaling: Units,
    image: ProcessImage,
    seed: int,
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
    return TouchProbe(signals, profile, Encoders(motor, second), image, pulses, seed)
