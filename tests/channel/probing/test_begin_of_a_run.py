"""What a measurement run on the path begins with: its speed, what it may do, how far it may go."""

from math import inf
from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.probing.test_measurement_by_hand import BLOCK, SLOPE, Bench, of

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.rules import MeasuringAxis
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.nc import canon

FASTEST_MM_S, RAPID_MM_S = 400.0, 600.0


class Runs(Bench):
    """Axes whose probes are armed at once; begun: what the path was begun with."""

    def __init__(self, **axes: Any) -> None:
        super().__init__(**axes)
        self.begun: list[dict[str, Any]] = []
        self.braked = 0
        self.asked: list[tuple[Motion, Any]] = []
        path = self.path
        path.dynamics, path.begin = self._dynamics, self._begin
        path.brake = lambda: setattr(self, "braked", self.braked + 1)
        path.transformation = SimpleNamespace(kinematic=None)
        path.is_in_position, path.has_stopped = (lambda: False), False
        for link in self.links.values():
            link.is_clear = link.is_armed = link.is_prepared = True
            link.has_latched, link.latched_mm, link.doubt_mm = False, None, None
            link.actual_increments, link.has_actual = 0, True

    def _dynamics(self, target: Any, motion: Motion, *, overtravel_mm: Any) -> Dynamics | None:
        self.asked.append((motion, dict(overtravel_mm)))
        if not any(target.values()):
            return None
        speed_mm_s = RAPID_MM_S if motion is Motion.RAPID else FASTEST_MM_S
        return Dynamics(SLOPE, SLOPE, SLOPE, speed_mm_s)

    def _begin(self, target: Any, speed: float, dynamics: Dynamics, *, overtravel_mm: Any) -> None:
        self.begun.append(
            {"target": dict(target), "speed": speed, "fastest": dynamics.speed_max_mm_s,
             "beyond": dict(overtravel_mm)}
        )  # fmt: skip

    def go(self, type_: int, feed_mm_s: float | None, **target: float) -> dict[str, Any]:
        feed = None if feed_mm_s is None else feed_mm_s * 60.0
        names = tuple(target)
        command = canon.MeasuringRun(BLOCK, target, names, names, feed, type_)
        self.measurement.begin(command)
        for _ in range(3):
            self.measurement.step()
        (begun,) = self.begun
        return begun


@pytest.mark.parametrize(
    ("type_", "feed", "speed", "fastest"),
    [
        (1, 50.0, 50.0, FASTEST_MM_S), (2, 50.0, 16.0, 100.0), (4, 50.0, 50.0, 100.0),
        (4, 150.0, 100.0, 100.0), (1, 150.0, 150.0, FASTEST_MM_S), (3, 50.0, 50.0, FASTEST_MM_S),
        (1, None, FASTEST_MM_S, FASTEST_MM_S), (4, None, 100.0, 100.0), (1, 900.0, 400.0, 400.0),
    ],
)  # fmt: skip
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_no_override_leads_a_run_past_the_speed_that_its_stroke_allows(
    type_: int, feed: float | None, speed: float, fastest: float, sign: float
) -> None:
    """5 mm at 1000 mm/s² are 100 mm/s, which the path may not pass at 200 % either."""
    bench = Runs(Z=of(5.0))
    begun = bench.go(type_, feed, Z=sign * 10.0)
    assert (begun["speed"], begun["fastest"]) == pytest.approx((speed, fastest))
    assert begun["target"] == {"Z": sign * 10.0}
    assert [motion for motion, _ in bench.asked] == [Motion.MEASURING, Motion.RAPID]
    assert [alarm.id for alarm in bench.warned] == ([900222] if speed == 100.0 else [])


def test_the_smallest_stroke_of_the_moved_axes_counts_and_no_other() -> None:
    for names, fastest in (("XZ", 100.0), ("XY", 200.0), ("YZ", 100.0), ("X", FASTEST_MM_S)):
        bench = Runs(X=of(inf), Y=of(20.0), Z=of(5.0))
        assert bench.go(4, 10.0, **dict.fromkeys(names, 1.0))["fastest"] == pytest.approx(fastest)


@pytest.mark.parametrize(
    ("type_", "beyond"),
    [(1, {"Y": 0.5, "Z": 0.0}), (2, {"Y": 0.5, "Z": 0.75}), (3, {"Y": 0.0, "Z": 0.0})],
)
def test_each_axis_may_go_past_its_target_as_its_type_says(
    type_: int, beyond: dict[str, float]
) -> None:
    """By P-AXIS-00467, type 2 else by P-AXIS-00114, type 3 not at all; for all of the path."""
    bench = Runs(
        Y=MeasuringAxis(offset_mm=0.5, old_offset_mm=9.0), Z=MeasuringAxis(old_offset_mm=0.75)
    )
    assert bench.go(type_, 10.0, Y=1.0, Z=1.0)["beyond"] == beyond
    assert [asked for _, asked in bench.asked] == [beyond] * 2


def test_a_run_that_moves_nothing_is_refused_and_names_the_axes_of_its_block() -> None:
    bench = Runs()
    with pytest.raises(Alarm) as caught:
        bench.go(1, 10.0, Y=0.0, X=0.0)
    assert (caught.value.id, caught.value.values["axes"]) == (900103, "Y X")
    assert (bench.measurement.is_active, bench.measurement.records) == (False, [])


def test_every_axis_of_a_block_and_every_one_that_measures_is_checked_once() -> None:
    bench = Runs()
    command = canon.MeasuringRun(BLOCK, {"Y": 1.0}, ("Y", "X"), ("X", "Z"), 600.0, 1)
    bench.measurement.begin(command)
    assert bench.checked == ["Y", "X", "Z"]
    bench.may_measure["Z"] = False
    with pytest.raises(Alarm) as caught:
        bench.measurement.begin(command)
    assert (caught.value.id, caught.value.values["axis"]) == (50059, "Z")


def test_a_signal_brakes_the_path_and_an_abort_ends_the_run_without_a_result() -> None:
    bench = Runs()
    bench.go(1, 10.0, Z=10.0)
    bench.measurement.step()
    assert (bench.braked, bench.measurement.state_of("Z")) == (0, "MOVING")
    bench.links["Z"].has_latched, bench.links["Z"].latched_mm = True, 4.0
    bench.measurement.step()
    bench.measurement.step()
    assert (bench.braked, bench.measurement.is_active) == (1, True)
    bench.measurement.abort()
    assert (bench.measurement.is_active, bench.measurement.state_of("Z")) == (False, None)
    assert bench.measurement.measured_acs_mm("Z") is None
    assert bench.links["Z"].orders[-1] == "disarm"
