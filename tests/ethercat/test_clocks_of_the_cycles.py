"""How far the clocks of a line are apart, as the cyclic frames bring it; answers by hand."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.cia402.words import latch_object
from axisrig.kernel.drives.ethercat.image_data import ImageData
from axisrig.kernel.drives.ethercat.link import EthercatLink
from axisrig.kernel.drives.ethercat.master import Master
from axisrig.kernel.drives.ethercat.settings import (
    LineSettings,
    Pdo,
    RegisterInputs,
    SlaveSettings,
)
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

LRW, BRD = 12, 7
BEHIND = 1 << 31
"""Bit 31 of 092C: the clock is behind; the rest is the amount."""
REFERENCE = 1001
WAY_NS = 40 * US


class Cycles:
    """A master with one slave whose registers are its inputs; the test answers each frame."""

    def __init__(self, **line: bool) -> None:
        self.clock, self.sent = new_scheduler(), list[bytes]()
        port: Any = SimpleNamespace(send=self.sent.append)
        settings = LineSettings(name="ec1", period_ns=MS, **{"watches_clocks": True, **line})
        others = [RegisterInputs(axis="terminal", node_id=1, first=0x09AE, size=2)]
        self.master = Master(port, self.clock, settings, [], [], others)
        self.master.others_taken.append(lambda _data: None)
        self.master.prepare(REFERENCE)

    def cycle(self, apart: int | None, later_ns: int = 0, *, is_whole: bool = True) -> int:
        """Run a cycle whose frame comes back with 092C; None: it stays out. Returns the amount."""
        self.clock.run_until(self.clock.now_ns + MS)
        self.master.cycle()
        if apart is not None:
            self.clock.run_until(self.clock.now_ns + WAY_NS + later_ns)
            self.master.received(self.answered(self.sent[-1], apart, is_whole=is_whole))
        return self.master.clocks_off_ns

    def answered(self, sent: bytes, apart: int, *, is_whole: bool) -> bytes:
        frame, at, more = bytearray(sent), 16, True
        while more:
            command, register = frame[at], int.from_bytes(frame[at + 4 : at + 6], "little")
            size = int.from_bytes(frame[at + 6 : at + 8], "little")
            more, size = bool(size & 0x8000), size & 0x7FF
            if command == BRD and register == 0x092C:
                frame[at + 10 : at + 14] = apart.to_bytes(4, "little")
            counter = self.master.image.counter if command == LRW else 1
            at += 10 + size
            frame[at] = counter if is_whole or command != LRW else 0
            at += 2
        return bytes(frame)


def test_clocks_are_off_by_what_the_slaves_show_whatever_its_sign() -> None:
    cycles = Cycles()
    assert [cycles.cycle(apart) for apart in (0, 120, BEHIND | 120, 7, BEHIND)] == [
        0,
        120,
        120,
        7,
        0,
    ]


def test_a_frame_that_took_longer_brought_an_older_time() -> None:
    """What it took more than the shortest one counts on top; the shortest may come later."""
    cycles = Cycles()
    found = [cycles.cycle(50, later_ns) for later_ns in (0, 300, 0, -200, 0)]
    assert found == [50, 350, 50, 50, 250]


def test_what_a_frame_shows_whose_inputs_do_not_count_is_kept_for_the_next_inputs() -> None:
    """The greatest since the inputs before; a frame that stays out shows nothing."""
    cycles = Cycles()
    assert cycles.cycle(10) == 10
    assert cycles.cycle(900, is_whole=False) == 10
    assert cycles.cycle(40, is_whole=False) == 10
    assert cycles.cycle(None) == 10
    assert [cycles.cycle(20), cycles.cycle(20)] == [900, 20]


@pytest.mark.parametrize("off", ["watches_clocks", "compensates_drift", "has_clocks"])
def test_where_nothing_reads_the_clocks_nothing_is_known_of_them(off: str) -> None:
    cycles = Cycles(**{off: False})
    assert [cycles.cycle(900), cycles.cycle(900)] == [0, 0]
    assert b"\x2c\x09" not in b"".join(cycles.sent)


STATUS = (
    MappedObject(0x6041, 0, 16, False, "statusword"),
    MappedObject(0x6064, 0, 32, True, "actual"),
)
OUTPUTS = (
    MappedObject(0x6040, 0, 16, False, "controlword"),
    MappedObject(0x607A, 0, 32, True, "target"),
    MappedObject(0x60E0, 0, 16, False, ""),
)


def link(*inputs: MappedObject) -> EthercatLink:
    made = SlaveSettings(
        "Z", 1000.0, node_id=1, inputs=[Pdo(0x1A00, inputs)],
        outputs=[Pdo(0x1600, OUTPUTS)],
    )  # fmt: skip
    mailbox: Any = SimpleNamespace()
    return EthercatLink(made, ImageData(made, latch_object(1, "POS")), mailbox)


def test_a_second_encoder_is_promised_with_each_cycle_where_the_inputs_carry_it() -> None:
    with_it = link(*STATUS, MappedObject(0x60E4, 1, 32, True, "second"))
    without = link(*STATUS)
    assert (with_it.has_second, without.has_second) == (True, False)
    for period_ns in (MS, 4 * MS):
        assert with_it.second_period_ns(period_ns) == period_ns
        assert without.second_period_ns(period_ns) is None
    assert (with_it.second_increments, without.second_increments) == (None, None)


def test_a_value_of_the_outputs_is_found_by_its_object() -> None:
    """Two of them, with their own values; one that no PDO carries is a KeyError."""
    made = link(*STATUS)
    for values in ((1000, 0), (0, 777), (5, 6)):
        made.set_object(0x60E0, 0, values[0])
        made.set_object(0x607A, 0, values[1])
        assert (made.get_object(0x60E0, 0), made.get_object(0x607A, 0)) == values
    for index, sub in ((0x60E0, 1), (0x60E1, 0), (0x6041, 0)):
        with pytest.raises(KeyError, match="Z"):
            made.get_object(index, sub)
