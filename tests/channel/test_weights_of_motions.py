"""On which motions the weights of a program act, and for how long."""

import pytest

from axisrig.kernel.channel import ChannelSettings
from axisrig.kernel.channel.path.programmed import ProgrammedDynamics
from axisrig.kernel.channel.path.settings import AxisSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

BLOCK = Block(1, 10, "N10")
# Of each kind of motion another acceleration, of the linear slope and of both with ramps
LINEAR = {Motion.RAPID: 5000.0, Motion.FEED: 1000.0, Motion.MEASURING: 800.0}
RAMPED = {Motion.RAPID: 6000.0, Motion.FEED: 900.0, Motion.MEASURING: 700.0}


def _linear(a_mm_s2: float) -> Dynamics:
    slope = Slope(a_mm_s2, a_mm_s2, 1000.0)
    return Dynamics(slope, slope, slope, 100.0)


def _ramped(a_mm_s2: float, shape: Shape) -> Dynamics:
    slope = JerkSlope(a_mm_s2, 0.05, 0.05, shape)
    return Dynamics(slope, slope, slope, 100.0)


def axis(name: str = "X", linear: dict[Motion, float] = LINEAR) -> AxisSettings:
    return AxisSettings(
        name,
        True,
        0.01,
        0,
        {motion: _linear(a) for motion, a in linear.items()},
        jerk_limited={
            shape: {motion: _ramped(a, shape) for motion, a in RAMPED.items()} for shape in Shape
        },
    )


def program(*weights: tuple[str, dict[str, float]], **settings: object) -> ProgrammedDynamics:
    found = ProgrammedDynamics(ChannelSettings(**settings))  # type: ignore[arg-type]
    for what, shares in weights:
        found.weigh(canon.DynamicWeights(BLOCK, what, shares))  # type: ignore[arg-type]
    return found


@pytest.mark.parametrize("weighs_measuring", [False, True])
@pytest.mark.parametrize("motion", Motion)
def test_weights_act_on_feed_blocks_and_by_p_chan_00296_on_runs(
    motion: Motion, weighs_measuring: bool
) -> None:
    found = program(("acceleration", {"X": 0.5}), weighs_measuring=weighs_measuring)
    weighted = motion is Motion.FEED or (motion is Motion.MEASURING and weighs_measuring)
    expected = LINEAR[motion] * (0.5 if weighted else 1.0)
    assert found.dynamics(axis(), motion).acceleration.least_mm_s2 == expected
    assert found.dynamics(axis("Y"), motion).acceleration.least_mm_s2 == LINEAR[motion]


def test_a_weight_holds_until_another_one_or_the_end_of_the_program() -> None:
    """Always a share of what the list has, never of the weight before."""
    found = program(("acceleration", {"X": 0.5, "Y": 0.25}))

    def of(name: str) -> float:
        return found.dynamics(axis(name), Motion.FEED).acceleration.least_mm_s2

    assert (of("X"), of("Y")) == (500.0, 250.0)
    found.weigh(canon.DynamicWeights(BLOCK, "acceleration", {"X": 0.8}))
    assert (of("X"), of("Y")) == (800.0, 250.0)
    found.weigh(canon.DynamicWeights(BLOCK, "ramp_time", {"Y": 2.0}))
    assert (of("X"), of("Y")) == (800.0, 250.0)
    found.begin()
    assert (of("X"), of("Y")) == (1000.0, 1000.0)
    found.weigh(canon.DynamicWeights(BLOCK, "ramp_time", {"X": 2.0}))  # nothing is left of them
    assert (of("X"), of("Y")) == (1000.0, 1000.0)


def test_one_weight_leaves_those_of_other_kinds() -> None:
    found = program(("acceleration", {"X": 0.5}), ("ramp_time", {"X": 3.0}))
    found.choose(canon.SlopeChoice(BLOCK, "TRAPEZ"))
    slope = found.dynamics(axis(), Motion.FEED).acceleration
    assert isinstance(slope, JerkSlope)
    assert (slope.a_mm_s2, slope.rise_s, slope.fall_s) == pytest.approx((450.0, 0.15, 0.15))


@pytest.mark.parametrize(
    ("shares", "largest_mm_s2"),
    [
        ({}, 0.0),
        ({"Y": 3.0}, 0.0),  # of another axis
        ({"X": 3.0}, 3000.0),
        ({"X": 0.5}, 1000.0),  # what a signal brakes with has no weight
        ({"X": 1.0}, 1000.0),
    ],
)
def test_the_largest_acceleration_is_that_of_feed_blocks_and_runs(
    shares: dict[str, float], largest_mm_s2: float
) -> None:
    """Rapid traverse has more and is none of them."""
    weights = (("acceleration", shares),) if shares else ()
    assert program(*weights).most_mm_s2(axis()) == pytest.approx(largest_mm_s2)


@pytest.mark.parametrize(
    ("linear", "largest_mm_s2"),
    [
        ({Motion.RAPID: 1.0, Motion.FEED: 10.0, Motion.MEASURING: 950.0}, 1900.0),
        ({Motion.RAPID: 1.0, Motion.FEED: 10.0, Motion.MEASURING: 20.0}, 1800.0),  # with ramps
    ],
)
def test_the_largest_acceleration_is_of_any_slope_and_of_runs_too(
    linear: dict[Motion, float], largest_mm_s2: float
) -> None:
    found = program(("acceleration", {"X": 2.0}))
    assert found.most_mm_s2(axis(linear=linear)) == pytest.approx(largest_mm_s2)


@pytest.mark.parametrize(
    ("profile", "a_mm_s2"),
    [("STEP", LINEAR), ("TRAPEZ", RAMPED), ("SIN2", RAMPED), ("HSC", None), (None, LINEAR)],
)
def test_each_profile_has_its_slope(
    profile: str | None, a_mm_s2: dict[Motion, float] | None
) -> None:
    found = program()
    found.choose(canon.SlopeChoice(BLOCK, profile))
    for motion in Motion:
        if a_mm_s2 is None:
            with pytest.raises(Alarm, match="HSC of P-CHAN-00071") as caught:
                found.dynamics(axis(), motion)
            assert caught.value.id == 900100
            continue
        slope = found.dynamics(axis(), motion).acceleration
        assert slope.least_mm_s2 == a_mm_s2[motion]
        assert getattr(slope, "shape", None) == (profile if a_mm_s2 is RAMPED else None)


@pytest.mark.parametrize(
    ("emergency_mm_s2", "signal_mm_s2", "own_mm_s2"),
    [(None, 700.0, 700.0), (9000.0, 700.0, 9000.0), (30.0, 700.0, 30.0)],
)
def test_an_axis_stops_by_itself_with_its_emergency_deceleration_or_as_on_a_signal(
    emergency_mm_s2: float | None, signal_mm_s2: float, own_mm_s2: float
) -> None:
    """P-AXIS-00003, else what a feed block brakes with on a signal; the set points may too."""
    usual, brake = Slope(100.0, 100.0, 1.0), Slope(signal_mm_s2, signal_mm_s2, 1.0)
    of_motion = dict.fromkeys(Motion, Dynamics(usual, usual, usual, 55.0))
    of_motion[Motion.FEED] = Dynamics(usual, usual, brake, 44.0)
    emergency = None
    if emergency_mm_s2 is not None:
        emergency = Slope(emergency_mm_s2, emergency_mm_s2, 1.0)
    found = AxisSettings("X", True, 0.01, 0, of_motion, emergency=emergency)
    assert found.own_stop.most_mm_s2 == own_mm_s2
    limits = found.of_set_points(200.0)  # increments a millimetre
    assert limits == ("X", 44.0, max(own_mm_s2, signal_mm_s2), 0.005)


@pytest.mark.parametrize(
    ("highest_mm_s2", "allowed_mm_s2"), [(float("inf"), 300.0), (2500.0, 2500.0)]
)
def test_an_offset_may_move_an_axis_as_rapid_traverse_and_p_axis_00008_say(
    highest_mm_s2: float, allowed_mm_s2: float
) -> None:
    """Without the latter by the smaller step of its acceleration."""
    of_motion = dict.fromkeys(Motion, _linear(7.0))
    two = Slope(400.0, 300.0, 10.0)
    other = Slope(1.0, 1.0, 1.0)
    of_motion[Motion.RAPID] = Dynamics(two, other, other, 66.0, highest_mm_s2=highest_mm_s2)
    assert AxisSettings("X", True, 0.01, 0, of_motion).allowed == (66.0, allowed_mm_s2)
