"""SDO transfers of every length: number of frames, the last one, and its bytes without data.

CiA 301: a segment has 7 bytes; n says how many of the last one hold no data, c that it is the last.
"""

from collections.abc import Callable

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.canopen.sdo_transfers import (
    BlockDownload,
    BlockUpload,
    SegmentedDownload,
    SegmentedUpload,
    SegmentOutlet,
    check_sum,
)
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

LENGTHS = (5, 6, 7, 8, 13, 14, 15, 20, 21, 22, 70)
TOGGLE, LAST = 0x10, 1


def value_of(length: int) -> bytes:
    return bytes(range(1, length + 1))


@pytest.mark.parametrize("length", LENGTHS)
def test_an_upload_ends_with_the_segment_that_holds_its_last_byte(length: int) -> None:
    upload, found, toggle = SegmentedUpload(value_of(length)), b"", 0
    count = -(-length // 7)
    for number in range(1, count + 1):
        assert not upload.is_done
        answer = upload.on_frame(bytes([0x60 | toggle, *bytes(7)]))
        unused = 7 * count - length if number == count else 0
        is_last = number == count
        assert (len(answer), answer[0]) == (8, toggle | unused << 1 | (LAST if is_last else 0))
        assert answer[8 - unused :] == bytes(unused)
        found += answer[1 : 8 - unused]
        toggle ^= TOGGLE
        assert upload.is_done is is_last
    assert found == value_of(length)


@pytest.mark.parametrize("is_said", [True, False])
@pytest.mark.parametrize("length", LENGTHS)
def test_a_download_is_whole_with_its_last_segment(length: int, is_said: bool) -> None:
    download, toggle = SegmentedDownload(length if is_said else None), 0
    parts = [value_of(length)[at : at + 7] for at in range(0, length, 7)]
    for number, part in enumerate(parts, 1):
        assert (download.received, download.is_done) == (None, False)
        first = toggle | 7 - len(part) << 1 | (LAST if number == len(parts) else 0)
        answer = download.on_frame(bytes([first, *part.ljust(7, b"\xee")]))
        assert answer == bytes([0x20 | toggle, *bytes(7)])
        toggle ^= TOGGLE
    assert (download.received, download.is_done) == (value_of(length), True)


@pytest.mark.parametrize(
    ("size", "frames", "code"),
    [
        (14, ["00" + "11" * 7, "19" + "22" * 7], 0x06070010),  # 10 bytes, and 14 were said
        (8, ["00" + "11" * 7, "11" + "22" * 7], 0x06070012),  # 14 bytes, and 8 were said
        (14, ["10" + "11" * 7], 0x05030000),
        (14, ["00" + "11" * 7, "00" + "22" * 7], 0x05030000),
    ],
)
def test_a_download_of_another_length_or_toggle_is_refused(
    size: int, frames: list[str], code: int
) -> None:
    download = SegmentedDownload(size)
    *before, last = [bytes.fromhex(frame) for frame in frames]
    for frame in before:
        download.on_frame(frame)
    with pytest.raises(SdoAbortedError) as caught:
        download.on_frame(last)
    assert caught.value.code == code
    assert download.received is None


def uploaded(length: int, block_size: int, has_crc: bool) -> tuple[list[bytes], bytes, BlockUpload]:
    """Return the segments of a block upload, its end frame, and itself."""
    clock, sent = new_scheduler(), list[bytes]()
    outlet = SegmentOutlet(clock, 100 * US, sent.append, lambda: True)
    upload = BlockUpload(value_of(length), block_size, has_crc, outlet)
    assert upload.on_frame(bytes([0xA3, *bytes(7)])) is None
    segments: list[bytes] = []
    while True:
        clock.run_until(clock.now_ns + 20 * MS)
        segments += sent
        count = len(sent)
        sent.clear()
        end = upload.on_frame(bytes([0xA2, count, block_size, *bytes(5)]))
        if end is not None:
            return segments, end, upload


@pytest.mark.parametrize("has_crc", [True, False])
@pytest.mark.parametrize("block_size", [1, 2, 3, 127])
@pytest.mark.parametrize("length", LENGTHS)
def test_a_block_upload_has_its_last_segment_marked_and_its_end_with_what_is_unused(
    length: int, block_size: int, has_crc: bool
) -> None:
    segments, end, upload = uploaded(length, block_size, has_crc)
    count = -(-length // 7)
    numbers = [place % block_size + 1 for place in range(count)]
    assert [one[0] for one in segments] == [*numbers[:-1], numbers[-1] | 0x80]
    assert b"".join(one[1:] for one in segments) == value_of(length).ljust(7 * count, b"\0")
    crc = check_sum(value_of(length)) if has_crc else 0
    unused = 7 * count - length
    assert end == bytes([0xC1 | unused << 2, *crc.to_bytes(2, "little"), *bytes(5)])
    assert not upload.is_done
    assert upload.on_frame(bytes([0xA1, *bytes(7)])) is None
    assert upload.is_done


@pytest.mark.parametrize("size", ["said", "not said"])
@pytest.mark.parametrize("length", LENGTHS)
def test_a_block_download_is_whole_with_its_end(length: int, size: str) -> None:
    value, count = value_of(length), -(-length // 7)
    download = BlockDownload(length if size == "said" else None, True)
    for number in range(1, count + 1):
        part = value[7 * number - 7 : 7 * number].ljust(7, b"\0")
        is_last = number == count
        answer = download.on_frame(bytes([number | (0x80 if is_last else 0), *part]))
        expected = bytes([0xA2, count, 127, *bytes(5)])
        assert answer == (expected if is_last else None)
    crc, unused = check_sum(value), 7 * count - length
    end = bytes([0xC1 | unused << 2, *crc.to_bytes(2, "little"), *bytes(5)])
    assert download.on_frame(end) == bytes([0xA1, *bytes(7)])
    assert (download.received, download.is_done) == (value, True)


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda end: bytes([end[0], end[1] ^ 1, *end[2:]]), 0x05040004),  # CRC
        (lambda end: bytes([end[0] & ~1, *end[1:]]), 0x05040001),  # no end of a transfer
    ],
)
def test_a_block_download_with_another_sum_is_refused(
    change: Callable[[bytes], bytes], code: int
) -> None:
    value = value_of(7)
    download = BlockDownload(7, True)
    download.on_frame(bytes([0x81, *value]))
    end = bytes([0xC1, *check_sum(value).to_bytes(2, "little"), *bytes(5)])
    with pytest.raises(SdoAbortedError) as caught:
        download.on_frame(change(end))
    assert caught.value.code == code
    assert download.received is None
