"""The position loop of the CNC: by hand, in its telegrams, and closed over an ideal speed loop."""

import struct
from collections import deque
from collections.abc import Callable
from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis
from tests.drives.test_link_by_hand import OPERATION_ENABLED, Wire

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.servo import Servo
from axisrig.bench.oracles.position_loop import gain_limit, ramp_lag_mm
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.position_loop import LoopSettings, PositionLoop
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

QUICK_STOP = 0x1217
KV, PERIOD_S = 10.0, 1e-3


def test_the_set_speed_is_gain_times_lag_and_what_is_fed_forward() -> None:
    loop = PositionLoop(LoopSettings(KV, PERIOD_S, 0.5))
    loop.hold(2.0, 1.0)
    assert loop.lag_mm == 1.0
    assert loop.speed_mm_s(2.01, 1.5) == pytest.approx(10.0 * 0.51 + 0.5 * 0.01 / PERIOD_S)
    assert loop.lag_mm == pytest.approx(0.51)
    assert loop.speed_mm_s(2.0, 2.5) == pytest.approx(-10.0 * 0.5 - 0.5 * 0.01 / PERIOD_S)
    assert PositionLoop(LoopSettings(KV, PERIOD_S)).speed_mm_s(3.0, 1.0) == 20.0


@pytest.fixture
def link() -> tuple[AxisLink, Wire]:
    wire = Wire()
    settings = LinkSettings("Z", 1000.0, node_id=3, loop=LoopSettings(KV, PERIOD_S, 1.0))
    made = AxisLink(settings, wire)
    made.begin()
    return made, wire


def cycle(link: AxisLink, wire: Wire, word: int, increments: int, set_mm: float) -> int:
    """Bring an actual position, send a set one; return 60FF."""
    wire.status(word, increments)
    wire.latch()
    link.take()
    link.send(set_mm)
    return int(struct.unpack("<HiH", wire.sent[0x203])[1])


def test_the_telegram_carries_a_speed_while_the_drive_follows(link: tuple[AxisLink, Wire]) -> None:
    """1000 increments per mm, Kv 10 1/s, feed-forward 1; without power and in a stop it is 0."""
    made, wire = link
    made.keeps_operating = True
    assert cycle(made, wire, 0x0250, 4000, 5.0) == 0
    assert cycle(made, wire, OPERATION_ENABLED, 4000, 5.0) == 10_000
    assert made.is_still
    assert made.lag_mm == 1.0
    assert cycle(made, wire, OPERATION_ENABLED, 4500, 5.02) == 5200 + 20_000
    assert not made.is_still
    assert made.lag_mm == pytest.approx(0.52)
    assert cycle(made, wire, QUICK_STOP, 4600, 6.02) == 0
    # What the set position has moved meanwhile is no speed
    assert cycle(made, wire, OPERATION_ENABLED, 6020, 6.02) == 0


def test_an_axis_that_its_drive_leads_gets_no_speed_and_has_no_lag(
    link: tuple[AxisLink, Wire],
) -> None:
    made, wire = link
    made.leads_itself = True
    assert cycle(made, wire, OPERATION_ENABLED, 4000, 5.0) == 0
    assert made.lag_mm == 0.0
    assert cycle(made, wire, OPERATION_ENABLED, 90_000, 90.0) == 0
    made.leads_itself = False
    assert cycle(made, wire, OPERATION_ENABLED, 90_000, 90.0) == 0


def test_a_speed_beyond_32_bits_stays_at_their_end(link: tuple[AxisLink, Wire]) -> None:
    made, wire = link
    for increments, expected in ((-2_000_000_000, 2**31 - 1), (2_000_000_000, -(2**31 - 1))):
        assert cycle(made, wire, OPERATION_ENABLED, increments, 0.0) == expected


def closed(
    gain: float, dead: int, demand: str, cycles: int, set_mm: Callable[[int], float]
) -> list[float]:
    """Lags of the controller with a drive in csv over an axis that follows its speed exactly.

    dead: dead cycles; one of them is the way to the next SYNC.
    """
    scheduler, axis = new_scheduler(), FakeAxis()
    profile = DriveProfile(velocity_demand=demand, encoder_increments=1 << 26)  # type: ignore[arg-type]
    ignore: Any = lambda *_: None  # noqa: E731
    servo = Servo(axis, (None, None), profile, ignore, scheduler, ignore)
    servo.image.mode, servo.image.interpolation_value, servo.image.interpolation_index = 9, 1, -3
    servo.update()
    for now_ms, word in ((1, 0x06), (2, 0x07), (3, 0x0F)):
        servo.begin(now_ms * MS)
        servo.image.controlword = word
        servo.cycle(now_ms * MS)
    per_mm = float(profile.units_per_mm)
    loop, lags = PositionLoop(LoopSettings(gain / PERIOD_S, PERIOD_S)), []
    waiting = deque([0] * (dead - 1))
    for k in range(cycles):
        speed = loop.speed_mm_s(set_mm(k), servo.image.position_actual / per_mm)
        lags.append(loop.lag_mm)
        waiting.append(round(speed * per_mm))
        now_ns = (k + 4) * MS
        servo.begin(now_ns)
        servo.image.target_velocity = waiting.popleft()
        servo.cycle(now_ns)
    return lags


@pytest.mark.parametrize("demand", ["held", "interpolated"])
@pytest.mark.parametrize("dead", [1, 2, 3])
def test_the_loop_is_stable_up_to_its_limit_within_two_percent(dead: int, demand: str) -> None:
    """A step of 1 mm: what is left of it falls below the limit and grows above it."""
    limit = gain_limit(dead, is_held=demand == "held")
    for share, grows in ((0.98, False), (1.02, True)):
        lags = closed(share * limit, dead, demand, 160, lambda _: 1.0)
        early, late = (max(map(abs, lags[n : n + 40])) for n in (20, 120))
        assert (late > early) is grows, (share, early, late)


def test_a_ramp_lags_by_speed_over_gain() -> None:
    """10 mm/s with Kv 40 1/s; 1 ms: after 300 ms e^-12 of it is missing."""
    lags = closed(0.04, 1, "interpolated", 300, lambda k: 0.01 * (k + 1))
    assert lags[-1] == pytest.approx(ramp_lag_mm(10.0, 40.0), abs=2e-6)
