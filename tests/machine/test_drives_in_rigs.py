"""Start-up and drive functions on whole rigs: parallel start, what the limits do to the plant."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.can_parts import can_of

from axisrig.bench.judge.topics import events

PROGRAMS = Path(__file__).parents[2] / "testplans" / "programs"
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
FUNCTIONS = """
antr.function[0].id TORQUE
antr.function[0].wr_ident[0] 6072_00
antr.function[0].data_type UNS16
antr.function[0].commu {commu}
antr.function[0].scaling_type LINEAR
antr.function[0].scaling_factor 10
"""
MAP = """\
pdo,transmission,inhibit_100us,index,sub,bits,signed,field,note
RPDO1,1,0,0x6040,0,16,no,controlword,
RPDO1,1,0,0x607A,0,32,yes,target,
RPDO1,1,0,0x60B8,0,16,no,probe_function,
RPDO2,1,0,0x6072,0,16,no,,torque limit for #DRIVE
TPDO1,1,0,0x6041,0,16,no,statusword,
TPDO1,1,0,0x6064,0,32,yes,actual,
TPDO1,1,0,0x60B9,0,16,no,probe_status,
"""


def _list(tmp_path: Path, commu: str) -> Path:
    path = tmp_path / f"axis-{commu}.lst"
    shipped = (RIGS / "lists" / "axis-z-fine.lst").read_text(encoding="utf-8")
    path.write_text(shipped + FUNCTIONS.format(commu=commu), encoding="utf-8")
    return path


@pytest.mark.long
def test_three_drives_on_two_segments_start_at_the_same_time(run_nc: Callable[..., Any]) -> None:
    """One drive takes as long as all three do, but for what they wait for on a shared bus."""
    one = run_nc('N10 #MSG SYN["here"]', "", base="probe-z.toml")
    three = run_nc('N10 #MSG SYN["here"]', "")
    assert (one.alarms, three.alarms) == ([], [])
    start_one = one.machine.channel.start_ns
    start_three = three.machine.channel.start_ns
    assert start_three < 2 * start_one


@pytest.mark.long
def test_a_segment_without_a_drive_gets_no_sync(run_nc: Callable[..., Any]) -> None:
    """Nobody would acknowledge it."""
    spare = "[segment.spare]\nbitrate = 500_000"
    outcome = run_nc("N10 G1 G90 F600 Z129", spare, base="probe-z.toml")
    assert outcome.alarms == []


@pytest.mark.long
def test_the_lines_of_the_manual_reach_the_drive(run_own: Callable[..., Any]) -> None:
    """FCT-C4 7.3.2: 10 % is 100 per mille and back to 50000; the window off and back to 1048575."""
    outcome = run_own(PROGRAMS / "drive-functions.nc", RIGS / "drive-functions.toml")
    assert outcome.alarms == []
    assert (outcome.printed("torque"), outcome.printed("window")) == ([10.0], [4294967295.0])
    image = can_of(outcome.machine).nodes["Z"].image
    assert (image.max_torque, image.following_window) == (50_000, 1_048_575)


@pytest.mark.long
def test_values_given_to_a_drive_are_marks_of_the_run(run_own: Callable[..., Any]) -> None:
    """As the program has them, to the last digit, in its order."""
    outcome = run_own(PROGRAMS / "drive-functions.nc", RIGS / "drive-functions.toml")
    found = [m.label for m in events(outcome.observed) if m.label.startswith("#DRIVE")]
    assert found[:2] == ["#DRIVE WR Z TORQUE_LIMIT = 10", "#DRIVE WR Z MON_WINDOW = 4294967295"]


@pytest.mark.long
def test_the_drive_begins_with_what_the_program_restores(run_own: Callable[..., Any]) -> None:
    outcome = run_own(PROGRAMS / "drive-functions.nc", RIGS / "drive-functions.toml")
    assert outcome.printed("torque before") == outcome.printed("torque after") == [5000.0]
    assert outcome.printed("window before") == outcome.printed("window after") == [1048575.0]


@pytest.mark.long
@pytest.mark.parametrize(
    ("program", "faults"), [("drive-functions.nc", 0), ("fixed-stop-watched.nc", 1)]
)
def test_a_fixed_stop_is_a_following_error_only_while_the_drive_watches(
    run_own: Callable[..., Any], program: str, faults: int
) -> None:
    """Stopped at 105 mm on the way to 120 mm; the window is 1048575 of 1048576 units for 10 mm."""
    in_front = ["plant:z.position_start_mm=100", "plant:z.stop_position_mm=105"]
    outcome = run_own(PROGRAMS / program, RIGS / "drive-functions.toml", in_front)
    found = [str(alarm) for alarm in outcome.machine.channel.alarms]
    assert sum("900005" in text and "0x8611" in text for text in found) == len(found) == faults


@pytest.mark.long
def test_a_cyclic_function_acts_like_one_over_sdo(
    run_nc: Callable[..., Any], tmp_path: Path
) -> None:
    """With a torque limit of 1 % the axis does the same whichever way the limit came."""
    table = tmp_path / "map.csv"
    table.write_text(MAP, encoding="utf-8")
    reached = {}
    for commu, own_map in (("ACYCLIC", False), ("CYCLIC", True)):
        rig = f'[axis.Z]\nlist = "{_list(tmp_path, commu).as_posix()}"\n'
        if own_map:
            rig += f'[drive.servo]\npdo_map = "{table.as_posix()}"\n'
        outcome = run_nc(
            "N10 G1 G90 F600 Z129\n"
            "N20 #DRIVE WR SYN [AX=Z KEY=TORQUE VAL=1 WAIT]\n"
            "N25 #DRIVE RD [AX=Z KEY=TORQUE P=V.P.T]\n"
            'N26 #MSG SYN["torque=%d", V.P.T]\n'
            "N30 G1 F6000 Z125\n",
            rig,
            "set:Z.getriebe[0].position_settling_time=100000",
            base="probe-z.toml",
        )
        assert outcome.printed("torque") == [1.0], outcome.machine.channel.alarms
        truth = outcome.column("Z.truth_mm")
        reached[commu] = float(np.min(truth))
        assert can_of(outcome.machine).nodes["Z"].image.max_torque == 10
    assert abs(reached["ACYCLIC"] - reached["CYCLIC"]) < 0.05


@pytest.mark.long
def test_the_first_rpdo_leaves_a_cyclic_object_as_it_was(
    run_nc: Callable[..., Any], tmp_path: Path
) -> None:
    """Before any #DRIVE the RPDO carries what start-up has read from the drive."""
    table = tmp_path / "map.csv"
    table.write_text(MAP, encoding="utf-8")
    rig = (
        f'[axis.Z]\nlist = "{_list(tmp_path, "CYCLIC").as_posix()}"\n'
        f'[drive.servo]\npdo_map = "{table.as_posix()}"\nsdo = [["0x6072:0", 777]]\n'
    )
    outcome = run_nc("N10 G1 G90 F600 Z129", rig, base="probe-z.toml")
    assert outcome.alarms == []
    assert can_of(outcome.machine).nodes["Z"].image.max_torque == 777
