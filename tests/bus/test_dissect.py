"""Frames written out by hand from CiA 301, and what they are."""

import pytest

from axisrig.bench.bus.can.dissect import dissect, sdo_words
from axisrig.bench.bus.can.frame import Frame, data_frame
from axisrig.kernel.profiles.canopen.identifiers import services


@pytest.mark.parametrize(
    ("can_id", "data", "service", "node", "fields"),
    [
        (0x000, "01 05", "NMT", None, {"command": 1, "target": 5}),
        (0x000, "82 00 FF", "NMT", None, {"command": 0x82, "target": 0}),  # longer than its service
        (0x000, "01", "NMT", None, {"data": b"\x01"}),
        (0x080, "07 FF", "SYNC", None, {"counter": 7}),
        (0x083, "11 86 21", "EMCY", 3, {"code": 0x8611, "register": 0x21, "vendor": b""}),
        (0x083, "11 86", "EMCY", 3, {"data": b"\x11\x86"}),
        (0x703, "85 FF", "heartbeat", 3, {"state": 5, "toggle": 1}),
        (0x080, "", "SYNC", None, {}),
        (0x080, "07", "SYNC", None, {"counter": 7}),
        (0x083, "11 86 21 00 00 00 00 00", "EMCY", 3,
         {"code": 0x8611, "register": 0x21, "vendor": bytes(5)}),
        (0x183, "37 02", "TPDO1", 3, {"data": b"\x37\x02"}),
        (0x57F, "00", "RPDO4", 127, {"data": b"\x00"}),
        (0x703, "00", "heartbeat", 3, {"state": 0, "toggle": 0}),
        (0x703, "85", "heartbeat", 3, {"state": 5, "toggle": 1}),
        (0x603, "40 08 10 00 00 00 00 00", "SDO request", 3,
         {"specifier": 2, "index": 0x1008, "sub": 0}),
        (0x583, "43 00 10 00 92 01 02 00", "SDO answer", 3,
         {"specifier": 2, "index": 0x1000, "sub": 0, "value": b"\x92\x01\x02\x00"}),
        (0x583, "4B 41 60 00 37 02 00 00", "SDO answer", 3,
         {"specifier": 2, "index": 0x6041, "sub": 0, "value": b"\x37\x02"}),
        (0x583, "4A 00 10 00 92 01 02 00", "SDO answer", 3,  # without a size its bits say nothing
         {"specifier": 2, "index": 0x1000, "sub": 0, "value": b"\x92\x01\x02\x00"}),
        (0x603, "2F 60 60 00 08 00 00 00", "SDO request", 3,
         {"specifier": 1, "index": 0x6060, "sub": 0, "value": b"\x08"}),
        (0x583, "60 60 60 00 00 00 00 00", "SDO answer", 3,
         {"specifier": 3, "index": 0x6060, "sub": 0}),
        (0x583, "41 08 10 00 13 00 00 00", "SDO answer", 3,
         {"specifier": 2, "index": 0x1008, "sub": 0, "size": 19}),
        (0x603, "70 00 00 00 00 00 00 00", "SDO request", 3, {"specifier": 3, "toggle": 1}),
        (0x603, "60 00 00 00 00 00 00 00", "SDO request", 3, {"specifier": 3, "toggle": 0}),
        (0x583, "30 00 00 00 00 00 00 00", "SDO answer", 3, {"specifier": 1, "toggle": 1}),
        (0x583, "20 00 00 00 00 00 00 00", "SDO answer", 3, {"specifier": 1, "toggle": 0}),
        (0x603, "1C 61 00 00 00 00 00 00", "SDO request", 3,  # one byte, and more segments follow
         {"specifier": 0, "toggle": 1, "data": b"a", "is_last": 0}),
        (0x603, "20 08 10 00 13 00 00 00", "SDO request", 3,  # in segments, without a size
         {"specifier": 1, "index": 0x1008, "sub": 0}),
        (0x583, "40 08 10 00 13 00 00 00", "SDO answer", 3,
         {"specifier": 2, "index": 0x1008, "sub": 0}),
        (0x603, "C2 08 10 00 13 00 00 00", "SDO request", 3,  # block download with and without size
         {"specifier": 6, "index": 0x1008, "sub": 0, "size": 19}),
        (0x603, "C0 08 10 00 13 00 00 00", "SDO request", 3,
         {"specifier": 6, "index": 0x1008, "sub": 0}),
        (0x583, "A2 05 7F 00 00 00 00 00", "SDO answer", 3,
         {"specifier": 5, "step": 2, "taken": 5, "block_size": 127}),
        (0x583, "A2 05", "SDO answer", 3, {"specifier": 5, "step": 2}),
        (0x583, "A2", "SDO answer", 3, {"specifier": 5, "step": 2}),
        (0x583, "A1 05 7F 00 00 00 00 00", "SDO answer", 3, {"specifier": 5, "step": 1}),  # its end
        (0x603, "A3 05 7F 00 00 00 00 00", "SDO request", 3, {"specifier": 5, "step": 3}),  # begin
        (0x603, "A2 05 7F", "SDO request", 3,
         {"specifier": 5, "step": 2, "taken": 5, "block_size": 127}),
        (0x583, "A4 08 10 02 7F", "SDO answer", 3,  # cut off behind its last field
         {"specifier": 5, "index": 0x1008, "sub": 2, "block_size": 127}),
        (0x583, "A4 08 10 02", "SDO answer", 3,
         {"specifier": 5, "index": 0x1008, "sub": 2, "block_size": 0}),
        (0x583, "C6 08 10 02 13 00 01 00", "SDO answer", 3,
         {"specifier": 6, "index": 0x1008, "sub": 2, "size": 0x10013}),
        (0x583, "C1 34 12", "SDO answer", 3,
         {"specifier": 6, "step": 1, "unused": 0, "crc": 0x1234}),
        (0x603, "D5 34 12 00 00 00 00 00", "SDO request", 3,
         {"specifier": 6, "step": 1, "unused": 5, "crc": 0x1234}),
        (0x583, "05 61 62 63 64 65 00 00", "SDO answer", 3,
         {"specifier": 0, "toggle": 0, "data": b"abcde", "is_last": 1}),
        (0x583, "80 34 12 00 00 00 02 06", "SDO answer", 3,
         {"specifier": 4, "index": 0x1234, "sub": 0, "abort_code": 0x06020000}),
        (0x603, "A4 08 10 00 7F 00 00 00", "SDO request", 3,
         {"specifier": 5, "index": 0x1008, "sub": 0, "block_size": 127}),
        (0x7E5, "04 01 00 00 00 00 00 00", "LSS request", None,
         {"command": 4, "data": b"\x01" + bytes(6)}),
        (0x100, "00 00 00 00 00 00", "TIME", None, {"data": bytes(6)}),
        (0x001, "55", "unknown", None, {"data": b"\x55"}),
    ],
)  # fmt: skip
def test_frames_of_the_standard(
    can_id: int, data: str, service: str, node: int | None, fields: dict[str, object]
) -> None:
    found = dissect(data_frame(can_id, bytes.fromhex(data)))
    assert (found.service, found.node) == (service, node)
    assert dict(found.fields) == fields


def test_remote_extended_and_error_frames() -> None:
    assert dissect(Frame(0x703, b"", False, True, 1)).fields == {"remote": 1}
    assert dissect(data_frame(0x1000, b"")).service == "unknown"
    assert dissect(data_frame(0x183, b""), is_error=True).service == "error frame"


@pytest.mark.parametrize("size", range(9))
def test_no_frame_is_too_short_to_be_taken_apart(size: int) -> None:
    for can_id in range(0x800):
        dissect(data_frame(can_id, bytes(size)))
        dissect(data_frame(can_id, b"\xff" * size))


def test_both_sides_of_sdo_have_words_for_their_commands() -> None:
    assert sdo_words("request", 1) == sdo_words("answer", 3) == "download"
    assert sdo_words("request", 2) == sdo_words("answer", 2) == "upload"
    assert sdo_words("request", 4) == sdo_words("answer", 4) == "abort"
    assert sdo_words("answer", 7) == "unknown"


def test_services_do_not_overlap() -> None:
    ids = [can_id for s in services() for can_id in range(s.first, s.last + 1)]
    assert len(ids) == len(set(ids))
