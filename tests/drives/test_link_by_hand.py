"""The kernel's link with telegrams written by hand: nothing but the link is behind the numbers."""

import struct
from collections.abc import Callable
from typing import Any

from kernel.drives.link import AxisLink, LinkSettings

OPERATION_ENABLED, FAULT = 0x1237, 0x0218


class Wire:
    """Takes what the link sends and brings what the test says."""

    def __init__(self) -> None:
        self.sent: dict[int, bytes] = {}
        self.listeners: dict[int, Callable[[int, bytearray, float], None]] = {}

    def subscribe(self, can_id: int, callback: Any) -> None:
        self.listeners[can_id] = callback

    def send_message(self, can_id: int, data: bytes) -> None:
        self.sent[can_id] = bytes(data)

    def status(self, statusword: int, increments: int) -> None:
        self._bring(0x183, struct.pack("<HiH", statusword, increments, 0))

    def latch(self) -> None:
        self._bring(0x283, struct.pack("<i", 0))

    def _bring(self, can_id: int, data: bytes) -> None:
        self.listeners[can_id](can_id, bytearray(data), 0.0)


def _link(**settings: Any) -> tuple[AxisLink, Wire]:
    wire = Wire()
    link = AxisLink(LinkSettings("Z", 3, 1000.0, **settings), wire)
    link.begin()
    return link, wire


def test_missing_telegrams_leave_more_way_before_a_position_has_jumped() -> None:
    """1 mm per cycle at most; 0.9 mm per cycle over two missing cycles are 2.7 mm."""
    link, wire = _link(jump_mm=1.0)
    for cycle, arrives in enumerate((True, True, False, False, True)):
        if arrives:
            wire.status(OPERATION_ENABLED, 900 * cycle)
        wire.latch()
        link.take()
    assert link.jump_mm is None
    wire.status(OPERATION_ENABLED, 900 * 4 + 1001)
    link.take()
    assert link.jump_mm == 1.001


def test_a_fault_is_acknowledged_by_edges_until_it_is_gone() -> None:
    """The first edge may be lost on the bus, and a bit that is held resets nothing."""
    link, wire = _link(fault_reset=True)
    link.resets_fault = True
    words = []
    for _ in range(4):
        wire.status(FAULT, 0)
        wire.latch()
        link.take()
        link.send(0.0)
        words.append(wire.sent[0x203][0] & 0x80)
    assert words == [0x80, 0, 0x80, 0]
