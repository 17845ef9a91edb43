"""NMT: what a node does in which state, by which command, after which reset (CiA 301)."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.drive.canopen.nmt import NmtState
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import State

Make = Callable[..., Any]

START, STOP, PRE_OPERATIONAL, RESET_NODE, RESET_COMMUNICATION = 1, 2, 128, 129, 130
STATE_AFTER = {
    START: NmtState.OPERATIONAL,
    STOP: NmtState.STOPPED,
    PRE_OPERATIONAL: NmtState.PRE_OPERATIONAL,
    RESET_NODE: NmtState.PRE_OPERATIONAL,
    RESET_COMMUNICATION: NmtState.PRE_OPERATIONAL,
}
SHORT_RPDO = "0600"  # less than the mapping: emergency 8210


@pytest.mark.parametrize("first", [START, STOP, PRE_OPERATIONAL])
@pytest.mark.parametrize("command", STATE_AFTER)
def test_every_command_in_every_state(stranger: Make, first: int, command: int) -> None:
    drive = stranger()
    drive.nmt(first)
    answers = drive.nmt(command)
    assert drive.node.nmt_state is STATE_AFTER[command]
    is_reset = command in (RESET_NODE, RESET_COMMUNICATION)
    assert ((0x703, "00") in answers) == is_reset


@pytest.mark.parametrize(
    ("command", "sdo", "sync", "emergency"),
    [
        (PRE_OPERATIONAL, True, False, True),
        (START, True, True, True),
        (STOP, False, False, False),
    ],
)
def test_services_of_a_state(
    stranger: Make, command: int, sdo: bool, sync: bool, emergency: bool
) -> None:
    """CiA 301: PDO in operational; SDO and emergency not in stopped; NMT always."""
    drive = stranger()
    drive.nmt(command)
    assert bool(drive.sdo("4000100000000000")) == sdo
    assert ([can_id for can_id, _ in drive.after(0x80)] == [0x183, 0x283]) == sync
    said = drive.after(0x80, "01")  # a SYNC with data: emergency 8240
    assert ((0x083, "4082110000000000") in said) == emergency
    drive.nmt(START)
    assert drive.node.nmt_state is NmtState.OPERATIONAL


def test_pdos_are_received_in_operational_only(stranger: Make) -> None:
    drive = stranger()
    for command, counts in ((PRE_OPERATIONAL, False), (START, True), (STOP, False)):
        drive.nmt(command)
        said = drive.after(0x203, SHORT_RPDO)
        assert ((0x083, "1082110100000000") in said) == counts


def test_an_emergency_waits_until_stopped_is_left(stranger: Make) -> None:
    drive = stranger()
    drive.nmt(START)
    drive.nmt(STOP)
    drive.node.servo.emergency.report(0x1000, 1)
    drive.run_ms(5)
    begin = len(drive.heard)
    drive.nmt(PRE_OPERATIONAL)
    assert drive.heard[begin:] == [(0x083, "0010010000000000")]


@pytest.mark.parametrize(
    "frame", ["", "01", "0103ff", "0104", "0003", "0303", "7f03", "8303", "ff03", "5003"]
)
def test_what_is_no_command_for_this_node_changes_nothing(stranger: Make, frame: str) -> None:
    """Length other than 2, another node, an unknown command."""
    drive = stranger()
    assert drive.after(0, frame) == []
    assert drive.node.nmt_state is NmtState.PRE_OPERATIONAL


def test_node_0_means_everybody(stranger: Make) -> None:
    drive = stranger()
    drive.nmt(START, node=0)
    assert drive.node.nmt_state is NmtState.OPERATIONAL


@pytest.mark.parametrize("command", [RESET_NODE, RESET_COMMUNICATION])
def test_what_a_reset_restores(stranger: Make, command: int) -> None:
    """Reset communication: 1000 to 1FFF; reset node: all."""
    drive = stranger()
    for index, sub, value, size in (
        (0x1017, 0, 500, 2),
        (0x1800, 2, 5, 1),
        (0x100C, 0, 100, 2),
        (0x1005, 0, 0x81, 4),
        (0x1006, 0, 2000, 4),
        (0x6065, 0, 2500, 4),
    ):
        assert drive.write(index, sub, value, size) == 0
    drive.nmt(command)
    assert [drive.read(0x1017), drive.read(0x1800, 2), drive.read(0x100C)] == [0, 1, 0]
    assert [drive.read(0x1005), drive.read(0x1006)] == [0x80, 0]
    assert drive.read(0x6065) == (0xFFFFFFFF if command == RESET_NODE else 2500)


@pytest.mark.parametrize(
    ("command", "lost"),
    [(STOP, True), (RESET_COMMUNICATION, True), (PRE_OPERATIONAL, False)],
)
def test_an_enabled_drive_that_loses_its_master_faults(
    stranger: Make, command: int, lost: bool
) -> None:
    """CiA 402, 6007 = 1 (default): stopped or reset means a lost connection."""
    drive = stranger()
    drive.enable()
    drive.nmt(command)
    drive.nmt(START)
    for _ in range(400):
        drive.after(0x80)
    assert (drive.node.state is State.FAULT) == lost


def test_power_off_and_on(stranger: Make) -> None:
    """Without power nothing is sent and nothing taken; then the drive boots with its defaults."""
    drive = stranger()
    drive.nmt(START)
    assert drive.write(0x1017, 0, 10, 2) == 0
    node = drive.node
    node.power_off()
    begin = len(drive.heard)
    assert drive.after(0x80, wait_ms=50) == []
    assert drive.heard[begin:] == []
    assert node.nmt_state is NmtState.INITIALISING
    node.power_off()
    node.power_on()
    drive.run_ms(1)
    assert drive.heard[begin:] == [(0x703, "00")]
    assert drive.read(0x1017) == 0
    assert drive.nmt(START)[0][0] == 0x383  # the event-driven one
    assert [can_id for can_id, _ in drive.after(0x80)] == [0x183, 0x283]


def test_restart_in_the_middle_of_everything(stranger: Make) -> None:
    """What was planned before the loss of power does nothing after it."""
    drive = stranger()
    drive.write(0x1017, 0, 7, 2)
    drive.sdo("4008100000000000")
    drive.after(0x603, "a408100002000000")
    drive.nmt(START)
    drive.send(0x203, "0600000000000000")
    drive.send(0x80)
    drive.run_ms(0.1)
    drive.node.restart()
    begin = len(drive.heard)
    drive.run_ms(2000)
    assert drive.heard[begin:] == [(0x703, "00")]


def test_slow_answers(stranger: Make) -> None:
    drive = stranger(profile=DriveProfile(sdo_answer_ns=5_000_000))
    begin = drive.bench.scheduler.now_ns
    assert drive.after(0x603, "4000100000000000", wait_ms=5) == []
    assert drive.after(0x100, wait_ms=1)[0][1] == "4300100092010200"
    assert drive.bench.scheduler.now_ns - begin == 6_000_000


def test_a_request_that_waits_is_forgotten_with_a_reset(stranger: Make) -> None:
    drive = stranger(profile=DriveProfile(sdo_answer_ns=5_000_000))
    drive.after(0x603, "2b17100005000000")
    drive.nmt(129)
    drive.run_ms(20)
    assert drive.frames(0x583) == []
    assert drive.node.slave.objects.value(0x1017) == 0
