"""Single bits of images of drives that only take a speed, and values in what refuses a rig."""

from dataclasses import replace
from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis
from tests.speed_drive.ends import FAMILIES, SETTINGS
from tests.speed_drive.test_speed_drive_machine import settings_of

from axisrig.bench.drive.speed_drive.node import SpeedDriveNode
from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.speed_drive.latch import LatchControl
from axisrig.kernel.errors import UserError
from axisrig.kernel.profiles.conventional import words as of_card
from axisrig.kernel.profiles.encoder_terminal import words as of_terminal
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

LEVEL = {"conventional": of_card.LEVEL, "encoder_terminal": of_terminal.LEVEL}
OTHERS = {"conventional": 0xFF & ~of_card.LEVEL, "encoder_terminal": 0xFF & ~of_terminal.LEVEL}
PLACE = {"conventional": "COUNTER", "lightbus": "POSITION", "encoder_terminal": "COUNTER"}
ENABLED: dict[str, tuple[dict[str, int], tuple[bool, ...]]] = {
    "conventional": ({"ENABLE": 3}, (True, False)),
    "encoder_terminal": ({"CONTROL": of_terminal.EN_LAT_EXT}, (True,)),
}


@pytest.mark.parametrize("edge", ["POS", "NEG"])
@pytest.mark.parametrize("family", LEVEL)
def test_the_level_is_one_bit_of_each_image_and_none_of_the_others(family: str, edge: str) -> None:
    """Off, on, off: the probe is actuated at the level behind its edge."""
    port = ImagePort()
    link = FAMILIES[family].link(replace(SETTINGS, echo_cycles=1), port, lambda: 0)
    link.choose_latch(1, edge)
    assert link.is_actuated is None  # no image has come yet
    found = []
    for status in (0, LEVEL[family], OTHERS[family], 0xFF, 0):
        port.receive(FAMILIES[family].images[1].packed({"STATUS": status}))
        link.take()
        found.append(link.is_actuated)
    at_high = [False, True, False, True, False]
    assert found == [level is (edge == "POS") for level in at_high]


@pytest.mark.parametrize("family", ENABLED)
def test_an_image_without_values_enables_no_latch(family: str) -> None:
    """As those of a drive whose images stay out; a latch that was on goes off."""
    on, edges = ENABLED[family]
    unit = FAMILIES[family].unit()
    unit.reset(0)
    for nothing in ({}, dict.fromkeys(on, 0)):
        unit.command(nothing, 0)
        assert unit.edges() == ()
        unit.command(on, 0)
        assert unit.edges() == edges
        unit.command(nothing, 0)
        assert unit.edges() == ()


def test_a_lightbus_drive_reads_nothing_that_no_image_asks_for() -> None:
    """A stored value is shown while its bit to read is there, and not after images stay out."""
    unit = FAMILIES["lightbus"].unit()
    for edge in (True, False):
        unit.pulse(edge, 1 << 20)
    for values, is_shown in (({}, False), ({"READ": 3}, True), ({}, False)):
        unit.command(values, 0)
        assert bool(unit.inputs(0, level=False)["SHOWN"]) is is_shown


@pytest.mark.parametrize("is_there", [True, False])
def test_only_an_edge_of_cnt_set_sets_the_counter_of_a_terminal(is_there: bool) -> None:
    """A bit that is there when power comes is no edge; the counter counts from 0 at power on."""
    unit = FAMILIES["encoder_terminal"].unit()
    unit.reset(700)
    assert unit.inputs(707, level=False)["COUNTER"] == 7
    if not is_there:
        unit.command({}, 700)
    unit.command({"CONTROL": of_terminal.CNT_SET, "SET": 5000}, 700)
    shown = unit.inputs(707, level=False)
    assert shown["COUNTER"] == (7 if is_there else 5007)
    assert bool(shown["STATUS"] & of_terminal.CNTSET_ACC) is not is_there


@pytest.mark.parametrize("family", FAMILIES)
def test_a_drive_that_gets_power_shows_its_place_before_its_first_cycle(family: str) -> None:
    """Also the second time, and with the scaling that was written in between."""
    made, clock = FAMILIES[family], new_scheduler()
    axis = FakeAxis(motion=lambda time_s: 0.05 + time_s)
    to_drive, from_drive = made.images
    node: Any = SpeedDriveNode(
        "Z", clock, axis, (None, None), made.table.make(), (to_drive, from_drive), made.unit()
    )
    assert node.inputs == b""
    clock.run_until(0)
    per_m = 1000 * float(made.table.per_mm)

    def place() -> int:
        return int(from_drive.values_of(node.inputs)[PLACE[family]])

    first = round(0.05 * per_m)
    assert place() == (0 if family == "encoder_terminal" else first)
    node.power_off()
    clock.run_until(20 * MS)
    node.power_on()
    again = round((0.05 + 0.02) * per_m)
    assert place() == (0 if family == "encoder_terminal" else again)


@pytest.mark.parametrize("echo", [1, 2, 5])
def test_a_latch_is_clear_with_the_first_image_that_was_made_after_the_first_request(
    echo: int,
) -> None:
    """`echo_cycles` images after it; what came before says nothing, also after it was off."""
    control = LatchControl(echo)
    for _ in range(2):
        for number in range(1, echo + 3):
            control.take(None, 0, 0)
            assert control.is_clear is (number >= echo)
        control.arm()
        for _ in range(echo):
            control.take(None, 0, 0)
        assert control.is_armed
        control.disarm()
        assert not control.is_clear


@pytest.mark.parametrize(
    ("family", "key"),
    [
        ("conventional", "rpm_at_10v"),
        ("lightbus", "rpm_at_full"),
        ("encoder-terminal", "rpm_at_10v"),
    ],
)
@pytest.mark.parametrize(("rpm", "share"), [(1500, "0.5"), (6000, "2")])
def test_a_speed_of_the_list_that_is_not_that_of_the_drive_is_refused_with_its_counts(
    family: str, key: str, rpm: int, share: str
) -> None:
    """A list for 3000 rpm: as many counts at the full speed of the rig, of 32767."""
    with pytest.raises(UserError) as caught:
        settings_of(family, f"drive:servo.{key}={rpm}")
    error = caught.value
    assert f"{rpm / 6:g} mm/s at the full output" in str(error)  # a screw of 10 mm
    assert f"wrong by a factor of {share} (" in str(error)
    assert error.value == f"{32767 * rpm / 3000:.6g} counts"
    assert error.allowed == "32767 counts, to less than one"


def test_an_instant_that_does_not_fit_is_refused_with_what_it_may_be() -> None:
    """In microseconds, as the keys are."""
    found = {}
    for change in ("bus:bus.bus_us=700", "bus:bus.output_us=50", "bus:bus.output_us=1000"):
        with pytest.raises(UserError) as caught:
            settings_of(
                "lightbus", *((change,) if "bus_us" in change else ("bus:bus.bus_us=60.5", change))
            )
        found[change.partition(".")[2]] = caught.value.value, caught.value.allowed
    assert found == {
        "bus_us=700": (700.0, "cycle_offset_us at most: the control reads then"),
        "output_us=50": (50.0, "bus_us = 60.5 or more"),
        "output_us=1000": (1000.0, "less than period_us"),
    }
