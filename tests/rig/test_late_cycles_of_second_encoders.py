"""By how many cycles the carrier of an axis makes its second encoder see set positions later."""

from collections.abc import Callable

import pytest
from tests.rig.conftest import RIGS

from axisrig.bench.rig.distance.sensors import late_of, sensors_of
from axisrig.bench.rig.settings import Settings

Read = Callable[..., Settings]
RELEASED = "set:X.lr_param.distance_control_on=1"
VARIABLE = '[plc]\n"V.E.SENSOR" = { sensor = "gap", sign = -1 }'
X_ON_CAN = f"""
[segment.can1]
[axis.X]
list = "{(RIGS / "lists" / "axis-x.lst").as_posix()}"
segment = "can1"
node = 1
drive = "{{drive}}"
plant = "x"
encoder_2 = "wall"
[plant.x]
fmu = "AxisRig.Drives.KinematicAxis"
[plant.wall]
fmu = "AxisRig.Sensors.DistanceSensor"
wire = {{{{ x = "x" }}}}
"""


@pytest.mark.parametrize(
    ("base", "late"),
    [("distance-z.toml", 0), ("distance-z-ethercat.toml", 1), ("distance-z-sercos.toml", 1)],
)
def test_a_second_encoder_is_as_late_as_the_images_of_its_carrier(
    rig_above: Read, base: str, late: int
) -> None:
    """One frame for both ways: a drive that samples at SYNC0 is one cycle further than on CAN."""
    settings = rig_above(base, VARIABLE)
    second, variable = sensors_of(settings, "Z")
    assert (second.late, variable.late) == (late, late)
    assert late_of(settings, ["Z"]) == (late, 0)
    # It comes with 6064; the PLC reads what is fresh
    assert (second.age, variable.age) == (0, -late)


@pytest.mark.parametrize(
    ("input_us", "output_us", "late", "fresh"),
    [
        # Set values of cycle k act at k + 1 + T_O, and the axis is there one period later
        (0, 0, 0, 0),  # at k + 2; the sample is of then
        (200, 500, 0, 0),  # moves from k + 1.5 on; sampled at k + 1.8, read at k + 2.6
        (0, 900, 0, 1),  # moves from k + 1.9 on: 6064 shows it at k + 2, it is there at k + 2.9
        (200, 900, 1, 1),  # the sample at k + 1.8 is too early, the next one is read at k + 3.6
    ],
)
def test_instants_of_images_say_by_how_much(
    rig_above: Read, input_us: int, output_us: int, late: int, fresh: int
) -> None:
    """What comes in the telegram is late by the samples, the way of the PLC by the outputs."""
    keys = f"[segment.bus]\ninput_us = {input_us}\noutput_us = {output_us}\n"
    settings = rig_above("distance-z-profidrive.toml", keys + VARIABLE)
    second, variable = sensors_of(settings, "Z")
    assert late_of(settings, ["Z"]) == (late, fresh)
    assert (second.late, variable.late) == (late, late)
    assert (second.age, variable.age) == (0, fresh - late)


def test_each_axis_has_the_delay_of_its_own_carrier(rig_above: Read) -> None:
    """X is on CAN, Z on EtherCAT; of both the later one counts."""
    settings = rig_above("distance-z-ethercat.toml", X_ON_CAN.format(drive="servo"), RELEASED)
    late = {name: late_of(settings, [name]) for name in "XZ"}
    assert late == {"X": (0, 0), "Z": (1, 0)}
    assert late_of(settings, ["X", "Z"]) == late_of(settings, ["Z", "X"]) == (1, 0)
    assert {name: sensors_of(settings, name)[0].late for name in "XZ"} == {"X": 0, "Z": 1}


def test_of_two_axes_the_later_outputs_count(rig_above: Read) -> None:
    text = "[segment.bus]\noutput_us = 900\n[drive.other]\n" + X_ON_CAN.format(drive="other")
    settings = rig_above("distance-z-profidrive.toml", text)
    assert [late_of(settings, [name]) for name in "XZ"] == [(0, 0), (0, 1)]
    assert late_of(settings, ["X", "Z"]) == late_of(settings, ["Z", "X"]) == (0, 1)
    assert late_of(settings, []) == (0, 0)


@pytest.mark.parametrize("delay", [0, 1, 3])
@pytest.mark.parametrize(
    ("base", "late"), [("distance-z.toml", 0), ("distance-z-ethercat.toml", 1)]
)
def test_a_drive_may_give_its_second_encoder_later(
    rig_above: Read, base: str, late: int, delay: int
) -> None:
    """It is older than 6064 then; what the PLC reads comes another way."""
    text = f"[drive.servo]\nsecond_delay_cycles = {delay}\n{VARIABLE}"
    second, variable = sensors_of(rig_above(base, text), "Z")
    assert (second.age, second.late) == (delay, late)
    assert variable.age == -late
