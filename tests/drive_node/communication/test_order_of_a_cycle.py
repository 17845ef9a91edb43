"""The order in which a node acts on what it receives, and what is left after a change of state."""

from collections.abc import Callable
from itertools import groupby
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import State

Make = Callable[..., Any]
START, STOP, PRE_OPERATIONAL, RESET_NODE, RESET_COMMUNICATION = 1, 2, 128, 129, 130
LENGTH, GONE = "4082110000000000", "0000000000000000"
PDOS = [0x183, 0x283]


@pytest.mark.parametrize(
    ("kind", "steps"),
    [
        (1, [("begin", 0), ("cycle", 0x11)]),
        (240, [("begin", 0), ("cycle", 0x11)]),
        (254, [("begin", 0), ("react", 0x11), ("begin", 0x11), ("cycle", 0x11)]),
        (255, [("begin", 0), ("react", 0x11), ("begin", 0x11), ("cycle", 0x11)]),
    ],
)
def test_the_time_until_now_belongs_to_the_values_of_before(
    stranger: Make, kind: int, steps: list[tuple[str, int]]
) -> None:
    """First the plant is stepped to now, then what an RPDO brought is stored, then it acts."""
    drive = stranger()
    drive.write(0x1400, 1, 0x8000_0203, 4)
    assert drive.write(0x1400, 2, kind, 1) == 0
    drive.write(0x1400, 1, 0x203, 4)
    drive.nmt(START)
    servo = drive.node.servo
    done: list[tuple[str, int]] = []

    def noted(name: str, act: Callable[[int], None]) -> Callable[[int], None]:
        def call(now_ns: int) -> None:
            done.append((name, servo.image.target_position))
            act(now_ns)

        return call

    for name in ("begin", "cycle", "react"):
        setattr(servo, name, noted(name, getattr(servo, name)))
    drive.after(0x203, "0600110000000000")
    drive.after(0x80)
    assert [step for step, _ in groupby(done)] == steps


@pytest.mark.parametrize(
    "commands",
    [
        (STOP, START),
        (STOP, PRE_OPERATIONAL, START),
        (START, STOP, START),
        (START, STOP, STOP, START, START),
        (START, PRE_OPERATIONAL, STOP, START),
        (STOP, RESET_COMMUNICATION, START),
        (STOP, RESET_NODE, START),
    ],
)
def test_a_node_that_was_stopped_takes_sync_again(
    stranger: Make, commands: tuple[int, ...]
) -> None:
    """Each SYNC once, whatever way led back to operational (CiA 301, NMT states and services)."""
    drive = stranger()
    for command in commands:
        drive.nmt(command, wait_ms=2)
    for _ in range(2):
        assert [can_id for can_id, _ in drive.after(0x80)] == PDOS
    drive.nmt(STOP)
    assert drive.after(0x80) == []


def test_what_waits_for_a_sync_is_lost_with_operational(stranger: Make) -> None:
    """An RPDO that came before the state was left does not act at the first SYNC of the next."""
    drive = stranger()
    for command in (PRE_OPERATIONAL, STOP):
        drive.nmt(START)
        drive.send(0x203, "0600220000000000")
        drive.run_ms(0.5)
        drive.nmt(command)
        drive.nmt(START)
        drive.after(0x80)
        assert drive.node.image.target_position == 0
        assert drive.node.state is State.SWITCH_ON_DISABLED
        drive.after(0x203, "0600220000000000")
    drive.after(0x80)
    assert drive.node.image.target_position == 0x22


@pytest.mark.parametrize("kind", [1, 255])
def test_an_rpdo_in_the_instant_of_leaving_operational_acts_no_more(
    stranger: Make, kind: int
) -> None:
    """The command is the first on the bus, the RPDO right behind it."""
    drive = stranger()
    drive.write(0x1400, 1, 0x8000_0203, 4)
    drive.write(0x1400, 2, kind, 1)
    drive.write(0x1400, 1, 0x203, 4)
    drive.nmt(START)
    drive.send(0x000, "8003")
    drive.send(0x203, "0600330000000000")
    drive.run_ms(1)
    drive.after(0x80)
    assert drive.node.image.target_position == 0


def test_a_wrong_length_of_sync_is_reported_once_and_again_after_a_reset(stranger: Make) -> None:
    """In stopped it is not reported a second time; a SYNC without data then ends the error."""
    drive = stranger()
    drive.nmt(START)
    drive.after(0x80, "01")
    drive.nmt(STOP)
    drive.after(0x80, "01")
    assert drive.frames(0x083) == [LENGTH]
    drive.nmt(RESET_COMMUNICATION, wait_ms=2)
    drive.after(0x80, "01")
    assert drive.frames(0x083) == [LENGTH, LENGTH]
    drive.after(0x80)
    assert drive.frames(0x083) == [LENGTH, LENGTH, GONE]


@pytest.mark.parametrize("command", [STOP, RESET_COMMUNICATION, RESET_NODE])
def test_nobody_misses_a_sync_of_the_time_before(stranger: Make, command: int) -> None:
    """1006 = 1 ms, three periods: the watch over SYNC begins with the first one after the start."""
    drive = stranger(profile=DriveProfile(sync_loss_periods=3))
    drive.write(0x1006, 0, 1000, 4)
    drive.nmt(START)
    drive.after(0x80)
    drive.nmt(command, wait_ms=2)
    drive.nmt(START)
    drive.write(0x1006, 0, 1000, 4)
    for word in (0x06, 0x07, 0x0F):
        assert drive.write(0x6040, 0, word, 2) == 0
    drive.run_ms(20)
    assert drive.node.state is State.OPERATION_ENABLED
    assert drive.frames(0x083) == []
    drive.after(0x80)
    drive.run_ms(4)
    assert drive.frames(0x083) == ["0087110000000000"]
