"""A segment on a real interface: what goes out, what comes in, what is written down."""

import hashlib
import struct
from typing import Any

import can
import pytest

from axisrig.bench.bus.can.faults import FrameFault
from axisrig.bench.bus.can.frame import Frame, data_frame, frame_bits
from axisrig.bench.bus.can.frame_hash import FrameHash
from axisrig.bench.bus.can.hardware import interface_names, open_bus, parse_options
from axisrig.bench.bus.can.real_segment import SEND_ERRORS_MAX
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import Phase

MS = 1_000_000


def test_what_is_requested_at_one_instant_goes_out_by_identifier(make_bench: Any) -> None:
    bench = make_bench()
    master, drive = bench.segment.port("cnc"), bench.segment.port("drive")

    def both() -> None:
        master.send_raw(0x203, b"\x01\x02")
        drive.send_raw(0x183, b"\x03")
        master.send_raw(0x080, b"")

    bench.scheduler.call_at(MS, Phase.APPLICATION, both)
    bench.scheduler.run_until(2 * MS)
    # The queue of one port is a FIFO: 0x203 stands before the SYNC of the same port
    assert bench.sent_ids() == [0x183, 0x203, 0x080]
    assert [bytes(msg.data) for _, msg in bench.adapter.sent] == [b"\x03", b"\x01\x02", b""]


def test_ports_of_this_process_hear_each_other_and_the_outside(
    make_bench: Any, make_frame: Any
) -> None:
    bench = make_bench()
    ports = {name: bench.segment.port(name) for name in ("cnc", "x", "y")}
    heard: dict[str, list[int]] = {name: [] for name in ports}
    for name, port in ports.items():
        port.attach_data(lambda can_id, _data, _time, name=name: heard[name].append(can_id))
    bench.scheduler.call_at(MS, Phase.APPLICATION, lambda: ports["x"].send_raw(0x181, b"1"))
    bench.adapter.coming.append((bench.wall.now_ns + 3 * MS, make_frame(0x300, 7)))
    bench.scheduler.run_until(5 * MS)
    assert heard == {"cnc": [0x181, 0x300], "x": [0x300], "y": [0x181, 0x300]}
    assert bench.sent_ids() == [0x181]


def test_remote_extended_and_error_frames_come_in_as_what_they_are(make_bench: Any) -> None:
    bench = make_bench()
    seen: list[tuple[int, bool, bool, int, bool]] = []
    bench.segment.observe(lambda _t, _n, f, e: seen.append((f[0], f[2], f[3], f[4], e)))
    now_ns = bench.wall.now_ns
    for k, msg in enumerate(
        [
            can.Message(arbitration_id=0x703, is_extended_id=False, is_remote_frame=True, dlc=1),
            can.Message(arbitration_id=0x1ABCDEF0, is_extended_id=True, data=b"12"),
            can.Message(arbitration_id=0, is_error_frame=True, dlc=8, data=bytes(8)),
        ]
    ):
        bench.adapter.coming.append((now_ns + (k + 1) * MS, msg))
    bench.scheduler.run_until(6 * MS)
    assert [item[:3] for item in seen[:2]] == [(0x703, False, True), (0x1ABCDEF0, True, False)]
    assert [item[4] for item in seen] == [False, False, True]
    assert bench.segment.load().error_frames == 1


@pytest.mark.parametrize("dlc", [0, 1, 8])
def test_a_remote_frame_keeps_its_length_and_an_error_frame_carries_nothing(
    make_bench: Any, dlc: int
) -> None:
    """Data of an error are words of its adapter, and differ from one to the next."""
    bench = make_bench()
    recorded: list[tuple[Frame, bool]] = []
    bench.segment.observe(lambda _t, _n, frame, is_error: recorded.append((frame, is_error)))
    remote = {"arbitration_id": 0x703, "is_remote_frame": True, "dlc": dlc}
    error = {"arbitration_id": 0x20, "is_error_frame": True, "dlc": dlc, "data": b"\7" * dlc}
    heard: list[int] = []
    bench.segment.port("cnc").attach_data(lambda can_id, _data, _time: heard.append(can_id))
    for at_ms, given in enumerate((remote, error, {**error, "is_remote_frame": True}), 1):
        sent = can.Message(**{"is_extended_id": False, **given})
        if sent.is_error_frame:
            sent.data = bytearray(b"\7" * dlc)
        bench.adapter.coming.append((bench.wall.now_ns + at_ms * MS, sent))
    bench.scheduler.run_until(5 * MS)
    nothing = Frame(0x20, b"", False, False, 0)
    assert recorded == [
        (Frame(0x703, b"", False, True, dlc), False), (nothing, True), (nothing, True),
    ]  # fmt: skip
    assert bench.segment.load().error_frames == 2
    assert heard == []


def test_the_hash_is_that_of_the_documented_bytes(make_bench: Any, make_frame: Any) -> None:
    bench = make_bench()
    frame_hash, times = FrameHash(), []
    bench.segment.observe(frame_hash)
    bench.segment.observe(lambda time_ns, *_: times.append(time_ns))
    bench.adapter.coming.append((bench.wall.now_ns + MS, make_frame(0x183, 1, 2)))
    bench.scheduler.run_until(2 * MS)
    expected = (
        struct.pack("<q", times[0]) + b"\x03out" + struct.pack("<IBB8s", 0x183, 0, 2, b"\1\2")
    )
    assert frame_hash.hexdigest() == hashlib.sha256(expected).hexdigest()


def test_a_bus_that_breaks_is_told_and_opened_again(make_bench: Any, make_frame: Any) -> None:
    bench = make_bench()
    port = bench.segment.port("drive")
    bench.scheduler.run_until(MS)
    bench.adapter.broken = can.CanOperationError("cable pulled")
    bench.scheduler.run_until(2 * MS)
    assert bench.segment.lost == "cable pulled"
    port.send_raw(0x183, b"lost")  # nobody falls over it
    bench.scheduler.run_until(3 * MS)
    bench.adapter.broken = None
    assert bench.segment.reopen()
    assert bench.segment.lost is None
    port.send_raw(0x184, b"there")
    bench.scheduler.run_until(4 * MS)
    assert bench.sent_ids() == [0x184]
    assert bench.openings == 2


def test_a_frame_that_the_interface_does_not_take_is_counted(make_bench: Any) -> None:
    bench = make_bench()
    port = bench.segment.port("drive")
    bench.scheduler.run_until(MS)
    send = bench.adapter.send
    bench.adapter.send = lambda *_: (_ for _ in ()).throw(can.CanOperationError("buffer full"))
    for _ in range(5):
        port.send_raw(0x183, b"")
    bench.scheduler.run_until(2 * MS)
    bench.adapter.send = send
    assert bench.deadlines.send_errors == 5
    assert bench.segment.lost is None


def test_a_bus_that_was_opened_again_counts_its_errors_anew(make_bench: Any) -> None:
    """20 frames in a row that are not taken are borne, one more is a lost bus."""
    bench = make_bench()
    port, segment = bench.segment.port("drive"), bench.segment
    adapter = bench.adapter
    times = iter(range(1, 100))
    send, receive = adapter.send, adapter.recv
    for sends in (SEND_ERRORS_MAX, SEND_ERRORS_MAX):
        adapter.send = lambda *_: (_ for _ in ()).throw(can.CanOperationError("buffer full"))
        for _ in range(sends):
            port.send_raw(0x183, b"")
        bench.scheduler.run_until(next(times) * MS)
        assert segment.lost is None
        adapter.recv = lambda *_: (_ for _ in ()).throw(can.CanOperationError("cable pulled"))
        bench.scheduler.run_until(next(times) * MS)
        assert segment.lost == "cable pulled"
        adapter.send, adapter.recv = send, receive
        assert segment.reopen()


def test_all_answers_that_are_expected_are_waited_for(make_bench: Any, make_frame: Any) -> None:
    """After a SYNC those of two drives; what else comes, and one twice, is none of them."""
    bench = make_bench()
    segment, start_ns = bench.segment, bench.wall.now_ns
    segment.expect([0x181, 0x182])
    bench.scheduler.call_at(MS, Phase.APPLICATION, lambda: port.send_raw(0x080, b""))
    for at_ms, can_id in ((2, 0x300), (3, 0x181), (4, 0x181), (5, 0x182)):
        bench.adapter.coming.append((start_ns + at_ms * MS, make_frame(can_id, 1)))
    port = segment.port("cnc")
    waits = []
    for half_ms in (1, 3, 5, 7, 9, 11):
        bench.scheduler.run_until(half_ms * MS // 2)
        waits.append(segment.is_waiting)
    assert waits == [False, True, True, True, True, False]


def test_faults_of_the_wire_are_refused(make_bench: Any) -> None:
    with pytest.raises(UserError, match="simulated"):
        make_bench().segment.add_fault(FrameFault(0x183))


def test_an_unknown_interface_is_refused_with_the_nearest_names() -> None:
    with pytest.raises(UserError, match="socketcan") as caught:
        open_bus("socketcn", "can0", 1_000_000, {})
    assert caught.value.value == "socketcn"


def test_an_interface_that_cannot_be_opened_says_what_to_do() -> None:
    with pytest.raises(UserError) as caught:
        open_bus("slcan", "/dev/no-such-adapter", 1_000_000, {})
    assert "slcan /dev/no-such-adapter" in str(caught.value)
    assert "docs/hardware.md" in str(caught.value)


@pytest.mark.parametrize(
    ("interface", "options", "expected"),
    [
        ("slcan", {}, {"timeout": 0, "bitrate": 500_000}),
        ("slcan", {"timeout": 0.5}, {"timeout": 0.5, "bitrate": 500_000}),
        ("slcan", {"bitrate": 125_000}, {"timeout": 0, "bitrate": 125_000}),
        ("socketcand", {"tcp_tune": False}, {"tcp_tune": False, "bitrate": 500_000}),
        ("virtual", {}, {"bitrate": 500_000}),
    ],
)
def test_options_of_the_user_go_over_those_of_the_table(
    monkeypatch: pytest.MonkeyPatch,
    interface: str,
    options: dict[str, Any],
    expected: dict[str, Any],
) -> None:
    """An interface is opened with what the table has for it, unless the user says otherwise."""
    given: list[dict[str, Any]] = []
    monkeypatch.setattr(can, "Bus", lambda **all_of_it: given.append(all_of_it))
    open_bus(interface, "there", 500_000, options)
    assert given == [{"interface": interface, "channel": "there", **expected}]


def test_options_are_numbers_truth_values_or_texts() -> None:
    read = parse_options("host=127.0.0.1 port=29536 tcp_tune=true timeout=0.5 name=can0")
    assert read == {
        "host": "127.0.0.1", "port": 29536, "tcp_tune": True, "timeout": 0.5, "name": "can0"
    }  # fmt: skip
    with pytest.raises(UserError, match="key=value"):
        parse_options("tcp_tune")


def test_every_interface_of_python_can_and_ours_may_stand_in_a_rig() -> None:
    assert {"axisrig", "axisrig_tcp", "socketcan", "slcan", "pcan", "vector"} <= {
        *interface_names()
    }


def test_the_reason_of_a_lost_bus_is_one_line(make_bench: Any) -> None:
    """python-can's socketcand puts the traceback into its text."""
    bench = make_bench()
    text = "Failed to receive: Socket closed?  Traceback (most recent call last):\n  File x\n"
    bench.adapter.broken = can.CanError(text)
    bench.scheduler.run_until(MS)
    assert bench.segment.lost == "Failed to receive: Socket closed?"


@pytest.mark.parametrize(
    ("interface", "channel", "options", "found"),
    [
        ("socketcand", "can0", {}, ["without host and port", "--option host=", "--option port="]),
        ("socketcand", None, {"host": "127.0.0.1", "port": 1}, ["without channel", "--channel"]),
        ("axisrig_tcp", "bla", {}, ["bla cannot be served", "ADDRESS:PORT", "127.0.0.1:29536"]),
        ("axisrig_tcp", "127.0.0.1:99999", {}, ["cannot be served", "ADDRESS:PORT"]),
        ("axisrig_tcp", "127.0.0.1:", {}, ["cannot be served", "ADDRESS:PORT"]),
    ],
)
def test_what_an_interface_lacks_is_said_with_an_example(
    interface: str, channel: str | None, options: dict[str, Any], found: list[str]
) -> None:
    with pytest.raises(UserError) as caught:
        open_bus(interface, channel, 1_000_000, options)
    assert all(words in str(caught.value) for words in found), str(caught.value)
    assert "__init__" not in str(caught.value)


@pytest.mark.parametrize("keeps_load", [True, False])
def test_the_load_of_what_goes_out_and_comes_in_is_kept_where_it_is_wanted(
    make_bench: Any, make_frame: Any, keeps_load: bool
) -> None:
    bench = make_bench()
    segment = bench.segment
    segment.keeps_load = keeps_load
    observed: list[int] = []
    segment.observe(lambda _time, _name, frame, _is_error: observed.append(frame.arbitration_id))
    port = segment.port("cnc")
    bench.scheduler.call_at(MS, 0, lambda: port.send_raw(0x201, b"\x01\x02"))
    bench.adapter.coming.append((bench.wall.now_ns + 2 * MS, make_frame(0x181, 1, 2, 3)))
    bench.scheduler.run_until(4 * MS)
    assert observed == [0x201, 0x181]
    bits = frame_bits(data_frame(0x201, b"\x01\x02")) + frame_bits(data_frame(0x181, b"\1\2\3"))
    figures = segment.load()
    assert (figures.frames, figures.busy_bits) == ((2, bits) if keeps_load else (0, 0))
    busy_ns = bits * 10**9 / segment.bitrate if keeps_load else 0
    assert figures.busy_share * figures.until_ns == pytest.approx(busy_ns, abs=2)
    assert set(figures.worst_delay_ns) == ({0x201, 0x181} if keeps_load else set())
