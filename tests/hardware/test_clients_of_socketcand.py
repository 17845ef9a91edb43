"""What a client of the TCP bus is answered, when it gets frames, and how it leaves."""

import contextlib
import select
import socket
import struct
import time
from collections.abc import Iterator

import can
import pytest

from axisrig.bench.bus.can.socketcand import LINE_MAX, SocketcandServer, _Client, _message


@pytest.fixture
def server() -> Iterator[SocketcandServer]:
    with SocketcandServer("127.0.0.1:0") as opened:
        yield opened


def frame(can_id: int, data: bytes = b"", **others: bool) -> can.Message:
    return can.Message(
        arbitration_id=can_id, is_extended_id=can_id > 0x7FF, data=data or None, **others
    )


class Client:
    """Somebody in raw mode, who has settled unless `is_new`."""

    def __init__(self, server: SocketcandServer, *, is_new: bool = False) -> None:
        self.server = server
        self.socket = socket.create_connection(server.address, timeout=5)
        assert self.until(b"< hi >") == b"< hi >"
        assert self.ask("< open can0 >") == b"< ok >"
        assert self.ask("< rawmode >") == b"< ok >"
        if not is_new:
            server.recv(0.03)

    def until(self, end: bytes) -> bytes:
        """Return what comes, and its end; the server serves, and lets no time pass."""
        found = b""
        while not found.endswith(end):
            self._wait()
            part = self.socket.recv(4096)
            assert part, "the server has closed the connection"
            found += part
        return found

    def ask(self, text: str) -> bytes:
        """Return all that has come until the answer."""
        self.socket.sendall(text.encode())
        return self.until(b"< echo >" if text.endswith("< echo >") else b" >")

    def is_out(self) -> bool:
        """Wait until the server has closed the connection; whatever comes before is an error."""
        self._wait()
        return self.socket.recv(4096) == b""

    def _wait(self) -> None:
        """Let the server serve until something has come; nothing for 5 s fails the test."""
        for _ in range(5000):
            self.server.recv(0)
            if select.select([self.socket], [], [], 0.001)[0]:
                return
        pytest.fail("nothing has come for 5 s")


@pytest.mark.long
def test_a_client_settles_only_while_nobody_does_anything(server: SocketcandServer) -> None:
    """A frame of another one comes at once: the second that the server would wait is not over."""
    other, new = Client(server), Client(server, is_new=True)
    for number in (1, 2):
        other.socket.sendall(f"< send {number} 0 >".encode())
        received = server.recv(1.0)
        assert received is not None
        assert received.arbitration_id == number
    server.send(frame(3))
    assert new.ask("< echo >") == b"< echo >"
    server.recv(0.03)
    server.send(frame(4))
    assert new.until(b">") == b"< frame 004 0.000000  >"


@pytest.mark.long
def test_raw_mode_again_settles_again(server: SocketcandServer) -> None:
    client = Client(server)
    assert client.ask("< rawmode >") == b"< ok >"
    server.send(frame(1))
    assert client.ask("< echo >") == b"< echo >"
    server.recv(0.03)
    server.send(frame(2))
    assert client.until(b">") == b"< frame 002 0.000000  >"


@pytest.mark.long
def test_a_frame_does_not_come_back_to_who_has_sent_it(server: SocketcandServer) -> None:
    one, two = Client(server), Client(server)
    one.socket.sendall(b"< send 1 1 aB >")
    assert server.recv(1.0) is not None
    assert one.ask("< echo >") == b"< echo >"
    assert two.ask("< echo >") == b"< frame 001 0.000000 AB >< echo >"


@pytest.mark.parametrize(
    ("text", "can_id", "is_extended", "data"),
    [
        ("0 0", 0, False, ""),
        ("7ff 8 0 1 2 3 4 5 6 ff", 0x7FF, False, "00010203040506ff"),
        ("1FFFFFFF 1 0A", 0x1FFFFFFF, True, "0a"),
        ("0000 0", 0, True, ""),  # more than three digits
    ],
)
def test_the_largest_frames_pass(
    server: SocketcandServer, text: str, can_id: int, is_extended: bool, data: str
) -> None:
    client = Client(server)
    client.socket.sendall(f"< send {text} >".encode())
    received = server.recv(1.0)
    assert received is not None
    found = (received.arbitration_id, received.is_extended_id, bytes(received.data).hex())
    assert found == (can_id, is_extended, data)
    assert received.dlc == len(data) // 2


@pytest.mark.long
def test_words_of_a_refusal_and_nothing_reaches_the_bus(server: SocketcandServer) -> None:
    client, other = Client(server), Client(server)
    for text in ("800 0", "20000000 0", "-1 0", "1 9 1 2 3 4 5 6 7 8 9", "1 2 1", "1 1 100", "1"):
        answer = client.ask(f"< send {text} >")
        assert answer == b"< error could not parse send command >"
    for text in ("sendx 1 0", "close", ""):
        assert client.ask(f"< {text} >") == b"< error unknown command >"
    assert client.ask("< open can0 >") == b"< ok >"
    assert client.ask("< send 1 0 >") == b"< error unknown command >"  # not in raw mode any more
    assert server.recv(0) is None
    assert other.ask("< echo >") == b"< echo >"


@pytest.mark.parametrize(
    "message",
    [frame(1, is_remote_frame=True), frame(1, is_fd=True)],
)
def test_what_the_protocol_does_not_carry_is_refused(
    server: SocketcandServer, message: can.Message
) -> None:
    client = Client(server)
    with pytest.raises(can.CanOperationError, match="classical data frames only"):
        server.send(message)
    assert client.ask("< echo >") == b"< echo >"


@pytest.mark.long
@pytest.mark.parametrize(("more", "is_out"), [(0, False), (1, True)])
def test_a_command_that_does_not_end_has_its_limit(
    server: SocketcandServer, more: int, is_out: bool
) -> None:
    client = Client(server)
    client.socket.sendall(b"x" * (LINE_MAX + more))
    if is_out:
        assert client.is_out()
    else:
        assert client.ask(">< echo >") == b"< error unknown command >< echo >"


@pytest.mark.long
def test_a_connection_that_takes_no_more_gets_the_rest_in_order_when_it_reads(
    server: SocketcandServer,
) -> None:
    """Another client gets its frames meanwhile."""
    slow = socket.socket()
    slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
    slow.connect(server.address)
    slow.sendall(b"< rawmode >")
    server.recv(0.03)
    slow.setblocking(False)
    quick = Client(server)
    texts = [f"< frame {n % 2048:03X} 0.000000 {n:016X} >".encode() for n in range(4000)]
    got = b""
    for number in range(len(texts)):
        server.send(frame(number % 2048, number.to_bytes(8, "big")))
        with contextlib.suppress(BlockingIOError):
            got += quick.socket.recv(1 << 16, socket.MSG_DONTWAIT)
    assert got == b"".join(texts)
    whole, late, waits = b"< hi >< ok >" + got, b"", 0
    while len(late) < len(whole):
        try:
            late += slow.recv(1 << 16)
        except BlockingIOError:
            assert len(late) > 0
            waits += 1
            assert waits < 5000, "the rest has not come in 5 s"
            server.recv(0.001)
    assert late == whole


@pytest.mark.long
def test_who_leaves_takes_nobody_along(server: SocketcandServer) -> None:
    """Two at once, one of them with a command that is not finished."""
    one, two, stays = Client(server), Client(server), Client(server)
    one.socket.sendall(b"< send 1 ")
    one.socket.close()
    two.socket.close()
    for number in range(2, 5):
        server.send(frame(number))
        assert server.recv(0.01) is None
    whole = b"".join(b"< frame %03X 0.000000  >" % number for number in range(2, 5))
    assert stays.ask("< echo >") == whole + b"< echo >"


def test_a_server_that_closes_closes_its_connections_and_frees_its_address() -> None:
    server = SocketcandServer(":0")  # no address is this machine alone
    assert server.address[0] == "127.0.0.1"
    client = Client(server)
    server.shutdown()
    server.shutdown()
    assert client.socket.recv(100) == b""
    with SocketcandServer(f"127.0.0.1:{server.address[1]}") as again:
        assert again.address == server.address
        assert str(server.address[1]) in again.channel_info


@pytest.mark.parametrize("channel", ["65536", "-1", "127.0.0.1", "127.0.0.1:", "127.0.0.1:1x"])
def test_a_channel_that_is_no_address_is_refused_with_an_example(channel: str) -> None:
    with pytest.raises(can.CanInitializationError) as error:
        SocketcandServer(channel)
    assert str(error.value).startswith(f"{channel} cannot be served: a channel is ADDRESS:PORT")
    assert "127.0.0.1:29536" in str(error.value)


@pytest.mark.long
def test_filters_are_those_of_the_server_not_of_its_clients(server: SocketcandServer) -> None:
    one, two = Client(server), Client(server)
    server.set_filters([{"can_id": 0x100, "can_mask": 0x7FF, "extended": False}])
    one.socket.sendall(b"< send 1 0 >< send 100 0 >")
    received = server.recv(1.0)
    assert received is not None
    assert received.arbitration_id == 0x100
    assert two.ask("< echo >") == b"< frame 001 0.000000  >< frame 100 0.000000  >< echo >"


@pytest.mark.long
@pytest.mark.parametrize("is_reset", [False, True])
def test_a_server_waits_again_when_a_client_has_gone(
    server: SocketcandServer, is_reset: bool
) -> None:
    """Whoever asked it again and again would keep a processor busy."""
    client = Client(server)
    if is_reset:  # the connection breaks, without a word
        client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    client.socket.close()
    for _ in range(2):
        server.recv(0.01)
    begin_s = time.monotonic()
    assert server.recv(0.05) is None
    assert time.monotonic() - begin_s > 0.04


def test_what_is_there_is_read_before_anything_is_waited_for(server: SocketcandServer) -> None:
    client = Client(server)
    client.socket.sendall(b"< send 1 0 >< send 2 0 >< send 3 0 >")
    received = [server.recv(5.0)]
    begin_s = time.monotonic()
    received += [server.recv(5.0), server.recv(5.0)]
    assert time.monotonic() - begin_s < 2.0
    assert [msg.arbitration_id for msg in received if msg] == [1, 2, 3]


def test_commands_in_one_piece_may_be_many(server: SocketcandServer) -> None:
    """The limit is that of one command that does not end."""
    client = Client(server)
    client.socket.sendall(b"".join(b"< send %X 0 >" % n for n in range(LINE_MAX)))
    received = [server.recv(1.0) for _ in range(LINE_MAX)]
    assert [msg.arbitration_id for msg in received if msg] == list(range(LINE_MAX))


def test_a_connection_says_whether_its_client_is_there() -> None:
    here, there = socket.socketpair()
    here.setblocking(False)
    one = _Client(here, "one")
    assert one.read() == []  # it has sent nothing
    there.sendall(b"<open can0>< rawmode ><send 1")
    assert one.read() == ["open can0", "rawmode"]
    there.sendall(b" 0 >")
    assert one.read() == ["send 1 0"]
    there.close()
    assert one.read() is None
    one.unsent = b"< ok >"
    assert not one.flush()
    here.close()
    assert one.read() is None
    assert not one.flush()


@pytest.mark.long
@pytest.mark.parametrize("value", ["0", "7", "0f", "a", "ff", "0FF"])
def test_bytes_are_hexadecimal_however_they_are_written(
    server: SocketcandServer, value: str
) -> None:
    one, two = Client(server), Client(server)
    one.socket.sendall(f"< send 010 1 {value} >".encode())
    received = server.recv(1.0)
    assert received is not None
    assert (received.arbitration_id, bytes(received.data)) == (0x10, bytes([int(value, 16)]))
    assert two.ask("< echo >") == b"< frame 010 0.000000 %02X >< echo >" % int(value, 16)


def test_a_server_without_an_address_is_that_of_socketcand(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def taken(address: tuple[str, int]) -> socket.socket:
        raise OSError(f"{address[0]} has {address[1]} in use")

    monkeypatch.setattr(socket, "create_server", taken)
    with pytest.raises(can.CanInitializationError) as error:
        SocketcandServer()
    assert str(error.value) == "127.0.0.1:29536 cannot be served: 127.0.0.1 has 29536 in use"


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("83 2 0A ff", (0x83, False, b"\x0a\xff")),
        ("7FF 0", (0x7FF, False, b"")),
        ("001 8 1 2 3 4 5 6 7 8", (1, False, bytes(range(1, 9)))),
        ("00000083 1 0", (0x83, True, b"\0")),  # more than three digits: 29 bits
        ("0083 0", (0x83, True, b"")),
        ("1FFFFFFF 0", (0x1FFF_FFFF, True, b"")),
        ("800 0", None),
        ("20000000 0", None),
        ("-1 0", None),
        ("83 2 1", None),
        ("83 1 1 2", None),
        ("83 0 1", None),
        ("83 9 1 2 3 4 5 6 7 8 9", None),
        ("83 1 100", None),
        ("83 1 -1", None),
        ("83", None),
        ("", None),
        ("xyz 0", None),
    ],
)
def test_a_frame_has_an_identifier_a_length_and_so_many_bytes(
    text: str, read: tuple[int, bool, bytes] | None
) -> None:
    found = _message(text)
    if read is None:
        assert found is None
        return
    assert found is not None
    assert (found.arbitration_id, found.is_extended_id, bytes(found.data)) == read
