"""Where edges can be, and what a plant does when it cannot know."""

import math
from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.fmu import EdgeMayBeLostError, PlantError
from axisrig.kernel.cosim.plant.probe import SPEED_GAIN_M_S2, free_s
from axisrig.kernel.time.clock import MS, US

Make = Callable[..., Any]
BOUNCER, JUMPER, BENT = "SteppingTest.Bouncer", "SteppingTest.Jumper", "EdgeProof.Bent"


def edges_of(plant: Any, end_ns: int, step_ns: int = MS) -> list[tuple[int, bool]]:
    """Run in SYNCs of 1 ms; return the edges."""
    for time_ns in range(step_ns, end_ns + 1, step_ns):
        plant.advance_to(time_ns)
    edges: list[tuple[int, bool]] = plant.probes["probe"].signal.edges
    return edges


def steps_of(plant: Any, end_ns: int) -> list[int]:
    """The steps of the plant in ns."""
    ends: list[int] = []
    step = plant._step

    def watched(limit_ns: int) -> None:
        step(limit_ns)
        ends.append(plant.now_ns)

    plant._step = watched
    plant.advance_to(end_ns)
    return [b - a for a, b in zip([0, *ends], ends, strict=False)]


@pytest.mark.parametrize("room", [1e-9, 1e-6, 1e-3, 1.0])
@pytest.mark.parametrize("speed", [0.0, 1e-3, 0.1, 2.0])
def test_way_is_used_up_when_the_speed_grows_at_the_bound(room: float, speed: float) -> None:
    t = free_s(room, speed, SPEED_GAIN_M_S2)
    assert speed * t + SPEED_GAIN_M_S2 * t * t / 2 == pytest.approx(room, rel=1e-12)


def test_no_room_is_no_time() -> None:
    assert free_s(0.0, 0.0, SPEED_GAIN_M_S2) == 0.0


@pytest.mark.interpreted
def test_steps_are_long_far_away_and_fine_near(plant: Make) -> None:
    """The load falls 1 mm at 20 mm/s, meets the plane after 50 ms, and goes on."""
    start = {"acceleration_then": 0.0, "position_start": 0.001}
    made = plant(BENT, axis_start=start, probe_start={"surface": 0.0})
    steps = steps_of(made, 60 * MS)
    assert steps[0] == pytest.approx(free_s(1e-3, 0.02, SPEED_GAIN_M_S2) * 1e9, abs=50 * US)
    assert all(step % (50 * US) == 0 for step in steps)
    assert min(steps) == 50 * US
    # Fine only where the ball can reach the plane within two of them: v h + A h^2/2 = 4.5 um
    assert sum(step == 50 * US for step in steps) <= 2 * (4.5e-6 / 0.02 / 50e-6 + 1)
    assert made.probes["probe"].signal.edges == [(50 * MS, True)]


@pytest.mark.interpreted
def test_a_probe_is_asked_again_only_where_its_answer_could_free_a_step(plant: Make) -> None:
    """The load falls 1 mm at 20 mm/s; below 270 um a millisecond is not free: v t + A t^2/2.

    After a look with the clearance c the next one is of use where the way since then is 270 um - c:
    all of it may have led away. SYNCs are 20 um apart, so 260 um are followed by 240, 200 and 120;
    or where twice the time may be free.
    """
    start = {"acceleration_then": 0.0, "position_start": 0.001}
    made = plant(BENT, axis_start=start, probe_start={"surface": 0.0})
    probe = made.probes["probe"]
    places_m: list[float] = []
    catch_up = probe._catch_up

    def noted(now_ns: int) -> None:
        places_m.append(probe.sources[0].motion[0])
        catch_up(now_ns)

    probe._catch_up = noted
    assert edges_of(made, 60 * MS) == [(50 * MS, True)]
    looks_um = [place_m * 1e6 for place_m in places_m if place_m > 1e-4]
    assert looks_um == pytest.approx([260, 240, 200, 120], abs=1e-6)


@pytest.mark.interpreted
def test_probe_without_clearance_is_followed_all_the_time(plant: Make) -> None:
    start = {"acceleration_then": 0.0, "position_start": 0.001}
    made = plant(BENT, axis_start=start, probe_start={"surface": 0.0}, without=("clearance",))
    assert set(steps_of(made, 60 * MS)) == {50 * US}
    assert made.probes["probe"].signal.edges == [(50 * MS, True)]


@pytest.mark.long
def test_several_edges_in_a_fine_step_are_all_found(plant: Make) -> None:
    """The contact opens and closes every 8 us: five edges within 32 us."""
    made = plant(BENT, BOUNCER, probe_start={"surface": -0.0003})
    edges = edges_of(made, 20 * MS)
    touch_ns = round(0.0003 / 0.02 * 1e9)
    assert [level for _, level in edges] == [True, False, True, False, True]
    times_ns = [time_ns for time_ns, _ in edges]
    assert times_ns == pytest.approx([touch_ns + k * 8000 for k in range(5)], abs=1)


@pytest.mark.long
def test_several_edges_are_an_error_when_no_step_can_be_repeated(plant: Make) -> None:
    # The step ends inside the second touch
    made = plant(BENT, BOUNCER, probe_start={"surface": -0.00029961}, can_save=False)
    with pytest.raises(PlantError, match=r"2 edges of one direction inside one step.*fine_us"):
        edges_of(made, 20 * MS)


@pytest.mark.long
def test_motion_that_breaks_the_bound_near_an_edge_is_an_error(plant: Make) -> None:
    """From rest to 5 m/s at once, 1 mm above the plane: faster than 500 m/s2 allows."""
    made = plant(JUMPER, probe_start={"surface": -0.001})
    with pytest.raises(EdgeMayBeLostError, match=r"500 m/s2.*exchange_us") as error:
        edges_of(made, 40 * MS)
    assert error.value.instance == "probe"


def test_in_fine_steps_alone_nothing_is_reckoned_ahead(plant: Make) -> None:
    made = plant(JUMPER, probe_start={"surface": -0.001}, exchange_ns=50 * US)
    ((edge_ns, level), *_) = edges_of(made, 40 * MS)
    assert level is True
    assert edge_ns == pytest.approx(20.5e6 + 1e-3 / 5 * 1e9, abs=1)


def test_far_from_any_edge_the_bound_does_not_matter(plant: Make) -> None:
    made = plant(JUMPER, probe_start={"surface": -1.0})
    ((edge_ns, _), *_) = edges_of(made, 240 * MS)
    assert edge_ns == pytest.approx(20.5e6 + 1.0 / 5 * 1e9, abs=1)


def test_edges_are_the_same_however_the_plant_is_advanced(plant: Make) -> None:
    found = []
    for step_ns, exchange_ns in ((MS, 20 * MS), (10 * MS, 20 * MS), (20 * MS, MS), (MS, 100 * US)):
        made = plant(BENT, probe_start={"surface": -0.0005}, exchange_ns=exchange_ns)
        found.append(edges_of(made, 60 * MS, step_ns))
    assert len(found[0]) == 1
    assert found == [found[0]] * 4
    # v t + a (t - b)^2/2 = -0.5 mm
    t = 0.0234567 + 0.02 - math.sqrt(0.02**2 + 2 * (-0.0005 + 0.02 * 0.0234567))
    assert found[0][0][0] == pytest.approx(t * 1e9, abs=1)


@pytest.mark.parametrize(
    ("fine_us", "internal_us", "expected_us"),
    [(50, 10, 50), (50, 20, 40), (50, 12.5, 50), (50, 80, 50), (30, 25, 25), (50, 0.0031, 49.9999)],
)
def test_fine_step_is_whole_internal_steps(
    plant: Make, fine_us: int, internal_us: float, expected_us: float
) -> None:
    made = plant(BENT, internal_s=internal_us * 1e-6, fine_ns=fine_us * US)
    assert made.fine_ns == round(expected_us * US)


def test_axes_of_different_internal_steps_share_the_fine_step(plant: Make) -> None:
    """20 and 12.5 us: 100 us is too long, so the step stays as it is."""
    made = plant(BENT, internal_s=20e-6, second_internal_s=12.5e-6)
    assert made.fine_ns == 50 * US
    made = plant(BENT, internal_s=20e-6, second_internal_s=12.5e-6, fine_ns=230 * US)
    assert made.fine_ns == 200 * US


@pytest.mark.long
@pytest.mark.parametrize("axis", ["ServoAxis", "ScrewAxis", "GravityAxis"])
def test_library_axes_give_the_same_bits_at_any_step(plant: Make, axis: str) -> None:
    """At 30 mm/s into a plane 2 mm away, with friction, and on behind it."""
    left = []
    for exchange_ns in (50 * US, 200 * US, 20 * MS):
        made = plant(
            f"AxisRig.Drives.{axis}", probe_start={"surface": -2e-3}, exchange_ns=exchange_ns
        )
        servo = made.axes["axis"]
        for sync_ns in range(MS, 200 * MS, 10 * MS):
            made.advance_to(sync_ns)
            servo.command(sync_ns, servo.demand_position_m(), -0.03, sync_ns + 10 * MS, True)
        left.append(
            (made.probes["probe"].signal.edges, made.probes["probe"].contacts, servo.motion)
        )
    assert len(left[0][0]) == 1
    assert left == [left[0]] * 3


@pytest.mark.parametrize(("look_back_us", "hold_us"), [(0, 0), (3000, 0), (0, 2000), (3000, 2000)])
def test_steps_are_fine_for_as_long_as_drives_look_back_and_ahead(
    plant: Make, look_back_us: int, hold_us: int
) -> None:
    """A drive that compensates its delay stores where the axis was before the edge.

    At 20 mm/s a step of 3 ms would do 3 ms before the edge, where there is room for 60 um.
    """
    made = plant(
        BENT,
        axis_start={"acceleration_then": 0.0, "position_start": 0.001},
        probe_start={"surface": 0.0},
        look_back_ns=look_back_us * US,
        hold_ns=hold_us * US,
    )
    ((edge_ns, _),) = edges_of(made, 60 * MS, 10 * MS)
    axis = made.axes["axis"]

    def longest_ns(begin_ns: int, end_ns: int) -> int:
        around = [axis.ends_around(time_ns) for time_ns in range(begin_ns, end_ns, 20 * US)]
        return max(end[0] - begin[0] for begin, end in around)

    before_ns = longest_ns(edge_ns - 3000 * US, edge_ns)
    after_ns = longest_ns(edge_ns + 100 * US, edge_ns + 2000 * US)
    assert (before_ns <= 50 * US) == (look_back_us > 0)
    # Shortly after the edge the plane is as near as shortly before it
    assert (after_ns <= 50 * US) == (look_back_us > 0 or hold_us > 0)


def test_a_probe_is_switched_off_and_on_and_off_and_on(plant: Make) -> None:
    """It rests 0.1 mm in the workpiece: its level falls with its supply, comes 20 ms after it.

    Telling it what it is already changes nothing.
    """
    made = plant(
        "AxisRig.Drives.KinematicAxis",
        "AxisRig.Sensors.WorkpieceProbe",
        axis_start={"position_start": -1e-4},
        probe_start={"switch_on_time": 0.02},
    )
    probe = made.probes["probe"]
    assert probe.can_be_switched()
    made.advance_to(30 * MS)
    assert probe.signal.level
    expected = [(20 * MS, True)]
    for is_on in (True, False, False, True, True, False, True):
        now_ns = made.now_ns
        probe.switch(is_on, now_ns)
        if is_on != probe.signal.level:
            expected.append((now_ns + 20 * MS if is_on else now_ns, is_on))
        made.advance_to(now_ns + 30 * MS)
        assert probe.signal.level == is_on
    assert [level for _, level in probe.signal.edges] == [level for _, level in expected]
    for (edge_ns, _), (at_ns, _) in zip(probe.signal.edges, expected, strict=True):
        assert abs(edge_ns - at_ns) <= 2
