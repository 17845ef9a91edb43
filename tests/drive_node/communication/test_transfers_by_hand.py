"""Transfers of an SDO server frame by frame, without objects and without a bus (CiA 301)."""

from collections.abc import Iterator

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.canopen.sdo_transfers import (
    BlockDownload,
    BlockUpload,
    SegmentedDownload,
    SegmentedUpload,
    SegmentOutlet,
    Transfer,
    check_sum,
)
from axisrig.kernel.time.clock import US
from axisrig.kernel.time.scheduler import new_scheduler

TOO_LONG, LENGTH, TOGGLE, CRC, COMMAND = (
    0x06070012, 0x06070010, 0x05030000, 0x05040004, 0x05040001,
)  # fmt: skip
MOST = 1 << 16
"""The most bytes that a text or DOMAIN takes."""


def segments(data: bytes) -> Iterator[bytes]:
    """Download segments: toggle bit 4, unused bytes in bits 3 to 1, bit 0 in the last one."""
    toggle = 0
    for at in range(0, len(data), 7):
        part = data[at : at + 7]
        is_last = at + 7 >= len(data)
        yield bytes((toggle | 7 - len(part) << 1 | is_last,)) + part.ljust(7, b"\0")
        toggle ^= 0x10


def block(parts: list[bytes], *, last: bool = True) -> Iterator[bytes]:
    """Segments of a block, numbered from 1; bit 7 in the last one of the transfer."""
    for number, part in enumerate(parts, 1):
        is_last = last and number == len(parts)
        yield bytes((number | is_last << 7,)) + part.ljust(7, b"\0")


def parts_of(data: bytes) -> list[bytes]:
    return [data[at : at + 7] for at in range(0, len(data), 7)]


def end(data: bytes, *, unused: int | None = None, crc: int | None = None) -> bytes:
    count = -len(data) % 7 if unused is None else unused
    summed = check_sum(data) if crc is None else crc
    return bytes((0xC1 | count << 2,)) + summed.to_bytes(2, "little") + bytes(5)


def send(transfer: Transfer, frames: Iterator[bytes]) -> None:
    for frame in frames:
        transfer.on_frame(frame)


def aborted(transfer: Transfer, frames: Iterator[bytes]) -> int:
    with pytest.raises(SdoAbortedError) as error:
        send(transfer, frames)
    return int(error.value.code)


def test_the_check_sum_is_that_of_the_standard() -> None:
    """Polynomial x^16 + x^12 + x^5 + 1 from 0: 31C3 of "123456789" (CiA 301, block transfer)."""
    assert check_sum(b"123456789") == 0x31C3
    assert check_sum(b"") == 0


@pytest.mark.parametrize("size", [1, 6, 7, 8, 14, 15])
@pytest.mark.parametrize("announced", [True, False])
def test_segments_are_put_together(size: int, announced: bool) -> None:
    data = bytes(range(1, size + 1))
    transfer = SegmentedDownload(size if announced else None)
    answers = [transfer.on_frame(frame) for frame in segments(data)]
    assert (transfer.received, transfer.is_done) == (data, True)
    assert [answer[0] for answer in answers] == [0x20 | n % 2 << 4 for n in range(len(answers))]
    assert all(answer[1:] == bytes(7) for answer in answers)


@pytest.mark.parametrize(("announced", "size", "code"), [(8, 7, LENGTH), (8, 9, TOO_LONG)])
def test_segments_have_to_bring_what_was_announced(announced: int, size: int, code: int) -> None:
    transfer = SegmentedDownload(announced)
    assert aborted(transfer, segments(bytes(size))) == code
    assert transfer.received is None


@pytest.mark.parametrize("more", [0, 1])
def test_segments_without_a_size_end_at_the_most_that_is_taken(more: int) -> None:
    transfer = SegmentedDownload(None)
    frames = segments(bytes(MOST + more))
    if more:
        assert aborted(transfer, frames) == TOO_LONG
        return
    for frame in frames:
        transfer.on_frame(frame)
    assert transfer.received == bytes(MOST)


@pytest.mark.parametrize("place", [0, 1])
def test_a_toggle_bit_that_does_not_alternate_ends_a_transfer(place: int) -> None:
    down, up = SegmentedDownload(None), SegmentedUpload(bytes(20))
    frames = list(segments(bytes(20)))
    for number in range(place):
        down.on_frame(frames[number])
        up.on_frame(bytes((0x60 | number % 2 << 4,)) + bytes(7))
    wrong = bytes((frames[place][0] ^ 0x10,)) + bytes(7)
    assert aborted(down, iter([wrong])) == TOGGLE
    asked = bytes((0x60 | (place + 1) % 2 << 4,)) + bytes(7)
    assert aborted(up, iter([asked])) == TOGGLE


@pytest.mark.parametrize("size", [1, 7, 8, 20])
def test_an_upload_gives_its_value_in_segments_and_marks_the_last(size: int) -> None:
    data = bytes(range(1, size + 1))
    transfer, found = SegmentedUpload(data), b""
    for number in range(-(-size // 7)):
        assert not transfer.is_done
        answer = transfer.on_frame(bytes((0x60 | number % 2 << 4,)) + bytes(7))
        first, unused = answer[0], answer[0] >> 1 & 7
        assert first & 0x10 == number % 2 << 4
        assert bool(first & 1) is (7 * (number + 1) >= size)
        found += answer[1 : 8 - unused]
    assert (found, transfer.is_done) == (data, True)


# Blocks


@pytest.mark.parametrize("count", [1, 126, 127, 128, 254, 260])
@pytest.mark.parametrize("announced", [True, False])
def test_blocks_are_put_together(count: int, announced: bool) -> None:
    """127 segments each; the last one of a block is answered with its number."""
    data = bytes(n * 7 % 251 for n in range(7 * count - 3))
    transfer = BlockDownload(len(data) if announced else None, has_crc=True)
    parts = parts_of(data)
    for at in range(0, count, 127):
        is_last_block = at + 127 >= count
        some = parts[at : at + 127]
        answers = [transfer.on_frame(frame) for frame in block(some, last=is_last_block)]
        assert answers[:-1] == [None] * (len(some) - 1)
        assert answers[-1] == bytes((0xA2, len(some), 127)) + bytes(5)
        assert transfer.takes_segments is not is_last_block
    assert transfer.on_frame(end(data)) == b"\xa1" + bytes(7)
    assert (transfer.received, transfer.is_done) == (data, True)


@pytest.mark.parametrize("lost", [1, 2, 5])
def test_a_lost_segment_is_asked_for_again_with_all_behind_it(lost: int) -> None:
    """Of five the last too: the answer has the number of the last one that came in order."""
    data = bytes(range(33))
    transfer = BlockDownload(None, has_crc=True)
    frames = list(block(parts_of(data)))
    sent = [frame for number, frame in enumerate(frames, 1) if number != lost]
    if lost == len(frames):  # its place is taken by a last one that is not the next
        sent.append(bytes((127,)) + bytes(7))
    answers = [transfer.on_frame(frame) for frame in sent]
    assert answers[-1] == bytes((0xA2, lost - 1, 127)) + bytes(5)
    assert transfer.takes_segments
    rest = parts_of(data)[lost - 1 :]
    assert [transfer.on_frame(frame) for frame in block(rest)][-1] == (
        bytes((0xA2, len(rest), 127)) + bytes(5)
    )
    assert not transfer.takes_segments
    transfer.on_frame(end(data))
    assert transfer.received == data


@pytest.mark.parametrize(
    ("announced", "size", "code"),
    [(8, 7, LENGTH), (8, 15, TOO_LONG), (14, 13, LENGTH), (14, 15, TOO_LONG), (13, 14, LENGTH)],
)
def test_blocks_have_to_bring_what_was_announced(announced: int, size: int, code: int) -> None:
    data = bytes(size)
    transfer = BlockDownload(announced, has_crc=False)
    assert aborted(transfer, iter([*block(parts_of(data)), end(data)])) == code
    assert transfer.received is None


@pytest.mark.parametrize(("size", "is_taken"), [(MOST, True), (MOST + 7, False)])
def test_blocks_without_a_size_end_at_the_most_that_is_taken(size: int, is_taken: bool) -> None:
    """A whole segment beyond it is one too many; fewer bytes show at the end only."""
    transfer = BlockDownload(None, has_crc=False)
    parts = parts_of(bytes(size))
    frames = [
        frame
        for at in range(0, len(parts), 127)
        for frame in block(parts[at : at + 127], last=at + 127 >= len(parts))
    ]
    if is_taken:
        for frame in frames:
            transfer.on_frame(frame)
        transfer.on_frame(end(bytes(size)))
        assert transfer.received == bytes(size)
    else:
        assert aborted(transfer, iter(frames)) == TOO_LONG


@pytest.mark.parametrize("has_crc", [True, False])
def test_a_wrong_check_sum_counts_where_one_was_agreed(has_crc: bool) -> None:
    data = b"123456789"
    transfer = BlockDownload(None, has_crc=has_crc)
    for frame in block(parts_of(data)):
        transfer.on_frame(frame)
    wrong = end(data, crc=check_sum(data) ^ 1)
    if has_crc:
        assert aborted(transfer, iter([wrong])) == CRC
        assert transfer.received is None
    else:
        transfer.on_frame(wrong)
        assert transfer.received == data


@pytest.mark.parametrize("first", [0xC0, 0xC2])
def test_what_is_no_end_of_a_block_download_is_refused(first: int) -> None:
    transfer = BlockDownload(None, has_crc=False)
    transfer.on_frame(next(block([b"abc"])))
    assert aborted(transfer, iter([bytes((first,)) + bytes(7)])) == COMMAND


class Outlet:
    """Where the segments of a block go; one each 250 us."""

    def __init__(self) -> None:
        self.clock, self.sent = new_scheduler(), list[bytes]()

    def upload(self, size: int, block_size: int = 127) -> BlockUpload:
        outlet = SegmentOutlet(self.clock, 250 * US, self.sent.append, lambda: True)
        return BlockUpload(bytes(range(size)), block_size, True, outlet)

    def run(self, time_us: int) -> int:
        self.clock.run_until(self.clock.now_ns + time_us * US)
        return len(self.sent)


def test_a_block_that_was_broken_off_sends_no_more() -> None:
    """The client's abort ends the transfer in the middle of a block."""
    outlet = Outlet()
    transfer = outlet.upload(100)
    transfer.on_frame(b"\xa3" + bytes(7))
    assert outlet.run(600) == 3
    transfer.is_done = True
    assert outlet.run(10_000) == 3


def test_a_block_has_as_many_segments_as_the_last_acknowledgement_says() -> None:
    """100 bytes are 15 segments: 4, 6, then the 5 that are left; the last one says so."""
    outlet = Outlet()
    transfer = outlet.upload(100, 4)
    transfer.on_frame(b"\xa3" + bytes(7))
    assert outlet.run(10_000) == 4
    assert transfer.on_frame(bytes((0xA2, 4, 6)) + bytes(5)) is None
    assert outlet.run(10_000) == 10
    assert transfer.on_frame(bytes((0xA2, 6, 127)) + bytes(5)) is None
    assert outlet.run(10_000) == 15
    numbers = [frame[0] for frame in outlet.sent]
    assert numbers == [1, 2, 3, 4, 1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5 | 0x80]
    data = b"".join(frame[1:] for frame in outlet.sent)
    assert data[:100] == bytes(range(100))
    finished = transfer.on_frame(bytes((0xA2, 5, 127)) + bytes(5))
    assert finished == bytes((0xC1 | 5 << 2,)) + check_sum(bytes(range(100))).to_bytes(
        2, "little"
    ) + bytes(5)


def test_segments_that_were_lost_are_sent_again() -> None:
    """Acknowledged up to the second: the next block begins with the third."""
    outlet = Outlet()
    transfer = outlet.upload(50, 5)
    transfer.on_frame(b"\xa3" + bytes(7))
    outlet.run(10_000)
    transfer.on_frame(bytes((0xA2, 2, 5)) + bytes(5))
    outlet.run(10_000)
    assert outlet.sent[5] == bytes((1, *range(14, 21)))
    assert len(outlet.sent) == 10


@pytest.mark.parametrize(("number", "size", "code"), [(5, 5, 0x05040003), (4, 0, 0x05040002),
                                                      (4, 128, 0x05040002)])  # fmt: skip
def test_an_acknowledgement_that_cannot_be_is_refused(number: int, size: int, code: int) -> None:
    """CiA 301: sequence number above what was sent, block size outside 1 to 127."""
    outlet = Outlet()
    transfer = outlet.upload(50, 4)
    transfer.on_frame(b"\xa3" + bytes(7))
    outlet.run(10_000)
    with pytest.raises(SdoAbortedError) as caught:
        transfer.on_frame(bytes((0xA2, number, size)) + bytes(5))
    assert caught.value.code == code
