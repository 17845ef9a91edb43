"""A set position becomes the nearest increment, in both directions, whatever the family."""

import struct
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from tests.drives.test_link_by_hand import OPERATION_ENABLED, Wire
from tests.profidrive.test_profidrive_control import SETTINGS as PROFIDRIVE
from tests.profidrive.test_profidrive_control import Bus
from tests.sercos.test_drive_by_hand import FOLLOWS, OPERATES
from tests.sercos.test_drive_by_hand import Bench as SercosBench
from tests.speed_drive.ends import FAMILIES, SETTINGS
from tests.speed_drive.test_speed_drive_stop import COUNTS, KV_PER_S
from tests.speed_drive.test_speed_drive_stop import OPERATES as RUNS

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.drives.power import PowerOrder

UM = 1e-3
NEAREST = [
    (0.4, 0), (0.6, 1), (-0.4, 0), (-0.6, -1), (1234.4, 1234), (1234.6, 1235),
    (-1234.4, -1234), (-1234.6, -1235), (-1.0, -1), (2147483646.6, 2147483647),
    (-2147483647.6, -2147483648),
]  # fmt: skip
"""Set position and what is sent, both in increments."""


def canopen() -> tuple[Any, Callable[[float], int]]:
    """A drive that counts micrometres, and what it is sent for a set position."""
    wire = Wire()
    link = AxisLink(LinkSettings("Z", 1000.0, node_id=3), wire)
    link.begin()

    def sent(set_mm: float) -> int:
        wire.status(OPERATION_ENABLED, 0)
        wire.latch()
        link.take()
        link.send(set_mm)
        return int(struct.unpack("<Hi", wire.sent[0x203][:6])[1])

    return link, sent


def sercos() -> tuple[Any, Callable[[float], int]]:
    bench = SercosBench()

    def sent(set_mm: float) -> int:
        bench.data.forget()
        bench.data.arrived(struct.pack("<H3i", OPERATES | FOLLOWS, 0, 0, 0))
        bench.drive.take()
        bench.drive.send(set_mm)
        return int(struct.unpack("<Hi", bench.data.outputs)[1])

    return bench.drive, sent


def profidrive() -> tuple[Any, Callable[[float], int]]:
    """Its deviation: the axis stands at 0."""
    bus = Bus(replace(PROFIDRIVE, increments_per_mm=1000.0))
    bus.drive.order(PowerOrder.SWITCH_ON)
    bus.cycle(0.0, G1_XIST1=0)
    return bus.drive, lambda set_mm: bus.cycle(set_mm)["XERR"]


@pytest.mark.parametrize(("wanted", "target"), NEAREST)
@pytest.mark.parametrize("family", [canopen, sercos, profidrive])
def test_the_nearest_increment_is_sent(
    family: Callable[[], Any], wanted: float, target: int
) -> None:
    if family is profidrive and abs(target) > 1 << 24:
        target = max(target, -2147483647)  # its largest deviation is the same both ways
    _, sent = family()
    assert sent(wanted * UM) == target


@pytest.mark.parametrize("family", [canopen, sercos, profidrive])
def test_an_axis_is_still_while_its_set_position_is_the_same_increment(
    family: Callable[[], Any],
) -> None:
    """-0.4 to 0.4 are one, from 0.6 on it is another, and back again."""
    drive, sent = family()
    sent(0.0)
    still = []
    for wanted in (0.0, 0.4, -0.4, 0.6, 0.6, 1.4, 0.4, 0.0, -0.6, -1.4, 5.0, 5.0):
        sent(wanted * UM)
        still.append(drive.is_still)
    moves = (3, 6, 8, 10)
    assert still == [number not in moves for number in range(12)]


# Where the CNC closes the loop


class Standing:
    """An axis that stands at an increment, driven by speeds."""

    def __init__(self, family: str, place: int) -> None:
        made = FAMILIES[family]
        self._to_drive, self._from_drive = made.images
        self._port, self._place = ImagePort(), place
        self._shown = {"DRIVE": RUNS, "POSITION": place}
        if family == "conventional":  # the counter of a terminal has 16 bits and begins anywhere
            self._shown["COUNTER"] = place
        self.link = made.link(replace(SETTINGS, echo_cycles=1), self._port, lambda: place)
        self.link.order(PowerOrder.SWITCH_ON)
        self.speed(place)

    def speed(self, wanted: float) -> int:
        """One cycle with a set position in increments; returns SPEED."""
        self._port.receive(self._from_drive.packed(self._shown))
        self.link.take()
        assert self.link.actual_increments == self._place
        self.link.send(wanted / SETTINGS.increments_per_mm)
        assert self._port.outputs is not None
        return self._to_drive.values_of(self._port.outputs)["SPEED"]


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("place", [0, 700, -700])
def test_an_axis_at_the_nearest_increment_of_its_set_position_gets_no_speed(
    family: str, place: int
) -> None:
    """Less than half an increment beside it; more than half is a speed, Kv times the way."""
    axis = Standing(family, place)
    for beside in (0.4, -0.4, 0.45, -0.45):
        axis.speed(place + beside)
        assert axis.speed(place + beside) == 0, beside
    for beside in (0.6, -0.6, 1.0, -1.0):
        axis.speed(place + beside)
        speed_mm_s = KV_PER_S * beside / SETTINGS.increments_per_mm
        assert axis.speed(place + beside) == round(speed_mm_s * COUNTS) != 0, beside


@pytest.mark.parametrize("sign", [1, -1])
def test_the_speed_of_a_loop_is_the_nearest_count(sign: int) -> None:
    """10 1/s by 10.06 um are 0.1006 mm/s, and 100.6 increments a second: 101; 10.04 um: 100."""
    loop = LoopSettings(kv_per_s=10.0, period_s=1e-3)
    wire = Wire()
    link = AxisLink(LinkSettings("Z", 1000.0, node_id=3, loop=loop), wire)
    link.begin()
    link.order(PowerOrder.SWITCH_ON)
    sent = []
    for wanted_um in (0.0, 10.06, 10.04):
        wire.status(OPERATION_ENABLED, 0)
        wire.latch()
        link.take()
        link.send(sign * wanted_um * UM)
        sent.append(struct.unpack("<Hi", wire.sent[0x203][:6])[1])
    assert sent == [0, sign * 101, sign * 100]
