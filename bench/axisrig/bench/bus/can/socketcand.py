"""A CAN bus served over TCP: `interface = "axisrig_tcp"`, for who speaks socketcand.

The server is one participant of the bus and the hub of the others: what a client sends reaches it
and every other client. It speaks the raw mode of the socketcand protocol, so python-can's own
`socketcand` interface connects to it, from another process or another machine, without axisrig:

    can.Bus(interface="socketcand", host="127.0.0.1", port=29536, channel="can0")

Everything is non-blocking and in the thread of the caller. There is no arbitration and no bit
rate. The protocol has no remote frames. Nobody is asked who he is: serve a real network only
inside a bench of your own.
"""

import contextlib
import select
import socket
from collections import deque
from typing import Any

import can
from can.typechecking import CanFilters

from axisrig.bench.bus.can.frame import DATA_BYTES_MAX, EXTENDED_ID_MAX, STANDARD_ID_MAX

DEFAULT_PORT = 29536
"""The port of socketcand."""
PORT_MAX = 65535
BUFFER_MAX = 1 << 20
SETTLING_S = 0.02
"""python-can's client takes the last `< ok >` only when nothing follows it in the same piece."""
LINE_MAX = 200
_STANDARD_DIGITS = 3


class _Client:
    """One connection: what of it is not read to the end, what it has not taken yet.

    settling_s: so long it gets no frames yet, counted down while nobody does anything.
    """

    def __init__(self, connection: socket.socket, name: str) -> None:
        self.connection, self.name = connection, name
        self.received = b""
        self.unsent = b""
        self.settling_s = 0.0
        self.is_raw = False

    def flush(self) -> bool:
        """Send what waits; return whether the client is still there."""
        try:
            while self.unsent:
                sent = self.connection.send(self.unsent)
                self.unsent = self.unsent[sent:]
        except (BlockingIOError, InterruptedError):
            return len(self.unsent) < BUFFER_MAX
        except OSError:
            return False
        return True

    def read(self) -> list[str] | None:
        """Return the commands that have come, None when the client has gone."""
        try:
            data = self.connection.recv(65536)
        except (BlockingIOError, InterruptedError):
            return []
        except OSError:
            return None
        if not data:
            return None
        *lines, self.received = (self.received + data).split(b">")
        if len(self.received) > LINE_MAX:
            return None
        return [line.decode("ascii", "replace").strip().lstrip("<").strip() for line in lines]


class SocketcandServer(can.BusABC):
    """A bus on TCP. channel: `address:port`; port 0 takes a free one, see `address`.

    Raises can.CanInitializationError when the address cannot be served.
    """

    def __init__(
        self,
        channel: str | int = f"127.0.0.1:{DEFAULT_PORT}",
        can_filters: CanFilters | None = None,
        **_others: Any,
    ) -> None:
        host, _, port = str(channel).rpartition(":")
        if not (port.isdecimal() and int(port) <= PORT_MAX):
            raise can.CanInitializationError(
                f"{channel} cannot be served: a channel is ADDRESS:PORT"
                f" such as 127.0.0.1:{DEFAULT_PORT}, port 0 for a free one"
            )
        try:
            self._server = socket.create_server((host or "127.0.0.1", int(port)))
        except (OSError, ValueError) as error:
            raise can.CanInitializationError(f"{channel} cannot be served: {error}") from error
        self._server.setblocking(False)
        self.address: tuple[str, int] = self._server.getsockname()[:2]
        self.channel_info = f"socketcand server on {self.address[0]}:{self.address[1]}"
        self._clients: list[_Client] = []
        self._messages: deque[can.Message] = deque()
        super().__init__(channel=channel, can_filters=can_filters)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send to every client. Raises can.CanOperationError for a remote frame."""
        if msg.is_remote_frame or msg.is_fd:
            raise can.CanOperationError("socketcand carries classical data frames only")
        self._relay(msg, None)

    def shutdown(self) -> None:
        """Close every connection."""
        if not self._is_shutdown:
            for client in self._clients:
                client.connection.close()
            self._clients.clear()
            self._server.close()
        super().shutdown()

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if not self._messages:
            self._serve(timeout)
        return (self._messages.popleft() if self._messages else None), False

    def _serve(self, timeout: float | None) -> None:
        """Wait for anything that a client does, and do it."""
        by_socket = {client.connection: client for client in self._clients}
        slow = [client.connection for client in self._clients if client.unsent]
        try:
            readable, writable, _ = select.select([self._server, *by_socket], slow, [], timeout)
        except (OSError, ValueError) as error:
            raise can.CanOperationError(f"the server has failed: {error}") from error
        if timeout and not (readable or writable):
            self._settle(timeout)
        for connection in writable:
            if not by_socket[connection].flush():
                self._drop(by_socket[connection])
        for connection in readable:
            if connection is self._server:
                self._accept()
                continue
            client = by_socket[connection]
            lines = client.read() if client in self._clients else []
            if lines is None:
                self._drop(client)
                continue
            for line in lines:
                self._act(client, line)

    def _settle(self, timeout: float) -> None:
        """Let time pass for clients that have just entered raw mode."""
        for client in self._clients:
            if client.is_raw and client.settling_s > 0.0:
                client.settling_s -= timeout

    def _accept(self) -> None:
        try:
            connection, address = self._server.accept()
        except OSError:
            return  # it has gone again
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        client = _Client(connection, f"{address[0]}:{address[1]}")
        self._clients.append(client)
        self._answer(client, "hi")

    def _drop(self, client: _Client) -> None:
        if client in self._clients:
            self._clients.remove(client)
            with contextlib.suppress(OSError):
                client.connection.close()

    def _answer(self, client: _Client, text: str) -> None:
        client.unsent += f"< {text} >".encode("ascii")
        if not client.flush():
            self._drop(client)

    def _act(self, client: _Client, line: str) -> None:
        """Do what one command says."""
        word, _, rest = line.partition(" ")
        if word == "send" and client.is_raw:
            client.settling_s = 0.0
            msg = _message(rest)
            if msg is None:
                self._answer(client, "error could not parse send command")
                return
            self._messages.append(msg)
            self._relay(msg, client)
        elif word == "echo":
            self._answer(client, "echo")
        elif word in ("open", "rawmode"):
            self._answer(client, "ok")
            client.is_raw, client.settling_s = word == "rawmode", SETTLING_S
        else:
            self._answer(client, "error unknown command")

    def _relay(self, msg: can.Message, sender: _Client | None) -> None:
        digits = 8 if msg.is_extended_id else _STANDARD_DIGITS
        identifier = f"{msg.arbitration_id:0{digits}X}"
        text = f"frame {identifier} {msg.timestamp:.6f} {bytes(msg.data).hex().upper()}"
        for client in list(self._clients):
            if client.is_raw and client.settling_s <= 0.0 and client is not sender:
                self._answer(client, text)


def _message(text: str) -> can.Message | None:
    """Read `<identifier> <length> <byte> ...`, all hexadecimal; None when it is no frame."""
    identifier, *rest = text.split() or [""]
    try:
        can_id, data = int(identifier, 16), bytes(int(byte, 16) for byte in rest[1:])
        length = int(rest[0], 16)
    except (ValueError, IndexError):
        return None
    is_extended = len(identifier) > _STANDARD_DIGITS
    largest = EXTENDED_ID_MAX if is_extended else STANDARD_ID_MAX
    if length != len(data) or length > DATA_BYTES_MAX or not 0 <= can_id <= largest:
        return None
    return can.Message(arbitration_id=can_id, is_extended_id=is_extended, data=data)
