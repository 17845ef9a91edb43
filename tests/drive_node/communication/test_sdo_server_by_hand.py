"""The SDO server of a drive alone, with objects of a test: sizes that a client gives or leaves out.

Frames by hand, CiA 301: command, index, sub-index, four bytes of data or size.
"""

import struct

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.canopen.sdo_server import SdoServer
from axisrig.bench.drive.canopen.sdo_transfers import BlockUpload, SegmentOutlet
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

INDEX = 0x2000
TOO_LONG, TOO_SHORT, COMMAND, TIMED_OUT = 0x06070012, 0x06070013, 0x05040001, 0x05040000
GAP_NS = 250 * US


class Far:
    """A server and its objects, which all have one value.

    size: bytes that a write must have, None = any number. written: index, sub-index and data of
    the writes that were taken. sent: the answers.
    """

    def __init__(self, size: int | None = None, value: bytes = b"", delay_ns: int = 0) -> None:
        self.size, self.value = size, value
        self.written: list[tuple[int, int, bytes]] = []
        self.clock = new_scheduler()
        self.sent: list[bytes] = []
        self.is_free = True
        outlet = SegmentOutlet(self.clock, GAP_NS, self.sent.append, lambda: self.is_free)
        self.server = SdoServer(self, self.clock, outlet, delay_ns)

    def upload(self, index: int, sub: int) -> bytes:
        return self.value

    def writable_size(self, index: int, sub: int) -> int | None:
        return self.size

    def download(self, index: int, sub: int, data: bytes) -> None:
        if self.size not in (None, len(data)):
            raise SdoAbortedError(TOO_LONG if len(data) > (self.size or 0) else TOO_SHORT)
        self.written.append((index, sub, data))

    def ask(self, command: int, data: bytes = b"", sub: int = 0) -> tuple[int, int]:
        """Send a frame with an object; return command and last four bytes of the answer."""
        self.server.on_request(struct.pack("<BHB", command, INDEX, sub) + data.ljust(4, b"\0"))
        command, index, answered, word = struct.unpack("<BHBI", self.sent[-1])
        assert (index, answered) == (INDEX, sub)
        return command, word


@pytest.mark.parametrize(
    ("size", "written", "answer"),
    [
        (None, b"abcd", (0x60, 0)),  # a text or DOMAIN: all four
        (1, b"a", (0x60, 0)),
        (2, b"ab", (0x60, 0)),
        (3, b"abc", (0x60, 0)),
        (4, b"abcd", (0x60, 0)),
        (5, None, (0x80, TOO_SHORT)),
        (8, None, (0x80, TOO_SHORT)),
    ],
)
def test_an_expedited_write_without_a_size_has_that_of_the_object(
    size: int | None, written: bytes | None, answer: tuple[int, int]
) -> None:
    far = Far(size)
    assert far.ask(0x22, b"abcd", 5) == answer
    assert far.written == ([] if written is None else [(INDEX, 5, written)])


@pytest.mark.parametrize("size", [None, 1, 2, 3, 4, 8])
@pytest.mark.parametrize("given", [1, 2, 3, 4])
def test_an_expedited_write_with_a_size_has_that(size: int | None, given: int) -> None:
    far = Far(size)
    command, code = far.ask(0x23 | 4 - given << 2, b"abcd")
    if size in (None, given):
        assert (command, far.written) == (0x60, [(INDEX, 0, b"abcd"[:given])])
    else:
        assert (command, far.written) == (0x80, [])
        assert code == (TOO_LONG if given > (size or 0) else TOO_SHORT)


@pytest.mark.parametrize("length", [1, 2, 3, 4])
def test_up_to_4_bytes_are_read_in_one_frame_with_their_number(length: int) -> None:
    far = Far(value=b"abcd"[:length])
    command, word = far.ask(0x40)
    assert command == 0x43 | 4 - length << 2
    assert word == int.from_bytes(b"abcd"[:length], "little")
    assert not far.clock.run_while(lambda: len(far.sent) == 1, 2000 * MS)  # nothing is under way


@pytest.mark.parametrize("length", [0, 5, 7, 8])
def test_what_is_longer_or_empty_comes_in_segments(length: int) -> None:
    far = Far(value=b"abcdefgh"[:length])
    assert far.ask(0x40) == (0x41, length)
    found, toggle = b"", 0
    for _ in range(2):  # of 7 bytes each
        far.server.on_request(bytes((0x60 | toggle,)) + bytes(7))
        answer = far.sent[-1]
        assert answer[0] & 0x10 == toggle
        found += answer[1 : 8 - (answer[0] >> 1 & 7)]
        toggle ^= 0x10
        if answer[0] & 1:
            break
    else:
        pytest.fail("no segment is the last one")
    assert found == far.value


def test_after_its_end_a_block_upload_takes_nothing_but_the_end_of_the_client() -> None:
    """A1 hex from the client; an acknowledgement that comes again ends it with an error."""
    for last, code in ((0xA1, None), (0xA2, COMMAND), (0xA3, COMMAND)):
        far = Far(value=b"abcdefghij")
        clock = far.clock
        outlet = SegmentOutlet(clock, GAP_NS, far.sent.append, lambda: True)
        upload = BlockUpload(far.value, 127, True, outlet)
        upload.on_frame(b"\xa3" + bytes(7))
        clock.run_until(clock.now_ns + 10 * MS)
        assert [segment[0] for segment in far.sent] == [1, 0x82]
        end = upload.on_frame(bytes((0xA2, 2, 127)) + bytes(5))
        assert end is not None
        assert (end[0], upload.is_done) == (0xC1 | 4 << 2, False)
        if code is None:
            assert upload.on_frame(bytes((last,)) + bytes(7)) is None
            assert upload.is_done
            continue
        with pytest.raises(SdoAbortedError) as caught:
            upload.on_frame(bytes((last, 2, 127)) + bytes(5))
        assert caught.value.code == code


def test_a_segment_waits_until_nothing_else_is_to_be_sent() -> None:
    """It is looked at each 250 us; when the way is free it goes, and the next one after it."""
    far = Far(value=bytes(range(14)))
    assert far.ask(0xA0, bytes((127, 0)))[0] == 0xC2 | 4
    far.is_free = False
    far.server.on_request(b"\xa3" + bytes(7))
    far.clock.run_until(10 * MS)
    assert len(far.sent) == 1
    far.is_free = True
    far.clock.run_until(10 * MS + GAP_NS)
    assert [frame[0] for frame in far.sent[1:]] == [1]
    far.clock.run_until(10 * MS + 2 * GAP_NS)
    assert [frame[0] for frame in far.sent[1:]] == [1, 0x82]


@pytest.mark.parametrize("delay_ns", [0, 5 * MS])
def test_a_client_has_a_second_for_its_next_segment(delay_ns: int) -> None:
    """From the answer on; the abort names the object of the transfer."""
    far = Far(size=20, delay_ns=delay_ns)
    far.server.on_request(struct.pack("<BHBI", 0x21, INDEX, 3, 20))
    far.clock.run_until(delay_ns)
    assert struct.unpack("<BHBI", far.sent[-1]) == (0x60, INDEX, 3, 0)
    far.clock.run_until(delay_ns + 1000 * MS - 1)
    assert len(far.sent) == 1
    far.clock.run_until(delay_ns + 1000 * MS)
    assert struct.unpack("<BHBI", far.sent[-1]) == (0x80, INDEX, 3, TIMED_OUT)
    far.clock.run_until(5000 * MS)
    assert len(far.sent) == 2


@pytest.mark.parametrize("stops", [0, 1, 2])
def test_a_request_that_waits_through_a_stop_has_no_answer(stops: int) -> None:
    """The drive looks at it 5 ms after it has come; what comes after the stop is served."""
    far = Far(size=4, delay_ns=5 * MS)
    far.server.on_request(struct.pack("<BHBI", 0x23, INDEX, 1, 7))
    far.clock.run_until(2 * MS)
    for _ in range(stops):
        far.server.stop()
    far.clock.run_until(3 * MS)
    far.server.on_request(struct.pack("<BHBI", 0x23, INDEX, 2, 8))
    far.clock.run_until(20 * MS)
    subs = [2] if stops else [1, 2]
    assert [sub for _, sub, _ in far.written] == subs
    assert [frame[3] for frame in far.sent] == subs


@pytest.mark.parametrize("way", ["abort", "other", "stop", "read"])
def test_a_block_that_is_broken_off_sends_no_more_segments(way: str) -> None:
    """By the client's abort, a frame that is none of it, a reset, or another transfer."""
    far = Far(value=bytes(range(70)))
    assert far.ask(0xA0, bytes((127, 0)))[0] == 0xC2 | 4
    far.server.on_request(b"\xa3" + bytes(7))
    far.clock.run_until(2 * GAP_NS)
    assert [frame[0] for frame in far.sent[1:]] == [1, 2, 3]
    if way == "stop":
        far.server.stop()
    elif way == "read":
        far.value = b"abcd"
        assert far.ask(0x40, sub=1) == (0x43, int.from_bytes(b"abcd", "little"))
    else:
        far.server.on_request((b"\x80" if way == "abort" else b"\xa2\x7f\x7f").ljust(8, b"\0"))
    count = {"abort": 4, "stop": 4, "read": 5, "other": 5}[way]
    far.clock.run_until(3000 * MS)
    assert len(far.sent) == count
    if way == "other":  # more segments are acknowledged than were sent
        assert far.sent[-1][0] == 0x80
    assert far.ask(0x40)[0] == (0x43 if way == "read" else 0x41)  # it serves on
