"""The non-blocking SDO client: frames as CiA 301 7.2.4.3 writes them, time-outs, aborts."""

import struct
from collections.abc import Callable
from typing import Any

import canopen
import pytest
from canopen.objectdictionary import ObjectDictionary, ODVariable, datatypes

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.drives.canopen.sdo import SdoClient
from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

NODE = 5
TEXT = 0x2001


class Server:
    """A network with one server that answers as told; keeps what was asked."""

    def __init__(self, clock: Scheduler, answer: Callable[[bytes], list[bytes]]) -> None:
        self.clock, self.answer = clock, answer
        self.asked: list[bytes] = []
        self.listener: Any = None

    def subscribe(self, can_id: int, callback: Any) -> None:
        assert can_id == 0x585
        self.listener = callback

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        assert (can_id, remote) == (0x605, False)
        self.asked.append(bytes(data))
        for frame in self.answer(bytes(data)):
            self.reply(frame)

    def reply(self, frame: bytes, after_ns: int = MS) -> None:
        self.clock.call_at(
            self.clock.now_ns + after_ns, 0, lambda: self.listener(0x585, bytearray(frame), 0.0)
        )


def _client(answer: Callable[[bytes], list[bytes]]) -> tuple[Server, SdoClient]:
    clock = new_scheduler()
    server = Server(clock, answer)
    return server, SdoClient(server, clock, NODE, timeout_ns=100 * MS, attempts=2)


def _frame(text: str) -> bytes:
    return bytes.fromhex(text)


@pytest.mark.parametrize(
    ("data", "frame"),
    [
        (b"\x08", "2f 60 60 00 08 00 00 00"),
        (b"\x64\x00", "2b 72 60 00 64 00 00 00"),
        (b"\x01\x02\x03", "27 72 60 00 01 02 03 00"),
        (b"\xff\xff\xff\xff", "23 65 60 00 ff ff ff ff"),
    ],
)
def test_an_expedited_write_is_one_frame_each_way(data: bytes, frame: str) -> None:
    written = _frame(frame)
    server, client = _client(lambda asked: [b"\x60" + asked[1:4] + bytes(4)])
    results: list[object] = []
    client.write(int.from_bytes(written[1:3], "little"), 0, data, results.append)
    assert server.asked == [written]
    assert results == []  # nothing waits
    server.clock.run_until(2 * MS)
    assert results == [b""]
    assert client.latency_ns == MS
    assert not client.is_busy
    for at_ns in (50 * MS, 60 * MS):  # of the last transfer alone
        server.clock.run_until(at_ns)
        client.write(int.from_bytes(written[1:3], "little"), 0, data, results.append)
        server.clock.run_until(at_ns + 5 * MS)
        assert client.latency_ns == MS


@pytest.mark.parametrize(
    ("answer", "data"),
    [
        ("4f 61 60 00 08 00 00 00", b"\x08"),
        ("4b 61 60 00 34 12 00 00", b"\x34\x12"),
        ("47 61 60 00 01 02 03 00", b"\x01\x02\x03"),
        ("43 61 60 00 78 56 34 12", b"\x78\x56\x34\x12"),
        ("42 61 60 00 78 56 34 12", b"\x78\x56\x34\x12"),  # length not told
    ],
)
def test_an_expedited_read_takes_the_length_that_the_server_tells(answer: str, data: bytes) -> None:
    server, client = _client(lambda _asked: [_frame(answer)])
    results: list[object] = []
    client.read(0x6061, 0, results.append)
    server.clock.run_until(2 * MS)
    assert server.asked == [_frame("40 61 60 00 00 00 00 00")]
    assert results == [data]


def test_an_abort_comes_with_its_code_in_words() -> None:
    server, client = _client(lambda asked: [b"\x80" + asked[1:4] + struct.pack("<I", 0x06090030)])
    results: list[Any] = []
    client.write(0x6060, 0, b"\x63", results.append)
    server.clock.run_until(2 * MS)
    (error,) = results
    assert isinstance(error, SdoError)
    assert (error.index, error.sub, error.code, error.by_server) == (0x6060, 0, 0x06090030, True)
    assert str(error) == "abort 0x06090030, value is not allowed"


def test_a_silent_server_is_asked_again_and_then_given_up() -> None:
    server, client = _client(lambda _asked: [])
    results: list[Any] = []
    client.read(0x1000, 0, results.append)
    server.clock.run_until(199 * MS)
    assert results == []
    server.clock.run_until(200 * MS)
    request, abort = _frame("40 00 10 00 00 00 00 00"), _frame("80 00 10 00 00 00 04 05")
    assert server.asked == [request, abort, request, abort]
    assert (results[0].code, str(results[0])) == (None, "no answer")


def test_requests_run_in_turn_and_a_late_answer_belongs_to_no_other_object() -> None:
    server, client = _client(lambda _asked: [])
    results: list[Any] = []
    client.read(0x1000, 0, results.append)
    client.read(0x1001, 0, results.append)
    server.clock.run_until(250 * MS)  # the first is given up at 200 ms
    assert len(results) == 1
    server.reply(_frame("43 00 10 00 92 01 02 00"))  # late, of 0x1000
    server.reply(_frame("4f 01 10 00 81 00 00 00"), after_ns=2 * MS)
    server.clock.run_until(260 * MS)
    assert results[1] == b"\x81"


def test_a_transfer_that_broke_off_begins_anew() -> None:
    """Silent after the first segment: the second attempt gets the text once, from its begin."""
    silences = [True]
    frames = {
        0x40: "41 08 10 00 09 00 00 00",
        0x60: "00 41 42 43 44 45 46 47",
        0x70: "1b 48 49 00 00 00 00 00",
    }

    def answer(asked: bytes) -> list[bytes]:
        if asked[0] == 0x80 or (asked[0] == 0x70 and silences and silences.pop()):
            return []
        return [_frame(frames[asked[0]])]

    server, client = _client(answer)
    results: list[object] = []
    client.read(0x1008, 0, results.append)
    server.clock.run_until(300 * MS)
    assert results == [b"ABCDEFGHI"]


def test_a_write_that_broke_off_begins_anew() -> None:
    """Silent after the second segment: the second attempt sends all of it, from its begin."""
    silences = [True]

    def answer(asked: bytes) -> list[bytes]:
        if asked[0] == 0x80 or (
            asked[0] & 0x10 and asked[0] < 0x20 and silences and silences.pop()
        ):
            return []
        if asked[0] == 0x21:
            return [_frame("60 08 10 00 00 00 00 00")]
        return [bytes((0x20 | asked[0] & 0x10, *bytes(7)))]

    server, client = _client(answer)
    results: list[object] = []
    client.write(0x1008, 0, b"ABCDEFGHIJKLMNOPQ", results.append)
    server.clock.run_until(300 * MS)
    begin = "21 08 10 00 11 00 00 00"
    first, second, last = "00 41424344454647", "10 48494a4b4c4d4e", "09 4f505100000000"
    abort = "80 08 10 00 00 00 04 05"
    sent = [begin, first, second, abort, begin, first, second, last]
    assert server.asked == [_frame(text) for text in sent]
    assert results == [b""]


def test_a_toggle_bit_that_stands_still_ends_the_transfer() -> None:
    def answer(asked: bytes) -> list[bytes]:
        if asked[0] == 0x40:
            return [_frame("41 08 10 00 14 00 00 00")]
        return [b"\x00" + bytes(7)] if asked[0] in (0x60, 0x70) else []

    server, client = _client(answer)
    results: list[Any] = []
    client.read(0x1008, 0, results.append)
    server.clock.run_until(50 * MS)
    assert server.asked[-1] == _frame("80 08 10 00 00 00 03 05")
    assert (results[0].code, results[0].by_server) == (0x05030000, False)


def test_a_text_shorter_than_announced_is_refused() -> None:
    def answer(asked: bytes) -> list[bytes]:
        if asked[0] == 0x40:
            return [_frame("41 08 10 00 09 00 00 00")]
        return [b"\x01" + b"seven b"] if asked[0] == 0x60 else []

    server, client = _client(answer)
    results: list[Any] = []
    client.read(0x1008, 0, results.append)
    server.clock.run_until(50 * MS)
    assert results[0].code == 0x06070010


# Against the SDO server of canopen


@pytest.mark.parametrize("length", [1, 4, 5, 7, 8, 14, 15, 100])
def test_texts_of_any_length_go_there_and_back_through_canopens_server(length: int) -> None:
    od = ObjectDictionary()
    variable = ODVariable("text", TEXT, 0)
    variable.data_type = datatypes.VISIBLE_STRING
    od.add_object(variable)
    text = bytes(65 + n % 26 for n in range(length))
    clock = new_scheduler()
    with Segment("sdo bus", 1_000_000, clock) as segment:
        node_network: canopen.Network = SimNetwork(segment.port("node")).connect()
        node = canopen.LocalNode(NODE, od)
        node_network[NODE] = node
        client = SdoClient(SimNetwork(segment.port("cnc")).connect(), clock, NODE)
        results: list[Any] = []
        client.write(TEXT, 0, text, results.append)
        clock.run_until(100 * MS)
        assert results == [b""]
        assert bytes(node.data_store[TEXT][0]) == text
        client.read(TEXT, 0, results.append)
        clock.run_until(200 * MS)
        assert results[1] == text
