"""An axis inside its stop, and a screw of the plant that is not that of the drive: told at once."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.machine.plants import (
    build_plant,
    check_plant,
    check_plants,
    describe_plants,
    start_plant,
)
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

RigWriter = Callable[..., Path]
Read = Callable[..., Settings]
START = "start = { position_start_mm = 130, kv = 40 }"
BELOW = "plant:z.stop_direction=-1"


@pytest.mark.parametrize(
    ("assignments", "depth", "bound"),
    [
        (["plant:z.stop_position_mm=67.25"], "62.75 mm inside", "at most 67.25 mm"),
        ([BELOW, "plant:z.stop_position_mm=130.001"], "0.001 mm inside", "at least 130.001 mm"),
        ([BELOW], "999870 mm inside", "at least 1e+06 mm"),
        (
            ["plant:z.stop_position_mm=110", "plant:z.position_start_mm=115"],
            "5 mm inside",
            "at most 110 mm",
        ),
    ],
)
def test_an_axis_inside_its_stop_is_refused_with_the_numbers(
    rig_file: RigWriter, settings_of: Read, assignments: list[str], depth: str, bound: str
) -> None:
    path = rig_file()
    with pytest.raises(UserError) as refused:
        check_plant(settings_of(path, *assignments, "plant:z.stop_damping=60"))
    text = str(refused.value)
    assert assignments[-1] in text
    assert depth in text
    assert bound in text


def test_a_rig_that_starts_so_is_told_where(rig_file: RigWriter, settings_of: Read) -> None:
    path = rig_file((START, START.replace(" }", ", stop_position_mm = 120 }")))
    with pytest.raises(UserError) as refused:
        check_plant(settings_of(path, "plant:z.kv=30"))
    line = path.read_text().splitlines().index("[plant.z]") + 3
    assert str(refused.value).startswith(f"{path}:{line}: axis Z is 10 mm inside its stop")


@pytest.mark.parametrize(
    "assignments",
    [
        ["plant:z.stop_position_mm=130"],  # touches it without a force
        [BELOW, "plant:z.stop_position_mm=130"],
        [  # moves in later
            "plant:z.stop_position_mm=131",
            "plant:z.stop_speed_mm_s=-10",
            "plant:z.stop_begin_ms=1",
            "plant:z.stop_end_ms=900",
        ],
    ],
)
def test_an_axis_in_front_of_its_stop_is_not(
    rig_file: RigWriter, settings_of: Read, assignments: list[str]
) -> None:
    check_plant(settings_of(rig_file(), *assignments))


@pytest.mark.parametrize(("screw_mm", "is_told"), [(5, True), (10, False)])
def test_another_screw_than_that_of_the_drive_is_told(
    rig_file: RigWriter, settings_of: Read, screw_mm: float, is_told: bool
) -> None:
    settings = settings_of(rig_file(), f"plant:z.screw_lead_mm={screw_mm}")
    plant = build_plant(settings)
    try:
        check_plants(settings, plant)
        start_plant(settings, plant)
        message = "\n".join(describe_plants(settings, plant))
    finally:
        plant.close()
    assert ("screw_lead is 5 mm and lead_mm of drive servo 10" in message) is is_told


def test_an_fmu_that_refuses_its_start_values_names_the_cell(
    rig_file: RigWriter, settings_of: Read
) -> None:
    speed = "plant:z.stop_speed_mm_s=5"
    with pytest.raises(UserError, match=r"a stop with a stop_speed needs a stop_end") as refused:
        check_plant(settings_of(rig_file(), speed, "plant:z.kv=30"))
    assert str(refused.value).startswith(f"--set {speed}: ")
