"""A raw socket on an interface of Linux: which frames are answered, and which interfaces it takes.

`Sockets` stands for the kernel's side (packet(7), netdevice(7)): what has come with its packet
type, addresses and driver of an interface.
"""

import errno
import struct
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.ethercat.line import frame, physical

from axisrig.bench.bus.ethercat import raw
from axisrig.bench.bus.ethercat.raw import RawPort
from axisrig.kernel.errors import UserError

HOST, OUTGOING = 0, 4  # packet types of linux/if_packet.h
ASKED = [frame(physical(7, 0, place, 1)) for place in (0, 0x10, 0x20)]
FOREIGN = ASKED[0][:12] + b"\x08\x00" + ASKED[0][14:]  # IPv4


class Sockets:
    """The module `socket` for one interface, v7. waiting: packets and errors that `recvfrom` gives.

    late: what comes only while somebody waits. refuses: error of each call by its name.
    """

    AF_PACKET, AF_INET, SOCK_RAW, SOCK_DGRAM = 17, 2, 3, 2

    def __init__(self) -> None:
        self.waiting: list[Any] = []
        self.late: list[Any] = []
        self.refuses: dict[str, OSError] = {}
        self.sent: list[bytes] = []
        self.calls: list[tuple[Any, ...]] = []
        self.addresses: set[str] = set()
        self.drivers = {"v7": "veth"}

    def _call(self, *call: Any) -> "Sockets":
        self.calls.append(call)
        if call[0] in self.refuses:
            raise self.refuses[call[0]]
        return self

    def socket(self, family: int, *_: int) -> "Sockets":
        return self._call("raw" if family == self.AF_PACKET else "asked")

    def bind(self, address: tuple[str, int]) -> None:
        self._call("bind", address)

    def setblocking(self, blocks: bool) -> None:
        self._call("setblocking", blocks)

    def close(self) -> None:
        self._call("close")

    def __enter__(self) -> "Sockets":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def fileno(self) -> int:
        return 9

    def recvfrom(self, _size: int) -> tuple[bytes, tuple[Any, ...]]:
        if not self.waiting:
            raise BlockingIOError
        found = self.waiting.pop(0)
        if isinstance(found, OSError):
            raise found
        kind, data = found
        return data, ("v7", 0x88A4, kind, 1, b"\x02" * 6)

    def send(self, data: bytearray) -> int:
        self._call("send")
        self.sent.append(bytes(data))
        return len(data)

    def select(self, readers: tuple[Any, ...], *rest: Any) -> None:
        assert readers == (self,)
        self._call("select", rest[-1])
        self.waiting += self.late

    @staticmethod
    def htons(word: int) -> int:
        return int.from_bytes(word.to_bytes(2, "little"), "big")

    def if_nametoindex(self, name: str) -> int:
        if name not in self.drivers:
            raise OSError("no such device")
        return 1

    def if_nameindex(self) -> list[tuple[int, str]]:
        return list(enumerate(self.drivers, 1))

    def ioctl(self, _file: int, request: int, content: bytes) -> bytes:
        """SIOCGIFADDR 8915 and SIOCETHTOOL 8946 with ETHTOOL_GDRVINFO; the name comes first."""
        name = content[:16].rstrip(b"\x00").decode()
        if request == 0x8915:
            if name not in self.addresses:
                raise OSError(errno.EADDRNOTAVAIL, "none")
            return content
        assert request == 0x8946
        if not self.drivers[name]:
            raise OSError(errno.EOPNOTSUPP, "does not say")
        return content


@pytest.fixture
def sockets(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Sockets:
    found = Sockets()
    monkeypatch.setattr(raw, "socket", found)
    monkeypatch.setattr(raw, "select", found)
    monkeypatch.setattr(raw, "fcntl", found)
    monkeypatch.setattr(raw, "_ADDRESSES_6", tmp_path / "if_inet6")
    return found


class Times:
    """A clock that goes on when it is set alone."""

    ns = 0

    def __call__(self) -> int:
        return self.ns


def _port(answer: Callable[[bytearray], None], times: Times) -> RawPort:
    return RawPort("v7", answer, times, is_real=True)


def test_the_frames_of_a_master_are_answered_and_no_others(sockets: Sockets) -> None:
    """Neither what the port has sent itself, nor what is no EtherCAT, nor half a head."""
    times = Times()

    def answer(asked: bytearray) -> None:
        asked[6] |= 2
        times.ns += 50

    port = _port(answer, times)
    assert sockets.calls == [("raw",), ("bind", ("v7", 0)), ("setblocking", False)]
    sockets.waiting = [
        (OUTGOING, ASKED[0]), (HOST, FOREIGN), (HOST, ASKED[1][:20]), (HOST, ASKED[1]),
        (OUTGOING, ASKED[1]), (1, ASKED[2]),
    ]  # fmt: skip
    arrivals = []
    for at_ns in (1000, 3000):
        times.ns = at_ns
        arrivals.append(port.receive(0.0))
    assert port.receive(0.0) is None
    times.ns = 4000
    for arrival in arrivals:
        assert arrival is not None
        is_sync, act = arrival
        assert not is_sync
        act()
    assert sockets.sent == [sent[:6] + bytes((sent[6] | 2,)) + sent[7:] for sent in ASKED[1:]]
    # From the reception on, not from the answer: 4050 - 1000, 4100 - 3000
    assert list(port.latencies_ns) == [3050, 1100]
    assert (port.frames, port.latest_ns) == (2, 3050)
    assert "select" not in [call[0] for call in sockets.calls]
    port.close()
    assert sockets.calls[-1] == ("close",)


def test_an_answer_that_the_interface_does_not_take_is_a_lost_frame(sockets: Sockets) -> None:
    times = Times()
    port = _port(lambda _: None, times)
    for error in (OSError(errno.ENETDOWN, "down"), OSError(errno.ENOBUFS, "full"), None):
        sockets.refuses = {"send": error} if error else {}
        sockets.waiting = [(HOST, ASKED[0])]
        arrival = port.receive(0.0)
        assert arrival is not None
        times.ns += 100
        arrival[1]()
    assert sockets.sent == [ASKED[0]]
    assert (port.frames, list(port.latencies_ns), port.latest_ns) == (1, [100], 100)


@pytest.mark.parametrize("timeout_s", [0.0, 0.25])
def test_a_latency_begins_when_its_frame_is_there_not_with_the_wait_for_it(
    sockets: Sockets, monkeypatch: pytest.MonkeyPatch, timeout_s: float
) -> None:
    """Of three frames the middle one is waited for 9000 ns; each is answered 70 ns after it came.

    A wait that brings none leaves nothing behind either.
    """
    times = Times()
    wait = sockets.select

    def select(readers: tuple[Any, ...], *rest: Any) -> None:
        times.ns += 9000
        wait(readers, *rest)

    monkeypatch.setattr(sockets, "select", select)
    port = _port(lambda _: None, times)
    for number, is_late in enumerate((False, timeout_s > 0.0, False), 1):
        sockets.waiting, sockets.late = [], []
        assert port.receive(timeout_s) is None
        came = sockets.late if is_late else sockets.waiting
        came.append((HOST, ASKED[0]))
        arrival = port.receive(timeout_s)
        assert arrival is not None
        times.ns += 70
        arrival[1]()
        assert list(port.latencies_ns) == [70] * number
        assert (port.frames, port.latest_ns) == (number, 70)


@pytest.mark.parametrize("late", [[], [(HOST, ASKED[0])], [(OUTGOING, ASKED[0])]])
def test_a_wait_ends_by_a_frame_or_with_its_time(sockets: Sockets, late: list[Any]) -> None:
    port = _port(lambda _: None, Times())
    sockets.late = late
    assert (port.receive(0.25) is not None) is (late[:1] == [(HOST, ASKED[0])])
    assert sockets.calls[3:] == [("select", 0.25)]


def test_an_interface_that_is_down_may_come_back_and_a_right_that_is_gone_may_not(
    sockets: Sockets,
) -> None:
    port = _port(lambda _: None, Times())
    sockets.waiting = [OSError(errno.ENETDOWN, "down"), (HOST, ASKED[0])]
    assert port.receive(0.0) is None
    assert port.receive(0.0) is not None
    sockets.waiting = [OSError(errno.EPERM, "not permitted")]
    with pytest.raises(PermissionError):
        port.receive(0.0)


@pytest.mark.parametrize(
    ("refuses", "words", "is_closed"),
    [
        ({"raw": PermissionError(errno.EPERM, "no")}, "CAP_NET_RAW", False),
        ({"bind": OSError(errno.ENODEV, "No such device")}, r"opened \(No such device\)", True),
    ],
)
def test_an_interface_that_cannot_be_used_is_named(
    sockets: Sockets, refuses: dict[str, OSError], words: str, is_closed: bool
) -> None:
    sockets.refuses = refuses
    with pytest.raises(UserError, match=words) as raised:
        _port(lambda _: None, Times())
    assert raised.value.value == "v7"
    assert (sockets.calls[-1] == ("close",)) is is_closed


def test_raw_ethernet_is_of_linux(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(raw, "socket", SimpleNamespace())
    with pytest.raises(UserError, match="needs Linux"):
        _port(lambda _: None, Times())


# Of the lines of /proc/net/if_inet6: address, number, prefix, scope, flags, name
LINK_LOCAL = "fe80000000000000 02 40 20 80 v7\n"
GLOBAL, OF_ANOTHER = "20010db800000000 02 40 00 80 v7\n", "20010db800000000 03 40 00 80 v70\n"


@pytest.mark.parametrize(
    ("driver", "addresses", "lines", "refused"),
    [
        ("veth", (), None, None),
        ("veth", (), LINK_LOCAL + OF_ANOTHER, None),
        ("veth", ("v70",), None, None),
        ("veth", ("v7",), None, "IP address"),
        ("veth", (), LINK_LOCAL + GLOBAL, "IP address"),
        ("e1000e", (), None, "no virtual one"),
        ("", (), None, "no virtual one"),
    ],
)
def test_only_a_virtual_interface_without_an_address_is_taken_unasked(
    sockets: Sockets,
    monkeypatch: pytest.MonkeyPatch,
    driver: str,
    addresses: tuple[str, ...],
    lines: str | None,
    refused: str | None,
) -> None:
    sockets.drivers["v7"], sockets.addresses = driver, set(addresses)
    if lines is not None:
        raw._ADDRESSES_6.write_text(lines)

    class DriverInfo:
        """What the kernel has written: 4 bytes of the request, 32 of the name of the driver."""

        def __init__(self, _kind: str, content: bytes) -> None:
            assert content[:4] == struct.pack("I", 3)

        def buffer_info(self) -> tuple[int, int]:
            return 0x1000, 196

        def tobytes(self) -> bytes:
            return struct.pack("I32s160x", 3, driver.encode())

    monkeypatch.setattr(raw, "array", SimpleNamespace(array=DriverInfo))
    if refused is None:
        RawPort("v7", lambda _: None, Times())
        assert ("bind", ("v7", 0)) in sockets.calls
        return
    with pytest.raises(UserError, match=refused) as raised:
        RawPort("v7", lambda _: None, Times())
    assert ("raw",) not in sockets.calls
    assert "--real" in str(raised.value)
    if driver != "veth":
        assert raised.value.value == f"v7 ({driver or 'unknown'})"
    with pytest.raises(UserError, match="no such interface"):
        RawPort("v8", lambda _: None, Times())
