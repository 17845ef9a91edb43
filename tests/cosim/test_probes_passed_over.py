"""A probe that is not followed: when it is brought up to its axes, and when an edge may be lost."""

import pytest
from tests.cosim.test_edges_of_a_probe import Locating, probe_of
from tests.cosim.test_probes_by_hand import Rig, Switch

from axisrig.kernel.cosim.fmi.library import EdgeMayBeLostError
from axisrig.kernel.time.clock import MS, US

CLEARANCE_M = 1e-3


@pytest.mark.parametrize(
    ("moved_mm", "wanted_us", "is_brought_up"),
    [
        # From rest at 500 m/s2 a way s takes sqrt(s / 250): 0.8 mm 1.78885 ms, 1.2 mm 2.19089 ms
        (0.2, 1_788, False), (0.2, 1_790, True), (0.2, 2_190, True), (0.2, 2_191, False),
        # A step becomes twice as long where the way ahead may be four times as long: from 0.6 mm on
        (0.59, 20_000, False), (0.61, 20_000, True), (-0.59, 20_000, False), (-0.61, 20_000, True),
        (0.0, 1_999, False), (0.0, 2_001, False),
    ],
)  # fmt: skip
def test_a_probe_is_brought_up_where_a_step_can_become_as_long_as_wanted_or_twice_as_long(
    moved_mm: float, wanted_us: int, is_brought_up: bool
) -> None:
    """Its clearance is then that of where the axis is: 1 mm, 2 ms."""
    rig = Rig(Switch("z", lambda _ns, _x: False, clearance=CLEARANCE_M), "z")
    rig.place((moved_mm * 1e-3, 0.0))
    free_ns = rig.probe.look_ahead(MS, wanted_us * US) - MS
    assert rig.fmu.steps == [MS] * is_brought_up
    room_m = CLEARANCE_M if is_brought_up else CLEARANCE_M - abs(moved_mm) * 1e-3
    assert free_ns == pytest.approx((room_m / 250) ** 0.5 * 1e9, abs=1.0)


def test_a_probe_that_stands_at_its_axes_is_not_brought_up() -> None:
    rig = Rig(Switch("z", lambda _ns, _x: False, clearance=CLEARANCE_M), "z")
    rig.fmu.time_ns = MS
    rig.place((0.9e-3, 0.0))
    rig.probe.look_ahead(MS, 20 * MS)
    assert rig.fmu.steps == []


@pytest.mark.parametrize(
    ("clearance_mm", "speed_m_s", "is_lost"),
    [
        # From 0.5 m/s by 500 m/s2 over 1 ms to 1 m/s at most; 1.05 m/s are 1.05 mm in it at most
        (0.5, 1.0, False), (0.5, 1.05, True), (1.04, 1.05, True), (1.06, 1.05, False),
        (1.06, -1.05, False), (1.04, -1.05, True), (1.06, 1.07, True), (20.0, 15.0, False),
    ],
)  # fmt: skip
def test_a_gain_of_speed_is_harmless_where_the_way_was_shorter_than_the_room(
    clearance_mm: float, speed_m_s: float, is_lost: bool
) -> None:
    rig = Rig(Switch("z", lambda _ns, _x: False, clearance=clearance_mm * 1e-3), "z")
    rig.place((0.0, 0.5))
    rig.probe.look_ahead(0, 20 * MS)
    rig.place((0.4e-3, speed_m_s))
    if is_lost:
        with pytest.raises(EdgeMayBeLostError, match="z gained more speed than 500 m/s2"):
            rig.probe.passed_over(MS)
    else:
        rig.probe.passed_over(MS)


@pytest.mark.parametrize(("speed_m_s", "is_lost"), [(0.99, False), (1.01, True)])
def test_a_gain_of_speed_counts_from_the_last_look_on(speed_m_s: float, is_lost: bool) -> None:
    """From 0.5 m/s at 5 ms on 500 m/s2 lead to 1 m/s at 6 ms; the room of 0.5 mm is used up."""
    rig = Rig(Switch("z", lambda _ns, _x: False, clearance=0.5e-3), "z")
    rig.place((0.0, 0.5))
    rig.probe.look_ahead(0, 20 * MS)
    rig.probe.look_ahead(5 * MS, 20 * MS)
    rig.place((0.4e-3, speed_m_s))
    if is_lost:
        with pytest.raises(EdgeMayBeLostError, match="z gained more speed than 500 m/s2"):
            rig.probe.passed_over(6 * MS)
    else:
        rig.probe.passed_over(6 * MS)


@pytest.mark.parametrize(
    ("up_us", "down_us", "held_us"), [(30, 70, 170), (70, 30, 170), (30, None, 130)]
)
def test_a_probe_is_followed_so_long_after_the_last_edge_of_a_step(
    up_us: int, down_us: int | None, held_us: int
) -> None:
    fmu = Locating((up_us,), () if down_us is None else (down_us,), level=0.0)
    fmu.outputs["clearance"] = 1.0
    probe = probe_of(fmu)
    probe.hold_ns = 100 * US
    probe.step(0, 100 * US)
    probe.accept(100 * US)
    assert probe.look_ahead(held_us * US - 1, MS) == held_us * US - 1
    assert probe.look_ahead(held_us * US, MS) > held_us * US + MS
