"""A latch at position 0 is one: 0 is a place as any other, for drives of every family."""

from typing import Any

import pytest
from tests.drives.test_latch_check import COUNTER, FakeSdo
from tests.drives.test_link_by_hand import Wire, _link
from tests.profidrive.test_encoder_interface_by_hand import VALUE
from tests.profidrive.test_profidrive_control import POS, SETTINGS, Bus
from tests.sercos.test_drive_by_hand import FOLLOWS, OPERATES, Bench
from tests.sercos.test_sercos_latch_by_hand import BITS, DONE, Probe

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.speed_drive.latch import LatchControl

OLD, PLACE = 990, 40


def test_a_drive_of_cia_402() -> None:
    """Two SYNCs with 0, that was never there before; nothing but 0 for the rest of the run."""
    link, wire = _link()
    for status, latched in ((0x0, OLD), (0x1, OLD), (0x3, 0)):
        wire.probe(status, PLACE, latched)
        link.take()
        if status == 0x0:
            link.arm()
        assert (link.latched_mm, link.is_confirmed()) == (None, False)
    for count in (1, 2):
        wire.probe(0x3, PLACE, 0)
        link.take()
        assert (link.latched_mm, link.is_confirmed()) == (0.0, True)
        assert link.unproved_latches == count  # no SDO asks


def test_a_run_is_prepared_once_sdo_has_the_counter_of_before() -> None:
    """Also a counter of 0; each run asks anew."""
    sdo: Any = FakeSdo()
    link = AxisLink(LinkSettings("Z", 1000.0, node_id=3), Wire(), sdo, proves_latches=True)
    for _ in range(2):
        link.arm()
        assert not link.is_prepared
        assert [index for index, _ in sdo.waiting] == [COUNTER]
        sdo.answer()
        assert link.is_prepared
        link.disarm()


@pytest.mark.parametrize("proves", [True, False])
def test_a_sercos_latch(proves: bool) -> None:
    """The first AT with the bit has 0: what later ones have changes nothing."""
    probe = Probe(proves=proves)
    probe.armed()
    for value in (0, 7, 9):
        probe.take(DONE, value=value)
        assert (probe.latch.increments, probe.latch.has_latched) == (0, True)
    assert probe.latch.is_confirmed() is not proves


def test_a_sercos_drive() -> None:
    bench = Bench(bits=BITS)
    for _ in range(3):
        bench.cycle(OPERATES | FOLLOWS)
    bench.drive.arm()
    for _ in range(3):
        bench.cycle(OPERATES | FOLLOWS)
    assert bench.drive.latched_mm is None
    for _ in range(2):
        bench.cycle(OPERATES | FOLLOWS | DONE, 0, 0, -1310)
        assert (bench.drive.latched_mm, bench.drive.is_confirmed()) == (0.0, True)


def test_a_profidrive_drive() -> None:
    bus = Bus(SETTINGS)
    for _ in range(4):
        bus.cycle(0.0, G1_ZSW=0, G1_XIST2=0)
    bus.drive.arm()
    for status in (0, 0, 0, POS, POS, VALUE, VALUE, VALUE):
        bus.cycle(0.0, G1_ZSW=status, G1_XIST2=0)
    assert bus.drive.has_latched
    for _ in range(3):
        bus.cycle(0.0, G1_ZSW=VALUE, G1_XIST2=0)
    assert (bus.drive.latched_mm, bus.drive.is_confirmed()) == (0.0, True)


def test_a_drive_that_only_takes_a_speed() -> None:
    """None is no value, and 0 is one; a later one takes it away (`latch.csv`)."""
    latch = LatchControl(1)
    latch.take(None, 5, 1)
    latch.arm()
    latch.take(None, 5, 1)
    assert (latch.is_armed, latch.has_latched) == (True, False)
    latch.take(0, PLACE, -3)
    assert (latch.has_latched, latch.value) == (True, None)
    latch.take(0, 99, 7)
    assert (latch.value, latch.place, latch.travel) == (0, PLACE, -3)
    latch.take(1, 99, 7)
    assert (latch.has_latched, latch.value) == (False, None)
