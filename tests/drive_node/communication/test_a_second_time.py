"""What happened once may happen again: each error comes, goes and comes as the first time."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.drive.canopen.nmt import NmtState

Make = Callable[..., Any]
EMCY, RPDO_1 = 0x083, 0x203
GONE = "0000000000000000"
WHOLE = "0600000000000000"


def emergencies(drive: Any) -> list[str]:
    found: list[str] = drive.frames(EMCY)
    return found


def test_a_heartbeat_that_is_late_again(stranger: Make) -> None:
    """Two nodes in turn: the number of each is in its message (1016:1 and 1016:2)."""
    drive = stranger()
    drive.write(0x1016, 1, 5 << 16 | 10, 4)
    drive.write(0x1016, 2, 6 << 16 | 15, 4)
    for node in (5, 6, 5):
        drive.after(0x700 + node, "05", wait_ms=8)
        assert drive.read(0x1001) == 0
        drive.run_ms(10)
        assert drive.read(0x1001) == 0x11
        drive.after(0x700 + node, "05", wait_ms=0.5)
        drive.after(0x700 + node, "00")  # restarts: it is missed until its next heartbeat
        drive.after(0x700 + node, "05", wait_ms=0.5)
        drive.write(0x1016, 1, 0, 4)
        drive.write(0x1016, 1, 5 << 16 | 10, 4)
    codes = [message[:4] for message in emergencies(drive)]
    assert codes == ["3081", "0000"] * 6
    assert [message[6:8] for message in emergencies(drive)[::4]] == ["05", "06", "05"]


def test_a_master_that_stops_guarding_again(stranger: Make) -> None:
    drive = stranger()
    drive.write(0x100C, 0, 10, 2)
    drive.write(0x100D, 0, 2, 1)
    for _ in range(2):
        drive.after(0x703, remote=True, wait_ms=19)
        assert drive.read(0x1001) == 0
        drive.run_ms(5)
        assert drive.read(0x1001) == 0x11
        drive.after(0x703, remote=True)
        assert drive.read(0x1001) == 0
    assert [message[:4] for message in emergencies(drive)] == ["3081", "0000"] * 2


@pytest.mark.parametrize("short", ["06", "060000"])
def test_a_telegram_that_is_too_short_again(stranger: Make, short: str) -> None:
    """8210 with the number of the RPDO, of each of two; a good one between takes it back."""
    drive = stranger()
    drive.nmt(1)
    for _ in range(2):
        drive.after(RPDO_1, short)
        assert drive.read(0x1001) == 0x11
        drive.after(RPDO_1, WHOLE)
        assert drive.read(0x1001) == 0
    assert emergencies(drive) == ["1082110100000000", GONE] * 2
    assert drive.read(0x1003) == 2
    assert drive.read(0x1003, 1) == drive.read(0x1003, 2) == 0x0001_8210


def test_a_sync_of_a_wrong_length_again(stranger: Make) -> None:
    drive = stranger()
    drive.nmt(1)
    for _ in range(2):
        drive.after(0x80, "01")
        drive.after(0x80)
    assert emergencies(drive) == ["4082110000000000", GONE] * 2


def test_a_node_that_starts_again_begins_with_everything(stranger: Make) -> None:
    """Toggle bit of the guarding, state of the node, errors and history, by each of both resets."""
    drive = stranger()
    for command in (129, 130, 129):
        drive.nmt(1)
        drive.after(RPDO_1, "06")
        assert drive.after(0x703, remote=True) == [(0x703, "05")]
        drive.nmt(command, wait_ms=2)
        assert drive.node.nmt_state is NmtState.PRE_OPERATIONAL
        assert drive.read(0x1001) == 0
        assert drive.after(0x703, remote=True) == [(0x703, "7f")]
        assert drive.after(0x703, remote=True) == [(0x703, "ff")]
        assert drive.read(0x1003) == (0 if command == 129 else 1)
        drive.nmt(129, wait_ms=2)


def test_a_transfer_after_one_that_was_broken_off(stranger: Make) -> None:
    """A text in segments (1008) begins anew, and again after its end: toggle bit 0 first."""
    drive = stranger()

    def text(segments: int) -> bytes:
        answer = bytes.fromhex(drive.sdo("40081000" + "00" * 4))
        assert answer[0] == 0x41
        size, data, toggle = int.from_bytes(answer[4:], "little"), b"", 0
        for _ in range(segments):
            answer = bytes.fromhex(drive.sdo(f"{0x60 | toggle:02x}" + "00" * 7))
            assert answer[0] & 0x10 == toggle
            data, toggle = data + answer[1:], toggle ^ 0x10
            if answer[0] & 1:
                break
        return data[:size]

    whole = text(99)
    assert len(whole) > 7
    assert text(1) == whole[:7]
    assert text(99) == whole
    drive.sdo("8008100000000000")  # an abort of the client ends one, with no answer
    assert text(99) == whole
