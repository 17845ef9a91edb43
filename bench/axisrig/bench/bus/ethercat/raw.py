"""A real Ethernet interface with a line of slaves behind it, on a raw socket (Linux).

The slaves are the last ones of the line of whoever sends: frames come in, are changed, and go out
by the same interface.
"""

import array
import fcntl
import select
import socket
import struct
from collections import deque
from collections.abc import Callable
from errno import EPERM
from functools import partial
from pathlib import Path
from typing import Final

from axisrig.bench.bus.ethercat.frame import is_ethercat
from axisrig.bench.bus.paced import Arrival
from axisrig.kernel.errors import UserError
from axisrig.kernel.profiles.ethercat.layouts import ETHERTYPE, FRAME_MAX
from axisrig.kernel.time.clock import TimeNs

KEPT: Final = 100_000
_OUTGOING: Final = 4  # of linux/if_packet.h
_GET_ADDRESS: Final = 0x8915  # of linux/sockios.h
_ETHTOOL: Final = 0x8946
_DRIVER_INFO: Final = 3  # of linux/ethtool.h
_DRIVER_BYTES: Final = 196
_LINK_LOCAL: Final = "20"
_ADDRESSES_6: Final = Path("/proc/net/if_inet6")


class RawPort:
    """One interface. answer(frame): lets the slaves act on a frame, which is then sent back.

    is_real: it may be any interface; otherwise it is a virtual one (veth) without an IP address.
    latencies_ns: of the last KEPT frames from their reception to their answer, by `now_ns`.
    frames: how many were answered. latest_ns: the largest latency of all.
    Raises UserError where the interface cannot be used.
    """

    is_waiting = False

    def __init__(
        self,
        interface: str,
        answer: Callable[[bytearray], None],
        now_ns: Callable[[], TimeNs],
        *,
        is_real: bool = False,
    ) -> None:
        self.interface, self._answer, self._now_ns = interface, answer, now_ns
        self.latencies_ns: deque[TimeNs] = deque(maxlen=KEPT)
        self.frames = 0
        self.latest_ns: TimeNs = 0
        if not hasattr(socket, "AF_PACKET"):
            raise UserError(
                "raw Ethernet needs Linux", value=interface, hint="run it on a Linux computer"
            )
        if not is_real:
            _refuse_real(interface)
        try:
            self._socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETHERTYPE))
        except PermissionError as error:
            raise UserError(
                "a raw socket needs the right CAP_NET_RAW",
                value=interface,
                hint="run it as root, or give the Python of this environment the right:"
                " setcap cap_net_raw+ep FILE",
            ) from error
        try:
            self._socket.bind((interface, 0))
        except OSError as error:
            self._socket.close()
            raise UserError(
                f"the interface cannot be opened ({error.strerror})",
                value=interface,
                allowed=_names(),
            ) from error
        self._socket.setblocking(False)

    def close(self) -> None:
        """Let the interface go."""
        self._socket.close()

    def receive(self, timeout_s: float) -> Arrival | None:
        """Wait up to `timeout_s` for the next frame of a master."""
        frame = self._next()
        if frame is None and timeout_s > 0.0:
            select.select((self._socket,), (), (), timeout_s)
            frame = self._next()
        if frame is None:
            return None
        return False, partial(self._act, frame, self._now_ns())

    def _next(self) -> bytearray | None:
        while True:
            try:
                data, address = self._socket.recvfrom(FRAME_MAX)
            except BlockingIOError:
                return None
            except OSError as error:
                if error.errno == EPERM:
                    raise
                return None  # the interface is down; it may come back
            if address[2] != _OUTGOING and is_ethercat(data):
                return bytearray(data)

    def _act(self, frame: bytearray, received_ns: TimeNs) -> None:
        self._answer(frame)
        try:
            self._socket.send(frame)
        except OSError:
            return  # the interface is down or its queue is full: a lost frame
        latency_ns = self._now_ns() - received_ns
        self.frames += 1
        self.latest_ns = max(self.latest_ns, latency_ns)
        self.latencies_ns.append(latency_ns)


def _refuse_real(interface: str) -> None:
    """Refuse an interface that may be somebody's network."""
    hint = "add --real where nothing but a master is on it"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        try:
            socket.if_nametoindex(interface)
        except OSError as error:
            raise UserError(
                "there is no such interface", value=interface, allowed=_names()
            ) from error
        if _has_address(asked, interface):
            raise UserError("the interface has an IP address", value=interface, hint=hint)
        driver = _driver(asked, interface)
    if driver != "veth":
        raise UserError(
            "the interface is no virtual one",
            value=f"{interface} ({driver})",
            allowed="veth",
            hint=hint,
        )


def _names() -> list[str]:
    return [name for _, name in socket.if_nameindex()]


def _has_address(asked: socket.socket, interface: str) -> bool:
    """Whether an interface has an address, beside the one that IPv6 gives each by itself."""
    request = struct.pack("16s16x", interface.encode()[:15])
    try:
        fcntl.ioctl(asked.fileno(), _GET_ADDRESS, request)
    except OSError:
        pass
    else:
        return True
    if not _ADDRESSES_6.exists():
        return False
    lines = [line.split() for line in _ADDRESSES_6.read_text(encoding="ascii").splitlines()]
    return any(words[5] == interface and words[3] != _LINK_LOCAL for words in lines)


def _driver(asked: socket.socket, interface: str) -> str:
    """Return the name of the driver of an interface, "unknown" where it does not say."""
    content = array.array("B", struct.pack("I", _DRIVER_INFO).ljust(_DRIVER_BYTES, b"\x00"))
    address, _ = content.buffer_info()
    request = struct.pack("16sP16x", interface.encode()[:15], address)
    try:
        fcntl.ioctl(asked.fileno(), _ETHTOOL, request)
    except OSError:
        return "unknown"
    return content.tobytes()[4:36].split(b"\x00")[0].decode()
