"""Loops of drives whose images are swapped: who closes them, their dead time, what is refused."""

import math
import re
from collections.abc import Callable

import pytest

from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.cnc_objects import objects_table
from axisrig.bench.rig.cyclic.family import FAMILY
from axisrig.bench.rig.profidrive.loop import (
    gain_of,
    loop_settings,
    period_and_dead,
    uses_dsc,
    wrong_mode,
)
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.distance.objects import objects
from axisrig.kernel.errors import UserError

Read = Callable[..., Settings]
DSC, CNC, DRIVE = "DSC_POSITION_CONTROL", "CNC_POSITION_CONTROL", "DRIVE_POSITION_CONTROL"
MODE = "set:Z.antr.operation_mode="


def held_limit(dead: float) -> float:
    """Kv T at which a loop with held set speeds rings: 2 sin(pi/(2 (2 n + 1)))."""
    return 2.0 * math.sin(math.pi / (2.0 * (2.0 * dead + 1.0)))


@pytest.mark.parametrize(
    ("telegram", "mode", "alarm", "in_drive"),
    [
        (5, None, None, True),
        (5, DSC, None, True),
        (5, CNC, None, False),
        (5, DRIVE, 70346, True),
        (3, None, None, False),
        (3, CNC, None, False),
        (3, DSC, 70344, False),  # it has neither XERR nor KPC
        (3, DRIVE, 70346, False),
    ],
)
def test_a_loop_is_where_the_telegram_and_p_axis_00320_have_it(
    rig_above: Read, telegram: int, mode: str | None, alarm: int | None, in_drive: bool
) -> None:
    changes = () if mode is None else (MODE + mode,)
    settings = rig_above(
        "probe-z-profidrive.toml", f"[drive.servo]\ntelegram = {telegram}", *changes
    )
    found = wrong_mode(settings, "Z")
    assert (None if found is None else found.id) == alarm
    if found is not None:
        assert found.values["mode"] == mode
    if alarm is None:
        assert uses_dsc(settings, "Z") is in_drive
        assert (loop_settings(settings, "Z") is None) is in_drive
        assert (gain_of(settings, "Z") > 0) is in_drive


@pytest.mark.parametrize("way_ns", [0, 1_500_000])
@pytest.mark.parametrize("speed_loop_us", [0.0, 250.0, 1000.0])
def test_dead_cycles_of_a_loop_in_the_drive_are_of_its_ticks_and_without_a_way(
    rig_above: Read, speed_loop_us: float, way_ns: int
) -> None:
    drive = f"[drive.servo]\nspeed_loop_us = {speed_loop_us}\ntick_us = 125"
    own = rig_above("probe-z-profidrive.toml", drive)
    assert period_and_dead(own, "Z", way_ns) == (125e-6, speed_loop_us / 125.0)
    of_cnc = rig_above("probe-z-profidrive.toml", drive, MODE + CNC)
    expected = (1e-3, (way_ns + 1e3 * speed_loop_us) / 1e6)
    assert period_and_dead(of_cnc, "Z", way_ns) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("input_us", "bus_us", "output_us", "dead"),
    [
        (0, 0, 0, 1.0),
        (500, 0, 500, 2.0),
        (500, 100, 500, 2.0),  # when the images pass is between both
        (0, 300, 500, 1.5),
        (500, 0, 0, 1.5),
    ],
)
@pytest.mark.parametrize("base", ["probe-z-profidrive.toml", "probe-z-conventional.toml"])
def test_from_a_sample_to_its_set_speed_it_is_a_cycle_and_both_instants(
    rig_above: Read, base: str, input_us: int, bus_us: int, output_us: int, dead: float
) -> None:
    """With a loop in the CNC; the speed loop of the drive takes no time here."""
    (segment,) = rig_above(base).segment
    keys = f"[segment.{segment}]\ninput_us = {input_us}\nbus_us = {bus_us}\noutput_us = {output_us}"
    changes = (MODE + CNC,) if "profidrive" in base else ()
    settings = rig_above(base, f"{keys}\n[drive.servo]\nspeed_loop_us = 0", *changes)
    text = "\n".join(FAMILY.describe(settings))
    (limit, shown) = re.findall(r"stable below ([\d.]+) 1/s with ([\d.]+) dead cycles", text)[0]
    assert float(shown) == dead
    assert float(limit) == pytest.approx(held_limit(dead) / 1e-3, rel=1e-3)


@pytest.mark.parametrize("bus_us", [0.0, 0.5, 1.0, 100.0])
def test_a_card_of_the_control_has_no_bus_that_takes_time(rig_above: Read, bus_us: float) -> None:
    keys = f"[segment.card]\nbus_us = {bus_us}\noutput_us = {bus_us}"
    settings = rig_above("probe-z-conventional.toml", keys)
    if not bus_us:
        check_rig(settings)
        return
    with pytest.raises(UserError, match="is at a card of the control, and has no bus") as caught:
        check_rig(settings)
    assert (caught.value.value, caught.value.allowed, caught.value.line) == (bus_us, "0", 3)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("resolution = 1_048_576", "2^20 increments a turn"),
        ("resolution = 1", "2^0 increments a turn"),
        ("resolution = 6", "6 increments a turn"),  # even, and no power of 2
        ("resolution = 3000", "3000 increments a turn"),
        ("resolution = 10_001", "10001 increments a turn"),
        ('scaling = "linear"', "0.1 um"),
    ],
)
def test_a_sercos_drive_is_shown_with_its_unit(rig_above: Read, keys: str, words: str) -> None:
    settings = rig_above("probe-z-sercos.toml", f"[drive.servo]\n{keys}")
    assert settings.rig.drive["servo"].in_words.endswith(f", positions in {words}")


def test_the_table_of_cnc_objects_says_which_of_them_can_be_written() -> None:
    lines = objects_table().splitlines()
    for item in objects().values():
        (line,) = [text for text in lines if text.startswith(f"{item.name}  ")]
        assert ("  read write" in line) is item.is_writable
        assert "  read" in line
        assert (f"0x<AID>{item.offset}" in line) is bool(item.offset)
    of_channel = lines[next(n for n, text in enumerate(lines) if text.startswith("3D distance")) :]
    assert not any("write" in text for text in of_channel if text[:1].isdigit())
