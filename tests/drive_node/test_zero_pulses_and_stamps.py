"""The places of the two zero pulses, and the clock of a drive in the stamps of its probes."""

from typing import Any

import pytest
from tests.drive_node.servo_alone import PER_M, ServoAlone

from axisrig.bench.drive.axis.latch_position import LatchPosition
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.touch_probe import Encoders, TouchProbe

POSITIVE_BY_OBJECT, POSITIVE = 0x0019, 0x0011
LEAD_M = 0.01


@pytest.mark.parametrize("angle_deg", [0.0, 90.0, 270.0])
@pytest.mark.parametrize("source", [5, 6])
def test_the_zero_pulse_of_the_software_is_at_0_whatever_the_angle_of_the_encoder(
    fake_axis: Any, source: int, angle_deg: float
) -> None:
    """60D0: 5 is the mark of the encoder, 6 that of the software; 0.5 m/s upwards."""
    axis = fake_axis(motion=lambda time_s: -0.0005 + 0.5 * time_s)
    profile = DriveProfile(index_angle_deg=angle_deg)
    one = ServoAlone(axis, profile=profile)
    one.write(source_1=source)
    for _ in range(30):
        one.cycle(probe_function=POSITIVE_BY_OBJECT)
    place_m = LEAD_M if source == 6 or not angle_deg else LEAD_M * angle_deg / 360
    assert one.image.latch_1_positive == pytest.approx(place_m * PER_M, abs=1)


class Edge:
    edges = ((1500, True),)
    level = False


@pytest.mark.parametrize("delay_ns", [0, 70, 400])
@pytest.mark.parametrize("ahead_ns", [None, 0, 5000, -300])
def test_a_stamp_is_of_the_latch_by_the_clock_of_the_drive(
    delay_ns: int, ahead_ns: int | None
) -> None:
    """Of the latch, not of the edge: the input circuit delays it."""
    profile = DriveProfile(input_delay_ns=delay_ns)
    image = ProcessImage()
    clock = None if ahead_ns is None else lambda time_ns: time_ns + ahead_ns
    encoders = Encoders(LatchPosition(profile, lambda time_ns: time_ns))
    unit = TouchProbe((Edge(), None), profile, encoders, image, {}, 0, clock)  # type: ignore[arg-type]
    unit.take_edges(1000)
    unit.set_function(POSITIVE, 1000)
    unit.take_edges(3000)
    latch = unit.probes[0].latches[True]
    assert latch.stamp == 1500 + delay_ns + (ahead_ns or 0)
    assert latch.instant_ns == 1500 + delay_ns
