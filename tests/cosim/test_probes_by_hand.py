"""Probes of a plant over FMUs made by hand: where an edge is, and how well that is known."""

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.fmus_by_hand import Fmu, Values

from axisrig.kernel.cosim.fmi.library import EdgeMayBeLostError, PlantError
from axisrig.kernel.cosim.plant import probe
from axisrig.kernel.cosim.plant.edges import make_probe
from axisrig.kernel.cosim.plant.probe import SPEED_GAIN_M_S2, SWITCHING_NS, PlantProbe
from axisrig.kernel.time.clock import MS, US, S

Level = Callable[[int, list[float]], bool]
"""Of a time in ns and the positions that the FMU has."""


class Switch(Fmu):
    """An FMU that gets positions only and reports a level."""

    def __init__(
        self, axes: str, level: Level, *, can_save: bool = True, can_vary: bool = True,
        fixed_step_s: float | None = None, grid_ns: int | None = None,
        supply: float | None = None, **more: Any,
    ) -> None:  # fmt: skip
        groups = [f"{axis}_position" for axis in axes]
        self._groups, self._level, self.is_high = groups, level, False
        inputs = groups if supply is None else [*groups, "switched_on"]
        super().__init__(*inputs, grid_ns=grid_ns, signal=lambda _ns: self.is_high, **more)
        self._supply = supply
        self.can = SimpleNamespace(
            can_save_state=can_save, can_vary_step=can_vary, fixed_step_s=fixed_step_s
        )

    def step_to(self, end_ns: int) -> None:
        super().step_to(end_ns)
        self.is_high = self._level(end_ns, [self.inputs[name] for name in self._groups])

    def step_towards(self, end_ns: int) -> int:
        self.step_to(end_ns)
        return end_ns

    def parts_to(self, end_ns: int) -> Any:
        while self.time_ns < end_ns:
            yield

    def names(self, _causality: str) -> list[str]:
        return list(self.inputs)

    def get(self, _name: str) -> float:
        assert self._supply is not None
        return self._supply

    def save_state(self, _into: Any) -> Any:
        return self.time_ns, self.is_high, dict(self.inputs)

    def restore_state(self, state: Any) -> None:
        self.time_ns, self.is_high = state[:2]
        self.inputs = dict(state[2])


class Rig:
    """Axes that are moved by hand, before one probe."""

    def __init__(self, fmu: Switch, axes: str, *, tells_velocity: bool = True) -> None:
        self.axes: list[Any] = [
            SimpleNamespace(
                motion=[0.0] * 8, tick=(0.0,) * 4, tells_velocity=tells_velocity,
                name=axis,
            )
            for axis in axes
        ]  # fmt: skip
        self.fmu, self.now_ns = fmu, 0
        self.probe: PlantProbe = make_probe(fmu.roles, dict(zip(axes, self.axes, strict=True)))
        self.probe.start(0)

    def place(self, *motions: tuple[float, float]) -> None:
        """Position and velocity of each axis, at the end of a step that began there too."""
        for axis, (position, velocity) in zip(self.axes, motions, strict=True):
            axis.motion[:2] = position, velocity

    def step(self, end_ns: int, *ends: tuple[float, float]) -> int:
        begins = [tuple(axis.motion[:2]) for axis in self.axes]
        self.place(*ends)
        for axis, begin, end in zip(self.axes, begins, ends, strict=True):
            axis.tick = (*begin, *end)
        edges = self.probe.step(self.now_ns, end_ns)
        self.probe.accept(end_ns - self.now_ns)
        self.now_ns = end_ns
        return edges


# Where an edge is


@pytest.mark.parametrize(
    ("v", "a", "at_m"),
    [(0.02, 0.0, 3e-6), (0.02, 50.0, 7.77e-6), (0.001, -200.0, -2e-6), (-0.3, 100.0, -1e-5)],
)
def test_an_edge_is_enclosed_on_the_way_between_the_ends_of_a_step(
    v: float, a: float, at_m: float
) -> None:
    """x = v t + a t²/2 is the cubic through its own ends; t of x = at_m by its root."""
    rises = at_m > 0.0
    fmu = Switch("z", lambda _ns, x: (x[0] >= at_m) if rises else (x[0] <= at_m))
    rig = Rig(fmu, "z")
    rig.place((0.0, v))
    h = 400e-6
    assert rig.step(400 * US, (v * h + a * h * h / 2, v + a * h)) == 1
    root = math.sqrt(v * v + 2 * a * at_m)
    t = at_m / v if not a else min(x for x in ((-v + root) / a, (-v - root) / a) if x > 0.0)
    ((edge_ns, level),) = rig.probe.signal.edges
    assert level is True
    assert 0 <= edge_ns - t * S <= 1.001
    assert rig.probe.edge_uncertainty_ns == 1.0
    assert fmu.time_ns == 400 * US
    assert fmu.inputs["z_position"] == rig.axes[0].motion[0]


@pytest.mark.parametrize(
    ("can_save", "can_vary", "by_time", "fixed_us", "grid_us", "expected_us"),
    [
        (True, True, False, 70, 80, 0.001), (True, True, True, None, None, 40),
        (True, True, True, 70, None, 70), (True, True, True, 70, 80, 80),
        (False, True, False, None, None, 40), (True, False, False, 30, None, 40),
        (False, False, False, 90, 80, 90), (False, True, False, None, 100, 100),
    ],
)  # fmt: skip
def test_an_edge_is_known_to_the_longest_step_that_may_hide_it(
    can_save: bool, can_vary: bool, by_time: bool, fixed_us: int | None, grid_us: int | None,
    expected_us: float,
) -> None:  # fmt: skip
    """The steps are 40 and 20 us, the edge is at 50 us; an FMU may step longer inside."""
    level: Level = (lambda ns, _x: ns >= 50 * US) if by_time else (lambda _ns, x: x[0] >= 5e-6)
    fmu = Switch(
        "z", level, can_save=can_save, can_vary=can_vary,
        fixed_step_s=None if fixed_us is None else fixed_us * 1e-6,
        grid_ns=None if grid_us is None else grid_us * US,
    )  # fmt: skip
    rig = Rig(fmu, "z")
    rig.place((0.0, 0.1))
    assert rig.step(40 * US, (4e-6, 0.1)) == 0
    assert rig.probe.edge_uncertainty_ns == 1.0
    assert rig.step(60 * US, (6e-6, 0.1)) == 1
    ((edge_ns, level_),) = rig.probe.signal.edges
    assert level_ is True
    assert edge_ns == pytest.approx(50 * US if can_save and can_vary else 60 * US, abs=1)
    assert rig.probe.edge_uncertainty_ns == pytest.approx(expected_us * US, abs=1e-9)
    rig.step(70 * US, (0.0, -0.1))  # and what comes later is not better known
    assert rig.probe.edge_uncertainty_ns == pytest.approx(expected_us * US, abs=1e-9)


@pytest.mark.parametrize("first_by_time", [True, False])
def test_of_several_edges_the_one_that_is_known_worst_counts(first_by_time: bool) -> None:
    """One that time alone brings is known to the 40 us of its step, the other one to 1 ns."""
    by_time_us, by_place_us = (50, 110) if first_by_time else (110, 50)

    def level(ns: int, x: list[float]) -> bool:
        return (ns >= by_time_us * US) is not (x[0] >= by_place_us * 1e-7)

    rig = Rig(Switch("z", level), "z")
    rig.place((0.0, 0.1))
    known = []
    for end_us in (40, 80, 120, 160):
        rig.step(end_us * US, (end_us * 1e-7, 0.1))
        known.append(rig.probe.edge_uncertainty_ns)
    assert [at / US for at, _ in rig.probe.signal.edges] == pytest.approx([50, 110], abs=2e-3)
    after = 40_000.0 if first_by_time else 1.0
    assert known == [1.0, after, 40_000.0, 40_000.0]


def test_an_axis_that_tells_no_velocity_is_known_to_its_step() -> None:
    rig = Rig(Switch("z", lambda _ns, x: x[0] >= 5e-6), "z", tells_velocity=False)
    rig.place((0.0, 0.1))
    rig.step(40 * US, (4e-6, 0.1))
    assert rig.probe.edge_uncertainty_ns == 1.0
    rig.step(60 * US, (6e-6, 0.1))
    assert rig.probe.edge_uncertainty_ns == 20 * US


@pytest.mark.parametrize(
    ("first", "second", "is_known"),
    [(True, True, True), (True, False, False), (False, True, False), (False, False, False)],
)
def test_every_axis_tells_its_velocity_where_an_edge_is_known_to_1_ns(
    first: bool, second: bool, is_known: bool
) -> None:
    rig = Rig(Switch("xz", lambda _ns, x: x[0] >= 5e-6), "xz")
    rig.axes[0].tells_velocity, rig.axes[1].tells_velocity = first, second
    rig.place((0.0, 0.1), (0.0, 0.0))
    rig.step(60 * US, (6e-6, 0.1), (0.0, 0.0))
    assert rig.probe.edge_uncertainty_ns == (1.0 if is_known else 60 * US)


def test_an_edge_that_falls_counts_as_one_that_rises() -> None:
    rig = Rig(Switch("z", lambda _ns, x: x[0] < 5e-6), "z")
    rig.fmu.is_high = True
    rig.probe.start(0)
    rig.place((0.0, 0.1))
    assert rig.step(40 * US, (4e-6, 0.1)) == 0
    assert rig.step(60 * US, (6e-6, 0.1)) == 1
    ((edge_ns, level),) = rig.probe.signal.edges
    assert (edge_ns, level) == (pytest.approx(50 * US, abs=1), False)


# Where no edge can be


@pytest.mark.parametrize("speeds", [(0.02,), (0.02, -0.3), (0.0, 0.0, 0.4)])
def test_the_way_to_the_next_edge_is_used_up_at_the_bound_of_all_axes(
    speeds: tuple[float, ...],
) -> None:
    """v t + g sqrt(n) t²/2 = room, from |v| of all axes and the clearance."""
    names, room = "xyz"[: len(speeds)], 1e-3
    rig = Rig(Switch(names, lambda _ns, _x: False, clearance=room), names)
    rig.place(*[(0.0, speed) for speed in speeds])
    free_ns = rig.probe.look_ahead(0, 20 * MS)
    t, g = free_ns / S, SPEED_GAIN_M_S2 * math.sqrt(len(speeds))
    assert math.hypot(*speeds) * t + g * t * t / 2 == pytest.approx(room, rel=1e-5)
    rig.probe.look_back_ns = 300 * US
    rig.probe.free_until_ns = 0
    assert rig.probe.look_ahead(0, 20 * MS) == free_ns - 300 * US


@pytest.mark.parametrize("clearance", [0.0, -1e-3, -math.inf])
def test_an_axis_at_an_edge_or_beyond_it_has_no_room(clearance: float) -> None:
    rig = Rig(Switch("z", lambda _ns, _x: False, clearance=clearance), "z")
    rig.place((0.0, 0.02))
    assert rig.probe.look_ahead(MS, 20 * MS) == MS


def test_a_clearance_without_end_is_a_kilometre() -> None:
    """1000 m from rest at 500 m/s2: 2 s."""
    rig = Rig(Switch("z", lambda _ns, _x: False, clearance=math.inf), "z")
    assert rig.probe.look_ahead(0, 20 * MS) == 2 * S


def test_what_an_axis_has_moved_since_its_clearance_was_read_is_room_no_more() -> None:
    rig = Rig(Switch("xy", lambda _ns, _x: False, clearance=1e-3), "xy")
    rig.place((0.3e-3, 0.1), (-0.4e-3, 0.0))
    rig.fmu.time_ns = 5 * MS  # it is there already: its clearance is that of before
    free_ns = rig.probe.look_ahead(5 * MS, 20 * MS) - 5 * MS
    t, g = free_ns / S, SPEED_GAIN_M_S2 * math.sqrt(2)
    assert 0.1 * t + g * t * t / 2 == pytest.approx(0.5e-3, rel=1e-5)
    rig.place((0.9e-3, 0.1), (-0.9e-3, 0.0))
    rig.probe.free_until_ns = 0
    with pytest.raises(EdgeMayBeLostError, match="x, y gained more speed"):
        rig.probe.look_ahead(6 * MS, 20 * MS)


@pytest.mark.parametrize(
    ("speed", "is_lost"), [(0.5, False), (1.05, True), (-1.05, True), (0.9, False)]
)
def test_an_axis_may_gain_speed_by_the_bound_only_while_a_probe_is_passed_over(
    speed: float, is_lost: bool
) -> None:
    """From 0.5 m/s by 500 m/s2 over 1 ms to 1 m/s; 0.5 mm was the room."""
    rig = Rig(Switch("z", lambda _ns, _x: False, clearance=0.5e-3), "z")
    rig.place((0.0, 0.5))
    rig.probe.look_ahead(0, 20 * MS)
    rig.place((0.4e-3, speed))
    if is_lost:
        with pytest.raises(EdgeMayBeLostError):
            rig.probe.passed_over(MS)
    else:
        rig.probe.passed_over(MS)


def test_a_probe_is_followed_after_an_edge_and_after_it_was_switched(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(probe, "Exchange", lambda fmu, names: Values(fmu, tuple(names)))
    fmu = Switch("z", lambda _ns, x: x[0] >= 5e-6, clearance=1.0, supply=1.0)
    rig = Rig(fmu, "z")
    rig.probe.hold_ns = 2 * MS
    rig.place((0.0, 0.1))
    rig.step(100 * US, (10e-6, 0.1))
    for now_ns, is_free in ((100 * US, False), (2 * MS, False), (2050 * US, True)):
        assert (rig.probe.look_ahead(now_ns, MS) > now_ns) is is_free
    fmu.time_ns = rig.now_ns = 3 * MS
    rig.step(3100 * US, (0.0, 0.1))  # the second edge, back at 5 um again
    assert [level for _, level in rig.probe.signal.edges] == [True, False]
    for now_ns, is_free in ((3100 * US, False), (5 * MS, False), (5100 * US, True)):
        rig.probe.free_until_ns = 0
        assert (rig.probe.look_ahead(now_ns, MS) > now_ns) is is_free
    for number, is_on in enumerate((True, False, False, True)):
        now_ns = (10 + 2 * number) * MS
        fmu.written.clear()
        rig.probe.switch(is_on, now_ns)
        switched = [new for _, new in fmu.written if "switched_on" in new]
        is_new = number in (1, 3)
        assert switched == [{"switched_on": float(is_on)}] * is_new
        assert rig.probe.is_switched_on is is_on
        if is_new:
            assert fmu.time_ns == now_ns
            assert rig.probe.look_ahead(now_ns + SWITCHING_NS - 1, MS) == now_ns + SWITCHING_NS - 1
            assert rig.probe.look_ahead(now_ns + SWITCHING_NS, MS) > now_ns + SWITCHING_NS


def test_an_edge_where_the_clearance_allows_none_is_an_error() -> None:
    rig = Rig(Switch("z", lambda ns, _x: ns >= 3 * MS, clearance=1.0, supply=0.0), "z")
    assert not rig.probe.is_switched_on
    rig.probe.wake(2 * MS)
    with pytest.raises(PlantError, match="an edge came where its clearance"):
        rig.probe.wake(3 * MS)
