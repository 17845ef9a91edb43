"""What a program chooses of the dynamics of its path: profile and weights, by axis."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel import ChannelSettings
from axisrig.kernel.channel.path.programmed import ProgrammedDynamics
from axisrig.kernel.motion.course import Weights
from axisrig.kernel.motion.dynamics import Motion
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

BLOCK = Block(1, 10, "N10")


def axis(name: str, asked: list[str] | None = None) -> Any:
    """An axis whose weighted dynamics are its weights; asked: for which profiles."""

    def dynamics_of(_motion: Motion, slope: str) -> Any:
        if asked is not None:
            asked.append(slope)
        return SimpleNamespace(weighted=lambda weights: weights)

    return SimpleNamespace(name=name, dynamics_of=dynamics_of)


def weights_of(found: ProgrammedDynamics, name: str, motion: Motion = Motion.FEED) -> Any:
    return found.dynamics(axis(name), motion)


@pytest.mark.parametrize(
    ("number", "weights"),
    [
        (0, Weights(rise=2.0, fall=2.0, brake_rise=2.0, brake_fall=2.0)), (1, Weights(rise=2.0)),
        (2, Weights(fall=2.0)), (3, Weights(brake_rise=2.0)), (4, Weights(brake_fall=2.0)),
    ],
)  # fmt: skip
def test_the_ramp_time_that_the_list_names_is_weighted(number: int, weights: Weights) -> None:
    """P-CHAN-00073: 0 all of them, else up, its end, braking, its end."""
    found = ProgrammedDynamics(ChannelSettings(weighted_time=number))
    found.weigh(canon.DynamicWeights(BLOCK, "ramp_time", {"X": 2.0}))
    assert weights_of(found, "X") == weights
    assert weights_of(found, "Y") == Weights()


@pytest.mark.parametrize(
    ("number", "weights"), [(0, Weights(0.5, 0.5)), (1, Weights(0.5)), (2, Weights(1.0, 0.5))]
)
def test_the_acceleration_that_the_list_names_is_weighted(number: int, weights: Weights) -> None:
    found = ProgrammedDynamics(ChannelSettings(weighted_acceleration=number))
    found.weigh(canon.DynamicWeights(BLOCK, "acceleration", {"X": 0.5}))
    assert weights_of(found, "X") == weights


def test_an_axis_that_leaves_takes_its_ramp_times_with_it_and_no_others() -> None:
    found = ProgrammedDynamics(ChannelSettings())
    found.weigh(canon.DynamicWeights(BLOCK, "ramp_time", {"X": 2.0, "Y": 3.0}))
    found.weigh(canon.DynamicWeights(BLOCK, "acceleration", {"X": 0.5}))
    found.forget_times("X")
    assert weights_of(found, "X") == Weights(0.5, 0.5)
    found.weigh(canon.DynamicWeights(BLOCK, "acceleration", {"Y": 0.25}))
    assert weights_of(found, "Y") == Weights(0.25, 0.25, 3.0, 3.0, 3.0, 3.0)


def test_a_profile_without_a_name_is_that_of_the_channel() -> None:
    found, asked = ProgrammedDynamics(ChannelSettings(slope="TRAPEZ")), list[str]()
    for profile in (None, "SIN2", "STEP", None):
        if profile is not None or asked:
            found.choose(canon.SlopeChoice(BLOCK, profile))
        found.dynamics(axis("X", asked), Motion.FEED)
    found.choose(canon.SlopeChoice(BLOCK, "STEP"))
    found.begin()
    found.dynamics(axis("X", asked), Motion.FEED)
    assert asked == ["TRAPEZ", "SIN2", "STEP", "TRAPEZ", "TRAPEZ"]
