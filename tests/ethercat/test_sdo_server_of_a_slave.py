"""SDO transfers and emergencies of a slave, byte by byte and without a line."""

from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.ethercat.coe import SdoServer
from axisrig.bench.drive.ethercat.coe_server import CoeServer

REQUEST, RESPONSE = "0020", "0030"  # CoE: service 2 and 3 in bits 12 to 15
TOGGLE, COMMAND, LENGTH, TOO_LONG = "00000305", "01000405", "10000706", "12000706"


class Objects:
    """Objects of 20 bytes for who writes; reading gives as many bytes as the low byte of the index.

    written: index, sub-index and data.
    """

    size = 20

    def __init__(self) -> None:
        self.written: list[tuple[int, int, str]] = []

    def upload(self, index: int, sub: int, *, complete: bool) -> bytes:
        return bytes(range(index & 0xFF))

    def writable_size(self, index: int, sub: int) -> int:
        return self.size

    def check_size(self, index: int, sub: int, size: int, *, complete: bool) -> None:
        if size != self.size:
            raise SdoAbortedError(0x06070012 if size > self.size else 0x06070013)

    def download(self, index: int, sub: int, data: bytes, *, complete: bool) -> None:
        self.written.append((index, sub, data.hex()))


class Server:
    """The server with a mailbox of so many bytes; requests and answers without the CoE head."""

    def __init__(self, mailbox_bytes: int = 32) -> None:
        self.objects = Objects()
        objects: Any = self.objects
        self.server = SdoServer(objects, lambda: mailbox_bytes)

    def ask(self, request: str) -> str:
        answer = self.server.request(bytes.fromhex(REQUEST + request)).hex()
        head, data = answer[:4], answer[4:]
        assert head == (REQUEST if data[:2] == "80" else RESPONSE)
        return data


DATA = bytes(range(20))


def _begin(server: Server, first: int, size: int = 20) -> str:
    """Begin a download of `size` bytes to 2000:1 with the `first` ones of DATA."""
    return server.ask("21002001" + size.to_bytes(4, "little").hex() + DATA[:first].hex())


@pytest.mark.parametrize("padding", ["", "ffffff"])
def test_a_download_in_one_message_has_its_size_and_no_padding(padding: str) -> None:
    server = Server(64)
    assert server.ask("2100200114000000" + DATA.hex() + padding) == "6000200100000000"
    assert server.objects.written == [(0x2000, 1, DATA.hex())]


def test_segments_of_a_download_and_their_unused_bytes() -> None:
    """Unused bytes are of a segment of 7; a longer one is as long as its message."""
    server = Server()
    assert _begin(server, 6) == "6000200100000000"
    assert server.ask("00" + DATA[6:15].hex()) == "2000000000000000"  # 9 bytes
    # toggle, 2 of 7 unused, last
    assert server.ask("15" + DATA[15:20].hex() + "ffff") == "3000000000000000"
    assert server.objects.written == [(0x2000, 1, DATA.hex())]
    _begin(server, 6)
    server.ask("0e" + DATA[6:15].hex())  # what would be unused of 7 does not count for 9
    server.ask("15" + DATA[15:20].hex() + "0000")
    assert server.objects.written[1:] == [(0x2000, 1, DATA.hex())]


@pytest.mark.parametrize(
    ("segments", "code"),
    [
        (["00" + "00" * 15], TOO_LONG),  # one byte more than announced
        (["00" + "00" * 7, "10" + "00" * 7, "01" + "00" * 7], TOO_LONG),
        (["01" + "00" * 7], LENGTH),  # the last one, and one byte fewer
        (["10" + "00" * 7], TOGGLE),
        (["00" + "00" * 7, "00" + "00" * 7], TOGGLE),
    ],
)
def test_a_download_that_goes_wrong_ends_and_writes_nothing(segments: list[str], code: str) -> None:
    server = Server()
    _begin(server, 6)
    for segment in segments[:-1]:
        assert server.ask(segment)[:2] in ("20", "30")
    assert server.ask(segments[-1]) == "80002001" + code
    assert server.objects.written == []
    assert server.ask("00" + "00" * 7) == "80002001" + COMMAND  # none is under way
    _begin(server, 20)
    assert len(server.objects.written) == 1


def test_a_size_that_is_wrong_is_refused_before_its_data() -> None:
    server = Server()
    assert _begin(server, 6, 21) == "80002001" + TOO_LONG
    assert _begin(server, 6, 19) == "80002001" + "13000706"
    assert server.ask("00" + "00" * 7) == "80002001" + COMMAND


@pytest.mark.parametrize("size", [5, 16, 17, 38, 39, 61])
def test_an_upload_has_as_much_in_each_message_as_the_mailbox_holds(size: int) -> None:
    """32 bytes less heads: 16 in the first message, 23 in each segment; few are filled up to 7."""
    server = Server()
    first = server.ask(f"40{size:02x}2001" + "00000000")
    assert first[:8] == f"41{size:02x}2001"
    assert int.from_bytes(bytes.fromhex(first[8:16]), "little") == size
    found = bytes.fromhex(first[16:])
    assert len(found) == min(size, 16)
    toggle = 0
    while len(found) < size:
        answer = bytes.fromhex(server.ask(f"{0x60 | toggle:02x}" + "00" * 7))
        left = size - len(found)
        part = min(left, 23)
        unused = max(7 - part, 0)
        assert answer[0] == toggle | unused << 1 | (left <= 23)
        assert len(answer) == 1 + max(part, 7)
        found += answer[1 : 1 + part]
        toggle ^= 0x10
    assert found == bytes(range(size))
    assert server.ask("60" + "00" * 7)[-8:] == COMMAND


READ_5, READ_2, ABORT = "4005200100000000", "4002200100000000", "8000200100000405"
UP, DOWN = "60" + "00" * 7, "00" + "00" * 7


@pytest.mark.parametrize("request_", [READ_2, READ_5, ABORT, "21002001" + "14000000" + "11" * 20,
                                      "2300200111223344", "a000200100000000"])  # fmt: skip
@pytest.mark.parametrize("is_upload", [True, False])
def test_a_new_request_ends_the_transfer_that_a_master_gave_up(
    is_upload: bool, request_: str
) -> None:
    """Given up after an odd number of segments: nothing of it is left, neither data nor toggle."""
    for segment in (UP, "70" + UP[2:], DOWN, "10" + DOWN[2:]):
        assert _given_up(is_upload, request_).ask(segment)[-8:] == COMMAND
    server = _given_up(is_upload, request_)
    written = len(server.objects.written)
    for _ in range(2):
        server.ask("4080200100000000")
        first = server.ask(UP)
        assert (first[:2], first[2:]) == ("00", bytes(range(16, 39)).hex())
    _begin(server, 6)
    server.ask(DOWN[:2] + DATA[6:9].hex())
    _begin(server, 6)
    assert server.ask("01" + DATA[6:].hex()) == "2000000000000000"
    assert server.objects.written[written:] == [(0x2000, 1, DATA.hex())]


def _given_up(is_upload: bool, request_: str) -> Server:
    """A transfer of which one segment came, then a request that ends it."""
    server = Server()
    if is_upload:
        server.ask("4080200100000000")
        assert server.ask(UP)[:2] == "00"
    else:
        _begin(server, 6)
        assert server.ask("00" + DATA[6:9].hex() + "0" * 8)[:2] == "20"
    server.objects.size = 4 if request_.startswith("23") else 20
    server.server.request(bytes.fromhex(REQUEST + request_))
    server.objects.size = 20
    return server


def test_an_emergency_has_code_register_and_first_own_byte() -> None:
    sent: list[str] = []

    class Box:
        def send(self, kind: int, data: bytes) -> None:
            sent.append(f"{int(kind)} {data.hex()}")

    box: Any = Box()
    CoeServer.emergency(box, 0x8250, 0x11, 9)
    assert sent == ["3 0010" + "5082" + "11" + "0900000000"]


@pytest.mark.parametrize("last", range(1, 8))
def test_a_last_segment_of_any_length_is_filled_up_to_7(last: int) -> None:
    """Bits 1 to 3 of its head: how many of the 7 bytes are none of the object."""
    server = Server()
    size = 6 + last
    server.objects.size = size
    assert _begin(server, 6, size) == "6000200100000000"
    head = bytes((7 - last << 1 | 1,)).hex()
    filled = DATA[6:size].ljust(7, b"\xee").hex()
    assert server.ask(head + filled) == "2000000000000000"
    assert server.objects.written == [(0x2000, 1, DATA[:size].hex())]


@pytest.mark.parametrize("abort", [ABORT, "80000000" + "00000405", "8000200155443322"])
@pytest.mark.parametrize("transfer", ["", "up", "down"])
def test_an_abort_of_the_master_has_no_answer(abort: str, transfer: str) -> None:
    """CiA 301: it ends what is under way, whatever object and code it names."""
    server = Server()
    if transfer == "up":
        server.ask("4080200100000000")
    elif transfer == "down":
        _begin(server, 6)
    assert server.server.request(bytes.fromhex(REQUEST + abort)) == b""
    for segment in (UP, DOWN):
        assert server.ask(segment)[-8:] == COMMAND
    assert server.objects.written == []
    assert server.ask(READ_2)[:2] == "4b"  # two of four bytes


@pytest.mark.parametrize("command", ["a0", "c0", "e0"])
def test_a_command_that_there_is_not_is_refused_with_its_object(command: str) -> None:
    """Only an abort goes without an answer."""
    server = Server()
    assert server.ask(command + "002001" + "00000000") == "80002001" + COMMAND
