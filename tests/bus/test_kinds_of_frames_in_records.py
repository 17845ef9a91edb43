"""Extended, remote and error frames in what is kept of a bus: services, hash, BLF, load."""

import hashlib
import struct
from collections.abc import Callable
from pathlib import Path

import can
import pytest
from tests.bus.conftest import fails

from axisrig.bench.bus.can.dissect import dissect
from axisrig.bench.bus.can.frame import Frame, data_frame
from axisrig.bench.bus.can.frame_hash import FrameHash
from axisrig.bench.bus.can.load import LoadMeter
from axisrig.bench.bus.can.logs import open_log
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.journal import Entry
from axisrig.kernel.time.clock import MS

# What a frame is


@pytest.mark.parametrize("can_id", [0x000, 0x080, 0x083, 0x183, 0x583, 0x703])
def test_an_extended_frame_is_none_of_the_services_of_11_bits(can_id: int) -> None:
    """CiA 301: the pre-defined connection set has 11 bits."""
    data = b"\x05\x01\x02\x03"
    extended = Frame(can_id, data, True, False, len(data))
    found = dissect(extended)
    assert (found.service, found.node, found.fields) == ("unknown", None, {"data": data})
    assert dissect(extended._replace(is_extended_id=False)).service != "unknown"


@pytest.mark.parametrize(
    ("can_id", "service", "node"),
    [(0x703, "heartbeat", 3), (0x1FF, "TPDO1", 127), (0x080, "SYNC", None), (0x481, "TPDO4", 1)],
)
def test_a_remote_frame_is_the_request_of_a_service_of_its_node(
    can_id: int, service: str, node: int | None
) -> None:
    """A master asks for node guarding with one, and it may ask for a TPDO with one."""
    found = dissect(Frame(can_id, b"", False, True, 8))
    assert (found.service, found.node, dict(found.fields)) == (service, node, {"remote": 1})


@pytest.mark.parametrize(
    ("byte", "state", "toggle"),
    [(0x05, 5, 0), (0x85, 5, 1), (0x04, 4, 0), (0x84, 4, 1), (0x7F, 127, 0), (0xFF, 127, 1)],
)
def test_the_toggle_of_node_guarding_is_the_highest_bit(byte: int, state: int, toggle: int) -> None:
    found = dissect(data_frame(0x701, bytes([byte]))).fields
    assert found == {"state": state, "toggle": toggle}


@pytest.mark.parametrize("first", [0x81, 0x90, 0x9F, 0x88])
@pytest.mark.parametrize("can_id", [0x583, 0x603])
def test_an_abort_has_no_other_bits_in_its_first_byte(can_id: int, first: int) -> None:
    """CiA 301: they are reserved and 0, so this may be a segment of a block as well."""
    data = bytes([first, 0x60, 0x60, 0x00, 0x11, 0x00, 0x09, 0x06])
    assert dissect(data_frame(can_id, data)).fields == {
        "specifier": 7, "data": data, "is_last": 0,
    }  # fmt: skip
    abort = dissect(data_frame(can_id, b"\x80" + data[1:])).fields
    assert abort == {"specifier": 4, "index": 0x6060, "sub": 0, "abort_code": 0x06090011}


# What is kept

DATA = bytes.fromhex("01 80 ff")
KINDS = [
    data_frame(0x123, DATA),
    data_frame(0x1234_5678, DATA),
    Frame(0x123, DATA, True, False, 3),  # an extended identifier that fits into 11 bits
    Frame(0x703, b"", False, True, 5),
    Frame(0x0ABC_DE01, b"", True, True, 0),
]


def entries(*, destroyed: int | None = None) -> list[Entry]:
    """One frame in each 1.5 ms, that of a place destroyed."""
    return [(1_500_000 * (n + 1), "can1", frame, n == destroyed) for n, frame in enumerate(KINDS)]


@pytest.mark.parametrize("name", ["can1", "Fräse", "主轴"])
def test_a_hash_has_the_length_of_a_name_in_bytes(name: str) -> None:
    """The bytes of its table: time, name with its length, identifier, flags, dlc, data."""
    found, expected = FrameHash(), hashlib.sha256()
    for at, _, frame, is_error in entries(destroyed=1):
        found(at, name, frame, is_error)
        flags = 1 * frame.is_extended_id | 2 * frame.is_remote_frame | 4 * is_error
        text = name.encode()
        expected.update(struct.pack("<q", at) + bytes([len(text)]) + text)
        expected.update(struct.pack("<IBB8s", frame.arbitration_id, flags, frame.dlc, frame.data))
    assert found.hexdigest() == expected.hexdigest()
    assert found.frames == len(KINDS)


@pytest.mark.parametrize("destroyed", [None, 0, 2, 4])
def test_a_block_in_blf_reads_back_kind_by_kind(tmp_path: Path, destroyed: int | None) -> None:
    """Also when its first or its last frame is an error frame."""
    path = tmp_path / "run.blf"
    log = open_log(path, ["can0", "can1"])
    block = entries(destroyed=destroyed)
    log.take(block[:3])
    log.take(block[3:])
    log.stop()
    with can.BLFReader(path) as reader:
        read = list(reader)
        assert reader.object_count == len(block)
    for message, (at, _, frame, is_error) in zip(read, block, strict=True):
        assert (message.channel, message.is_error_frame) == (1, is_error)
        assert 0 <= at - round(message.timestamp * 1e9) <= 1
        if not is_error:
            assert (message.arbitration_id, message.is_extended_id) == frame[0:3:2]
            assert (message.is_remote_frame, message.dlc) == frame[3:]
            assert bytes(message.data) == frame.data


# How much a bus carries


def test_the_load_of_now_counts_frames_and_error_frames(
    segment: Segment, naive_bits: Callable[[Frame], int]
) -> None:
    """Error frames have 20 bits of a frame, 6 of flag, 8 of delimiter and 3 of intermission."""
    sender = segment.port("sender")
    segment.port("receiver")
    segment.add_fault(fails(2))
    sender.send_raw(0x100, b"\x01")
    sender.send_raw(0x101, b"\x02")
    segment.scheduler.run_until(3 * MS)
    now = segment.load_now(3 * MS, 3 * MS)
    assert (now.frames, now.error_frames) == (2, 4)
    whole = segment.load()
    assert (whole.frames, whole.error_frames) == (2, 4)
    bits = 4 * (20 + 6 + 8 + 3)
    bits += naive_bits(data_frame(0x100, b"\x01")) + naive_bits(data_frame(0x101, b"\x02"))
    assert whole.busy_bits == bits
    for load in (now, whole):
        assert load.busy_share == pytest.approx(bits / 3000)  # 3 ms at 1 Mbit/s


@pytest.mark.parametrize(("ms", "bits"), [(1, 300), (99, 29_700), (100, 30_000), (101, 30_000)])
def test_a_run_of_just_100_ms_is_its_own_worst_window(ms: int, bits: int) -> None:
    meter = LoadMeter(1_000_000)
    for at in range(ms):
        meter.occupy(at * MS, at * MS + 300_000, 300)
    found = meter.figures(ms * MS)
    assert (found.worst_100ms_bits, found.busy_bits) == (bits, 300 * ms)
    assert found.worst_100ms_share == pytest.approx(0.3)
