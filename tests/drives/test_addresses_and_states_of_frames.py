"""Where the datagrams of a cyclic frame go, when its states and inputs are from, who sends it."""

import struct
from types import SimpleNamespace
from typing import Any

import pytest
from tests.drives.test_cyclic_frames_by_hand import BRD, FPWR, FRMW, LRW, MS, OP, SAFEOP, Line

from axisrig.kernel.drives.ethercat.master import Master
from axisrig.kernel.drives.ethercat.settings import RegisterInputs

US = 1000


def addresses(frame: bytes) -> list[tuple[int, int, int]]:
    """Command, position or station, and register of each datagram (ETG.1000.4, 5.4)."""
    found, at, more = [], 16, True
    while more:
        command, _, position, register, word, _ = struct.unpack_from("<BBHHHH", frame, at)
        found.append((command, position, register))
        more = bool(word & 0x8000)
        at += 12 + (word & 0x7FF)
    return found


@pytest.mark.parametrize("station", [1001, 1, 0xFFFF])
def test_each_datagram_goes_to_its_register(station: int) -> None:
    """System time 0910, AL status 0130, system time difference 092C (ETG.1000.4, 6)."""
    line = Line(watches_clocks=True)
    line.master.prepare(station)
    frame = line.cycle()
    assert [each for each in addresses(frame) if each[0] != LRW] == [
        (FPWR, station, 0x0910), (FRMW, station, 0x0910), (BRD, 0, 0x0130), (BRD, 0, 0x092C),
    ]  # fmt: skip


@pytest.mark.parametrize("watches", [True, False])
def test_without_a_reference_clock_no_clock_is_asked(watches: bool) -> None:
    line = Line(watches_clocks=watches)
    line.master.prepare(None)
    assert [command for command, *_ in addresses(line.cycle())] == [LRW, BRD]
    line.master.prepare(1001)
    assert [command for command, *_ in addresses(line.cycle())] == [
        FPWR, FRMW, LRW, BRD, *([BRD] if watches else []),
    ]  # fmt: skip


def test_states_are_unknown_from_a_frame_on_until_it_is_back() -> None:
    line = Line()
    for states in (OP, SAFEOP, OP):
        frame = line.cycle()
        assert line.master.al_states is None
        line.back(frame, states=states)
        assert line.master.al_states == states


@pytest.mark.parametrize(
    ("answered", "states"), [(2, OP), (1, None), (3, None), (0x0102, None), (0x0200, None)]
)
def test_states_count_where_just_all_slaves_have_answered(
    answered: int, states: int | None
) -> None:
    """The working counter has 16 bits."""
    line = Line()
    line.back(line.cycle(), answered=answered)
    assert (line.master.answered, line.master.al_states) == (answered, states)
    assert line.fallen == (states is None)


def test_inputs_are_as_old_as_the_frame_that_has_brought_them_is() -> None:
    """From when it has left, not when it is back."""
    line = Line()
    for late_ns in (0, 30 * US, 900 * US):
        frame = line.cycle()
        left_ns = line.clock.now_ns
        line.clock.run_until(left_ns + late_ns)
        line.back(frame)
        assert line.master.sent_ns == line.master.taken_ns == left_ns
    taken_ns = line.master.taken_ns
    line.back(line.cycle(), counter=5)
    assert line.master.taken_ns == taken_ns < line.master.sent_ns


@pytest.mark.parametrize("is_first", [True, False])
def test_after_the_first_cycle_of_the_channel_the_master_sends_nothing_by_itself(
    is_first: bool,
) -> None:
    line = Line()
    line.master.run_alone()
    if is_first:
        line.clock.call_at(3 * MS, -1, line.master.cycle)
    line.clock.run_until(3 * MS)
    if not is_first:
        line.master.cycle()
    line.clock.run_until(9 * MS)
    assert [at for at, _ in line.sent] == [MS, 2 * MS, 3 * MS]
    line.master.run_alone()
    line.clock.run_until(11 * MS)
    assert [at for at, _ in line.sent][3:] == [10 * MS, 11 * MS]


@pytest.mark.parametrize("sizes", [(4, 2), (1, 4), (2, 2)])
def test_each_terminal_behind_the_drives_gets_its_own_bytes(sizes: tuple[int, int]) -> None:
    line = Line()
    others = [
        RegisterInputs(axis=axis, node_id=node, first=0, size=size)
        for (axis, node), size in zip((("T", 3), ("U", 4)), sizes, strict=True)
    ]
    sent: list[bytes] = []
    port: Any = SimpleNamespace(send=sent.append)
    before = line.master
    line.master = Master(port, line.clock, before.line, before.slaves, line.data, others)
    line.master.mailboxes = before.mailboxes
    line.master.prepare(1001)
    taken: list[tuple[str, bytes]] = []
    for axis in "TU":
        line.master.others_taken.append(lambda data, axis=axis: taken.append((axis, bytes(data))))
    line.clock.run_until(MS)
    line.master.cycle()
    content = bytes(range(1, sum(sizes) + 1))
    line.back(sent[-1], image=bytes(8) + content, counter=8, answered=4)
    assert taken == [("T", content[: sizes[0]]), ("U", content[sizes[0] :])]
    assert line.master.al_states == OP
