"""The SDO client against answers that are slow, odd or wrong (CiA 301 7.2.4.3), frame by frame."""

import struct
from typing import Any

import pytest
from tests.drives.test_sdo_client import Server, _client, _frame

from axisrig.kernel.drives.canopen.sdo import SdoClient
from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.time.clock import MS

TOGGLE, UNKNOWN, LENGTH = 0x05030000, 0x05040001, 0x06070010
NAME = 0x1008
TEXT = b"ABCDEFGHIJKLMNOP"
SEGMENTS = ("0041424344454647", "1048494a4b4c4d4e", "0b4f500000000000")
"""TEXT in segments of an upload: toggle bit 4, unused bytes in bits 3 to 1, last one bit 0."""


def answering(*answers: str | None, after_ns: int = MS) -> tuple[Server, SdoClient]:
    """A server with one answer to each frame in turn, None for none."""
    waiting = list(answers)

    def answer(_asked: bytes) -> list[bytes]:
        frame = waiting.pop(0) if waiting else None
        if frame is not None:
            server.reply(_frame(frame), after_ns)
        return []

    server, client = _client(answer)
    return server, client


def read(server: Server, client: SdoClient, until_ns: int = 90 * MS) -> Any:
    found: list[Any] = []
    client.read(NAME, 0, found.append)
    server.clock.run_until(until_ns)
    assert len(found) == 1
    return found[0]


# What is right


@pytest.mark.parametrize("after_ms", [1, 60, 99])
def test_each_answer_has_the_whole_time_for_itself(after_ms: int) -> None:
    """Four answers of up to 99 ms each with a time-out of 100 ms, and 100 ms begin with each."""
    server, client = answering("4108100010000000", *SEGMENTS, after_ns=after_ms * MS)
    assert read(server, client, 500 * MS) == TEXT
    assert client.latency_ns == 4 * after_ms * MS
    assert not any(frame[0] == 0x80 for frame in server.asked)


@pytest.mark.parametrize("command", [0x42, 0x46, 0x4A, 0x4E])
def test_without_the_bit_for_it_the_number_of_unused_bytes_does_not_count(command: int) -> None:
    server, client = answering(f"{command:02x}08100001020304")
    assert read(server, client) == b"\1\2\3\4"


def test_a_text_whose_length_was_not_announced_ends_with_its_last_segment() -> None:
    """Command 40: the four bytes are reserved, whatever is in them."""
    server, client = answering("4008100003000000", *SEGMENTS)
    assert read(server, client) == TEXT
    asked = [frame[0] for frame in server.asked]
    assert asked == [0x40, 0x60, 0x70, 0x60]


def test_each_segment_says_how_many_of_its_bytes_are_unused() -> None:
    """Bits 1 to 3 of its command, in the last one and in those before it (CiA 301 7.2.4.3.6)."""
    server, client = answering(
        "4108100009000000", "0441424344450000", "1c46000000000000", "0947484900000000"
    )
    assert read(server, client) == b"ABCDEFGHI"


def test_nothing_is_written_as_a_value_of_no_bytes() -> None:
    """21 with a size of 0, then the last segment, whose seven bytes are unused."""
    server, client = answering("6008100000000000", "2000000000000000")
    found: list[Any] = []
    client.write(NAME, 0, b"", found.append)
    server.clock.run_until(90 * MS)
    assert found == [b""]
    assert server.asked == [_frame("2108100000000000"), _frame("0f00000000000000")]


def test_what_is_no_answer_of_eight_bytes_about_the_object_is_passed_over() -> None:
    """Too short, about another object or sub-index; also an abort about another one."""
    server, client = answering()
    found: list[Any] = []
    client.read(NAME, 0, found.append)
    for frame in (
        "4f081000050000", "4f08100005000000 00", "4f09100005000000", "4f08100105000000",
        "4f08110005000000", "8009100000000206",
    ):  # fmt: skip
        server.reply(_frame(frame))
    server.clock.run_until(10 * MS)
    assert found == []
    server.reply(_frame("4f08100007000000"))
    server.clock.run_until(20 * MS)
    assert found == [b"\7"]
    server.reply(_frame("4f08100009000000"))  # nobody has asked
    server.clock.run_until(30 * MS)
    assert found == [b"\7"]


def test_what_waits_is_asked_before_what_an_answer_asks_for() -> None:
    server, client = _client(lambda asked: [b"\x4f" + asked[1:4] + b"\1\0\0\0"])
    client.read(1, 0, lambda _: client.read(3, 0, lambda _: None))
    client.read(2, 0, lambda _: None)
    server.clock.run_until(20 * MS)
    assert [frame[1] for frame in server.asked] == [1, 2, 3]
    assert not client.is_busy


def test_the_latency_is_that_of_the_last_transfer() -> None:
    """Also of one that goes wrong; a time-out before a good answer is a part of none."""
    server, client = answering()
    for time_ms in (50, 1, 20, 3):
        client.read(NAME, 0, lambda _: None)
        server.reply(_frame("4f08100007000000"), time_ms * MS)
        server.clock.run_until(server.clock.now_ns + 60 * MS)
        assert client.latency_ns == time_ms * MS
    client.read(NAME, 0, lambda _: None)
    server.reply(_frame("4f08100007000000"), 107 * MS)  # to the second question, asked after 100 ms
    server.clock.run_until(server.clock.now_ns + 150 * MS)
    assert client.latency_ns == 7 * MS


@pytest.mark.parametrize("segments", [0, 1, 2])
@pytest.mark.parametrize(
    "other", ["8009100000000206", "8008100100000206", "8008110000000206", "4309100001020304",
              "6009100000000000", "a009100000000000"],
)  # fmt: skip
def test_what_is_about_another_object_does_not_disturb_segments(segments: int, other: str) -> None:
    """Only a segment comes without an object; an abort, a first answer and a block have one."""
    server, client = _client(lambda _asked: [])
    found: list[Any] = []
    client.read(NAME, 0, found.append)
    for frame in ("4108100010000000", *SEGMENTS[:segments], other, *SEGMENTS[segments:]):
        assert found == []
        server.reply(_frame(frame))
        server.clock.run_until(server.clock.now_ns + 2 * MS)
    assert found == [TEXT]


# What is wrong


def gave_up(server: Server, found: Any, code: int, index: int = NAME) -> None:
    """The client has sent an abort, and reports it as its own."""
    abort = b"\x80" + struct.pack("<HBI", index, 0, code)
    assert server.asked[-1] == abort
    assert isinstance(found, SdoError)
    assert (found.code, found.by_server) == (code, False)


@pytest.mark.parametrize(
    ("answers", "code"),
    [
        (("6008100000000000",), UNKNOWN),  # the answer to a write
        (("4108100010000000", "2041424344454647"), UNKNOWN),
        (("4108100010000000", "1041424344454647"), TOGGLE),
        (("4108100010000000", SEGMENTS[0], SEGMENTS[0]), TOGGLE),
        (("4108100011000000", *SEGMENTS), LENGTH),
        (("410810000f000000", *SEGMENTS), LENGTH),
    ],
)
def test_a_read_that_goes_wrong_is_aborted_by_the_control(
    answers: tuple[str, ...], code: int
) -> None:
    server, client = answering(*answers)
    gave_up(server, read(server, client), code)


@pytest.mark.parametrize(
    ("answers", "code"),
    [
        (("4f08100000000000",), UNKNOWN),  # the answer to a read
        (("6008100000000000", "0000000000000000"), UNKNOWN),
        (("6008100000000000", "3000000000000000"), TOGGLE),
        (("6008100000000000", "2000000000000000", "2000000000000000"), TOGGLE),
    ],
)
@pytest.mark.parametrize("length", [8, 16])
def test_a_write_that_goes_wrong_is_aborted_by_the_control(
    answers: tuple[str, ...], code: int, length: int
) -> None:
    server, client = answering(*answers)
    found: list[Any] = []
    client.write(NAME, 0, TEXT[:length], found.append)
    server.clock.run_until(90 * MS)
    gave_up(server, found[0], code)


@pytest.mark.parametrize("segments", [0, 1, 2])
def test_an_abort_of_the_server_ends_a_transfer_wherever_it_is(segments: int) -> None:
    answers = ("4108100010000000", *SEGMENTS[:segments], "8008100000000206")
    server, client = answering(*answers)
    found = read(server, client)
    assert (found.code, found.by_server) == (0x06020000, True)
    assert server.asked[-1][0] != 0x80


def test_after_silence_everything_begins_anew_and_the_last_silence_ends_it() -> None:
    """Each attempt is given up with an abort of time-out; a late answer is of no attempt."""
    server, client = answering()
    found: list[Any] = []
    client.read(NAME, 0, found.append)
    client.read(NAME + 1, 0, found.append)
    server.clock.run_until(401 * MS)
    abort = [frame for frame in server.asked if frame[0] == 0x80]
    time_outs = [b"\x80" + struct.pack("<HBI", NAME + n, 0, 0x05040000) for n in (0, 0, 1, 1)]
    assert abort == time_outs
    assert [(each.index, each.code, str(each)) for each in found] == [
        (NAME, None, "no answer"), (NAME + 1, None, "no answer"),
    ]  # fmt: skip
    server.reply(_frame("4f08100007000000"))
    server.clock.run_until(410 * MS)
    assert len(found) == 2
