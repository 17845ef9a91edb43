"""From when on the silence of a drive counts, and of its telegrams: from `begin` on."""

from math import inf
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.canopen.watch import LinkWatch, WatchSettings
from axisrig.kernel.drives.power import Power, PowerRequest
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.canopen.emergency import Emergency
from axisrig.kernel.time.clock import MS, S
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

LIMIT_NS = 40 * MS
TABLE = """pdo,transmission,inhibit_100us,index,sub,bits,signed,field
RPDO1,1,0,0x6040,0,16,no,controlword
RPDO1,1,0,0x607A,0,32,yes,target
TPDO1,1,0,0x6041,0,16,no,statusword
TPDO1,1,0,0x6064,0,32,yes,actual
TPDO4,2,0,0x60E4,1,32,yes,second
"""


def watched(clock: Scheduler, settings: WatchSettings) -> tuple[LinkWatch, Any]:
    """A watch whose drive is in operation, and what it hears."""
    heard: dict[int, Any] = {}
    network = SimpleNamespace(subscribe=heard.__setitem__, send_message=lambda *_a, **_k: None)
    link: Any = SimpleNamespace(
        name="Z", network=network, node_id=3, begin=lambda: None,
        jump_mm=None, power=Power.OPERATING, emergency=None, forget=lambda: None,
        fault=lambda: AxisLink.fault(link), _active_fault=None,
        frozen=None, request=PowerRequest.ON, settings=SimpleNamespace(lag_limit_mm=inf),
        statusword=0x0218,
    )  # fmt: skip
    return LinkWatch(link, clock, settings), heard[0x703]


@pytest.mark.parametrize(
    "settings", [WatchSettings(LIMIT_NS), WatchSettings(guard_ns=LIMIT_NS // 2, life_factor=2)]
)
@pytest.mark.parametrize("is_heard_before", [True, False])
def test_silence_before_begin_does_not_count(
    settings: WatchSettings, is_heard_before: bool
) -> None:
    """The start-up takes 5 s; the limit counts from its end on, to the nanosecond."""
    clock = new_scheduler()
    watch, hear = watched(clock, settings)
    if is_heard_before:
        hear(0x703, bytearray([5]), 0.0)
    clock.run_until(5 * S)
    watch.begin()
    clock.run_until(5 * S + LIMIT_NS)
    assert watch.communication() is None
    clock.run_until(5 * S + LIMIT_NS + 1)
    alarm = watch.communication()
    assert alarm is not None
    assert (alarm.id, alarm.values["ms"]) == (900023, 40)


def test_telegrams_that_stayed_out_before_begin_do_not_count(tmp_path: Any) -> None:
    """60E4 with every second SYNC may be missing three times: the 8th cycle is the alarm."""
    path = tmp_path / "map.csv"
    path.write_text(TABLE)
    heard: dict[int, Any] = {}
    network = SimpleNamespace(subscribe=heard.__setitem__, send_message=lambda *_a: None)
    link = AxisLink(LinkSettings("Z", 1000.0, node_id=3, pdo_map=str(path)), network)

    def cycle() -> None:
        link.begin_cycle()
        heard[0x183](0x183, bytearray.fromhex("3712 00000000"), 0.0)
        link.take()

    for _ in range(7):
        cycle()
    link.begin()
    for _ in range(7):
        cycle()
    with pytest.raises(Alarm, match="900006"):
        cycle()


def test_the_status_word_that_explains_an_emergency_is_waited_for_each_time() -> None:
    """The fault comes a cycle after its emergency, and again after a reset: 900005, not 900025."""
    watch, _ = watched(new_scheduler(), WatchSettings())
    link = watch._link
    for _ in range(3):
        link.power, link.emergency = Power.OPERATING, None
        assert watch.condition() is None
        link.emergency = Emergency.read(b"\x10\x43\x09")
        assert watch.condition() is None
        link.power = Power.FAULT
        found = watch.condition()
        assert found is not None
        assert (found.id, found.values["emcy"][:6]) == (900005, "0x4310")
