"""Limits of drive functions that a list has wrong: every family corrects them with a warning.

P-AXIS-00408 and 00409 have the correction; the type UNS16 of P-AXIS-00399 goes from 0 to 65535.
"""

from collections.abc import Mapping
from pathlib import Path

import pytest
from tests.machine.made_rigs import settings_of

from axisrig.bench.machine.machine import Machine
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.text.parser import read_program

# Rig and number of the function TORQUE_LIMIT in the list of its axis
RIGS: Mapping[str, tuple[str, int]] = {
    "can": ("fixed-stop-z.toml", 1),
    "ethercat": ("fixed-stop-z-ethercat.toml", 1),
    "profidrive": ("fixed-stop-z-profidrive.toml", 0),
}
LOW = {"axis": "Z", "key": "TORQUE_LIMIT", "low": "-1", "corrected": "0"}
HIGH = {"axis": "Z", "key": "TORQUE_LIMIT", "high": "70000", "corrected": "65535"}
SWAPPED = {"axis": "Z", "key": "TORQUE_LIMIT", "low": "70000", "high": "-1"}


def warned(folder: Path, rig: str, *changes: str) -> tuple[list[Alarm], list[Alarm]]:
    """Warnings of the parts of a machine that has not run yet, and alarms of its channel."""
    program = folder / "own.nc"
    program.write_text("%n\nN10 M30\n", encoding="utf-8")
    settings = settings_of(rig, *changes)
    machine = Machine(settings, read_program(program, tuple(settings.axis)))
    try:
        of_parts = [alarm for part in machine.installed for alarm in part.warnings]
        return of_parts, list(machine.channel.alarms)
    finally:
        machine.close()


@pytest.mark.parametrize("family", RIGS)
@pytest.mark.parametrize(
    ("limits", "wanted"),
    [
        ((0, 65535), []),
        ((-1, 65535), [(70384, LOW)]),
        ((0, 70000), [(70383, HIGH)]),
        ((70000, -1), [(70385, SWAPPED), (70384, LOW), (70383, HIGH)]),
    ],
)
def test_a_corrected_limit_of_a_drive_function_is_a_warning_of_the_channel(
    tmp_path: Path,
    family: str,
    limits: tuple[int, int],
    wanted: list[tuple[int, dict[str, str]]],
) -> None:
    rig, number = RIGS[family]
    function = f"set:Z.antr.function[{number}]"
    changes = [f"{function}.min_limit={limits[0]}", f"{function}.max_limit={limits[1]}"]
    of_parts, of_channel = warned(tmp_path, rig, *changes)
    for alarms in (of_parts, of_channel):
        found = [(alarm.id, {name: alarm.values[name] for name in values})
                 for alarm, (_, values) in zip(alarms, wanted, strict=True)]  # fmt: skip
        assert found == wanted
        assert not any(alarm.ends_program for alarm in alarms)


@pytest.mark.long
def test_each_axis_has_its_own_warnings(tmp_path: Path) -> None:
    """Both axes, in their order, and one alone."""
    low = [f"set:{axis}.antr.function[1].min_limit=-1" for axis in "XY"]
    for changes, axes in ((low, ["X", "Y"]), (low[:1], ["X"]), (low[1:], ["Y"]), ([], [])):
        of_parts, of_channel = warned(tmp_path, "fixed-stop-xy.toml", *changes)
        for alarms in (of_parts, of_channel):
            assert [(alarm.id, alarm.values["axis"]) for alarm in alarms] == [
                (70384, axis) for axis in axes
            ]
