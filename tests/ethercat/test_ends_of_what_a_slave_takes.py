"""Where what a slave takes ends: datagrams, areas, transfers, counters; one more is none."""

import struct

import pytest
from tests.ethercat.line import OP, PREOP, SAFEOP, Line, answers, frame, physical
from tests.ethercat.sync_signals import start_sync
from tests.ethercat.test_sdo_server_of_a_slave import COMMAND, DATA, Server

from axisrig.bench.drive.ethercat.distributed_clock import DistributedClock
from axisrig.bench.drive.ethercat.local_clock import LocalClock
from axisrig.bench.drive.ethercat.sync_managers import SyncManagers
from axisrig.kernel.profiles.ethercat.layouts import SM_ENABLE, SM_MASTER_WRITES, SYNC_MANAGER
from axisrig.kernel.time.clock import MS

APRD, APWR = 1, 2
STATION, ALIAS_REGISTER = 0x0010, 0x0012


def test_what_is_behind_the_last_datagram_of_a_frame_is_none() -> None:
    """The first one does not say that another one follows (bit 15 of its length)."""
    line = Line()
    parts = [
        physical(APWR, 0, STATION, b"\x11\x22"),
        physical(APWR, 0, ALIAS_REGISTER, b"\x33\x44"),
    ]
    sent = bytearray(frame(*parts))
    assert sent[16 + 7] & 0x80
    sent[16 + 7] &= 0x7F
    line.segment.send(bytes(sent))
    line.wait(MS)
    back = line.back[-1][1]
    (first,) = answers(back)
    assert first.wkc == 1
    behind = 16 + 12 + 2
    assert back[behind : behind + 14] == sent[behind : behind + 14]
    assert (line.read(STATION, 2), line.read(ALIAS_REGISTER, 2)) == (0x2211, 0)


@pytest.mark.parametrize("is_mailbox", [True, False])
@pytest.mark.parametrize(
    ("address", "length", "taken"),
    [
        (0x1000, 8, True), (0x1000, 3, True), (0x1005, 3, True),
        (0x0FFE, 4, False), (0x0FFE, 12, False), (0x1006, 3, False), (0x1007, 9, False),
    ],
)  # fmt: skip
def test_a_write_is_in_the_area_of_a_buffer_or_refused(
    address: int, length: int, taken: bool, is_mailbox: bool
) -> None:
    """Eight bytes from 1000 on; what is refused changes nothing, and the next whole one counts."""
    whole: list[int] = []
    managers = SyncManagers(whole.append, lambda _: None, lambda _: None, lambda: None)
    control = SM_MASTER_WRITES | (2 if is_mailbox else 0)
    managers.configure(
        SYNC_MANAGER.pack(0x1000, 8, control, 0, SM_ENABLE, 0) + bytes(7 * SYNC_MANAGER.size)
    )
    ram = bytearray(0x3000)
    assert managers.write(address, b"z" * length, ram) is taken
    is_whole = taken and address + length == 0x1008
    assert whole == ([0] if is_whole else [])
    assert not any(ram)
    if is_whole and is_mailbox:
        assert not managers.write(0x1000, b"abcdefgh", ram)  # it is full
        return
    assert managers.write(0x1000, b"abcdefgh", ram)
    assert managers[0].latest == b"abcdefgh"


@pytest.mark.parametrize(("address", "size"), [(0x0FFF, 1), (0x0FFE, 2), (0x0FF0, 16)])
def test_the_last_registers_are_read_and_written_up_to_their_end(address: int, size: int) -> None:
    """They count in the working counter; what a master may only read stays as it is."""
    line = Line()
    assert line.one(APWR, 0, address, b"\xff" * size).wkc == 1
    assert line.one(APRD, 0, address, size).wkc == 1
    assert line.one(APWR, 0, address, b"\xff" * (size + 1)).wkc == 0


def test_a_download_that_is_over_takes_no_further_segment() -> None:
    server = Server()
    assert server.ask("21002001" + "14000000" + DATA[:6].hex()).startswith("60002001")
    assert server.ask("00" + DATA[6:13].hex()).startswith("20")
    assert server.ask("11" + DATA[13:].hex()).startswith("30")
    assert server.objects.written == [(0x2000, 1, DATA.hex())]
    for segment in ("00", "01", "10", "11"):
        assert server.ask(segment + bytes(7).hex()) == "80002001" + COMMAND
    assert len(server.objects.written) == 1


@pytest.mark.parametrize("cycles", [0, 1, 2, 3])
def test_a_clock_that_is_put_to_an_instant_of_sync0_has_one_pulse_there(cycles: int) -> None:
    """So many cycles behind the next pulse: what was left out does not come, nor one twice."""
    line = Line()
    pulses_ns: list[int] = []
    line.drive.sync._sync0 = lambda: pulses_ns.append(line.clock.now_ns)
    start_sync(line, MS)
    line.wait(12 * MS)
    assert len(pulses_ns) > 2
    drive, now_ns, before = line.drive, line.clock.now_ns, len(pulses_ns)
    left_ns = drive.sync.next0 - drive.time.system_ns(now_ns)
    assert 0 < left_ns <= MS
    drive.jump(left_ns + cycles * MS)
    line.wait(5 * MS - 1)
    assert [at_ns - now_ns for at_ns in pulses_ns[before:]] == [0, MS, 2 * MS, 3 * MS, 4 * MS]


def test_power_takes_what_a_clock_has_been_corrected_by() -> None:
    """Its copy is its oscillator again; the difference is 0, and it follows anew."""
    time = DistributedClock(LocalClock(1000))
    for cycle in range(1, 50):
        time.follow(time.system_ns(cycle * MS) - 50_000, 64, cycle * MS)
    assert time.system_ns(50 * MS) != 1000 + 50 * MS
    steps = time.steps
    time.reset()
    for at_ns in (50 * MS, 51 * MS, 500 * MS):
        assert time.system_ns(at_ns) == 1000 + at_ns
    assert (time.difference, time.delay, time.offset) == (0, 0, 0)
    assert time.steps > steps
    time.follow(1000 + 600 * MS, 64, 600 * MS)
    assert time.system_ns(601 * MS) == 1000 + 601 * MS


@pytest.mark.parametrize("register", [0x0442, 0x0443])
@pytest.mark.parametrize("written", [0, 0xFF])
def test_a_write_to_either_counter_of_the_watchdog_clears_it(register: int, written: int) -> None:
    line = Line()
    line.wait(MS)
    line.drive.watchdog.count = 3
    assert line.read(0x0442, 1) == 3
    line.write(0x0440, 0, 1)  # its status is none of them
    assert line.read(0x0442, 1) == 3
    line.write(register, written, 1)
    assert line.read(0x0442, 1) == 0


def test_a_drive_without_outputs_waits_for_none_on_its_way_to_op() -> None:
    line = Line()
    line.preop()
    assert line.sdo_write(0x1C12, 0, 0, 1) == 0
    line.map_image(outputs=8)
    line.one(APWR, 0, 0x810, struct.pack("<HHBBBB", 0x1800, 0, 0x64, 0, 0, 0))
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    assert line.ask(OP) == (OP, 0)


def test_inputs_are_there_as_soon_as_the_state_is() -> None:
    """The first sample belongs to the change to SAFEOP: no cycle has come yet."""
    line = Line(motion=lambda _time_s: 0.0125)
    line.preop()
    line.map_image()
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    status, place = struct.unpack_from("<Hi", line.one(APRD, 0, 0x1C00, 16).data)
    assert status & 0x4F == 0x40  # switch on disabled
    assert place == round(12.5 * (1 << 20) / 10)


@pytest.mark.parametrize("size", range(5))
def test_a_question_for_an_entry_names_index_sub_index_and_values(size: int) -> None:
    """ETG.1000.6: two bytes, one and one; with fewer it is none that the slave knows."""
    line = Line()
    line.preop()
    request = bytes((5, 0, 0, 0)) + struct.pack("<HBB", 0x6041, 0, 0)[:size]
    service, body = line.coe(request, service=8)
    assert service == 8
    if size == 4:
        assert body[0] & 0x7F == 6
        assert struct.unpack_from("<HB", body, 4) == (0x6041, 0)
    else:
        assert body[0] & 0x7F == 7
        code = 0x0607_0010 if size < 2 else 0x0504_0001
        assert int.from_bytes(body[4:8], "little") == code


def test_an_error_of_the_master_is_answered_with_nothing() -> None:
    """Type 0 of a mailbox; the next request has its own answer."""
    line = Line()
    line.preop()
    assert line.send_mail(0, b"\x01\x00\x02\x00") == 1
    line.wait(MS)
    assert line.one(APRD, 0, 0x1080, 128).wkc == 0
    assert line.sdo_read(0x6061, 0) == b"\x08"
    assert line.al() == (PREOP, 0)
