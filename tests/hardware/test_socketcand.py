"""The TCP bus as its clients see it: the texts of socketcand's raw mode, written out by hand."""

import contextlib
import socket
from collections.abc import Iterator

import can
import pytest

from axisrig.bench.bus.can.socketcand import BUFFER_MAX, SocketcandServer, _Client


@pytest.fixture
def server() -> Iterator[SocketcandServer]:
    with SocketcandServer("127.0.0.1:0") as opened:
        yield opened


class Client:
    """A stranger with a socket."""

    def __init__(self, server: SocketcandServer) -> None:
        self.server = server
        self.socket = socket.create_connection(server.address, timeout=5)
        assert self.read() == "< hi >"

    def read(self) -> str:
        self.server.recv(0.05)
        return self.socket.recv(4096).decode()

    def write(self, text: str) -> None:
        self.socket.sendall(text.encode())

    def ask(self, text: str) -> str:
        self.write(text)
        return self.read()


@pytest.fixture
def client(server: SocketcandServer) -> Iterator[Client]:
    made = Client(server)
    assert made.ask("< open can0 >") == "< ok >"
    assert made.ask("< rawmode >") == "< ok >"
    server.recv(0.05)  # it has settled
    yield made
    made.socket.close()


def test_a_frame_of_the_server_reaches_a_client(server: SocketcandServer, client: Client) -> None:
    server.send(can.Message(arbitration_id=0x83, is_extended_id=False, data=b"\x11\xab"))
    assert client.socket.recv(100) == b"< frame 083 0.000000 11AB >"
    server.send(can.Message(arbitration_id=0x80, is_extended_id=False))
    assert client.socket.recv(100) == b"< frame 080 0.000000  >"
    server.send(can.Message(arbitration_id=0x83, is_extended_id=True, data=b"\x01"))
    assert client.socket.recv(100) == b"< frame 00000083 0.000000 01 >"


@pytest.mark.long
def test_a_frame_of_a_client_reaches_server_and_other_clients(
    server: SocketcandServer, client: Client
) -> None:
    other = Client(server)
    other.ask("< open can0 >")
    other.ask("< rawmode >")
    server.recv(0.05)
    client.write("< send 603 8 40 41 60 0 0 0 0 0 >")
    received = server.recv(1.0)
    assert received is not None
    assert (received.arbitration_id, received.is_extended_id) == (0x603, False)
    assert bytes(received.data) == bytes.fromhex("4041600000000000")
    assert other.socket.recv(100) == b"< frame 603 0.000000 4041600000000000 >"
    other.socket.close()


def test_frames_that_come_in_pieces_and_in_heaps_are_put_together(
    server: SocketcandServer, client: Client
) -> None:
    client.write("< send 080 0 >< send 1 1 ")
    first = server.recv(1.0)
    assert first is not None
    assert (first.arbitration_id, first.dlc) == (0x80, 0)
    assert server.recv(0.01) is None
    client.write("f >< send 00000001 0 >")
    second, third = server.recv(1.0), server.recv(1.0)
    assert second is not None
    assert third is not None
    assert (second.arbitration_id, bytes(second.data)) == (1, b"\x0f")
    assert (third.arbitration_id, third.is_extended_id) == (1, True)


@pytest.mark.long(but=1)
@pytest.mark.parametrize(
    "text",
    [
        "< send 800 0 >",
        "< send 83 9 0 0 0 0 0 0 0 0 0 >",
        "< send 83 2 1 >",
        "< send 83 1 100 >",
        "< send 83 >",
        "< send >",
        "< send xyz 0 >",
    ],
)
def test_what_is_no_frame_is_refused_and_the_client_stays(client: Client, text: str) -> None:
    assert client.ask(text).startswith("< error")
    assert client.ask("< echo >") == "< echo >"


@pytest.mark.long
def test_a_client_that_talks_nonsense_without_end_is_put_out(
    server: SocketcandServer, client: Client
) -> None:
    client.write("<" * 5000)
    server.recv(0.05)
    assert client.socket.recv(100) == b""


def test_a_client_that_reads_late_gets_every_frame_whole_and_in_its_order(
    server: SocketcandServer,
) -> None:
    """A connection that takes a part of a piece: the rest waits for it, and what comes behind."""
    here, there = socket.socketpair()
    here.setblocking(False)
    here.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    slow = _Client(here, "slow")
    frames = [b"< frame %03X 0.000000 %016X >" % (n % 0x800, n) for n in range(3000)]
    got = b""
    for begin in range(0, len(frames), 100):
        slow.unsent += b"".join(frames[begin : begin + 100])
        assert slow.flush()
        if begin % 500 == 0:
            got += there.recv(1000)  # less than has come
    assert slow.unsent  # it has not taken all
    while slow.unsent:
        got += there.recv(1 << 20)
        assert slow.flush()
    there.setblocking(False)
    with contextlib.suppress(BlockingIOError):
        while True:
            got += there.recv(1 << 20)
    assert got == b"".join(frames)
    here.close()
    there.close()


def test_a_client_that_reads_nothing_is_put_out_when_its_frames_are_too_many() -> None:
    here, there = socket.socketpair()
    here.setblocking(False)
    dead = _Client(here, "dead")
    dead.unsent = bytes(BUFFER_MAX)
    assert dead.flush()  # what the connection has taken does not count
    dead.unsent = bytes(BUFFER_MAX)
    assert not dead.flush()
    here.close()
    there.close()


@pytest.mark.long
def test_nobody_gets_frames_before_raw_mode(server: SocketcandServer) -> None:
    made = Client(server)
    server.send(can.Message(arbitration_id=1, is_extended_id=False))
    assert made.ask("< open can0 >") == "< ok >"
    made.socket.close()


@pytest.mark.long
def test_a_client_that_opens_again_has_left_raw_mode(
    server: SocketcandServer, client: Client
) -> None:
    """It neither gets frames nor sends any until it asks for raw mode once more."""
    assert client.ask("< open can0 >") == "< ok >"
    server.send(can.Message(arbitration_id=1, is_extended_id=False))
    assert client.ask("< send 2 0 >").startswith("< error")
    assert client.ask("< rawmode >") == "< ok >"
    client.write("< send 3 0 >")
    received = server.recv(1.0)
    assert received is not None
    assert received.arbitration_id == 3


def test_no_frame_follows_the_last_ok_in_the_same_piece(server: SocketcandServer) -> None:
    """python-can's client compares what it reads then as a whole."""
    made = Client(server)
    made.ask("< open can0 >")
    made.write("< rawmode >")
    server.recv(0.001)
    server.send(can.Message(arbitration_id=1, is_extended_id=False))
    assert made.socket.recv(4096) == b"< ok >"
    made.write("< send 2 0 >")  # who speaks has read
    server.recv(0.05)
    server.send(can.Message(arbitration_id=3, is_extended_id=False))
    assert made.socket.recv(4096) == b"< frame 003 0.000000  >"
    made.socket.close()


def test_the_bus_lives_on_when_a_client_has_gone(server: SocketcandServer, client: Client) -> None:
    client.socket.close()
    for _ in range(3):
        server.send(can.Message(arbitration_id=1, is_extended_id=False, data=b"1"))
        assert server.recv(0.01) is None


def test_an_address_in_use_is_an_error(server: SocketcandServer) -> None:
    with pytest.raises(can.CanInitializationError, match="cannot be served"):
        SocketcandServer(f"127.0.0.1:{server.address[1]}")
    with pytest.raises(can.CanInitializationError, match="cannot be served"):
        SocketcandServer("127.0.0.1:port")
