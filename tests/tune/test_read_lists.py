"""What a list says of its control as `axisrig tune` reads it, and laws exactly at their limits."""

import math
from pathlib import Path

import numpy as np
import pytest
from tests.tune.test_loop import T_S, delay, loop, mean

from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.tune.distance import Configured
from axisrig.bench.tools.tune.loop import Law, Loop, both_encoders, const_dist, without_offset
from axisrig.kernel.distance import DistanceLaw
from axisrig.kernel.time.clock import MS

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "distance-z.toml"


def configured(*texts: str, period_ns: int = MS) -> Configured:
    settings = settings_of(RIG, [f"set:Z.kenngr.distc.{text}" for text in texts])
    return Configured.read(settings.axis["Z"], period_ns, DistanceLaw())


def test_a_law_has_each_part_of_the_list() -> None:
    """P-AXIS-00759, 00764, 00765: kp, Tn and Tv; times in s."""
    assert configured("kp=0.3", "i_tn=1.5", "d_tv=0.01").law == Law(0.3, 1.5, 0.01)
    assert configured("kp=0.3", "i_tn=0", "d_tv=0.01").law == Law(0.3, 0.0, 0.01)
    found = configured("kp=0.25")
    assert (found.law.kp, found.choices) == (0.25, DistanceLaw())


@pytest.mark.parametrize("is_on", [False, True])
def test_both_encoders_are_those_of_the_list(is_on: bool) -> None:
    """P-AXIS-00500."""
    assert configured(f"mode_dist_use_both_encoder={int(is_on)}").uses_both is is_on


@pytest.mark.parametrize("count", [1, 4, 20])
def test_a_mean_answers_a_pulse_with_its_share_as_long_as_it_holds_it(count: int) -> None:
    """It begins at rest: before the pulse all values were 0."""
    found = configured("filter_type=MOVING_AVERAGE", f"n_cycles={count}")
    assert (found.filter.kind, found.filter.n_cycles) == ("MOVING_AVERAGE", count)
    assert found.impulses[:count] == pytest.approx(1 / count)
    assert np.abs(found.impulses[count:]).max() < 1e-12


@pytest.mark.parametrize("cutoff_hz", [5.0, 20.0])
@pytest.mark.parametrize("period_ms", [1, 2])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_low_pass_of_the_list_is_that_of_the_cycle_of_the_rig(
    cutoff_hz: float, period_ms: int, order: int
) -> None:
    """At its cut-off frequency each order leaves 1/sqrt 2 of a sine, and at rest all of a value.

    Exactly: the sampled form of an order keeps its gain at that frequency (bilinear, prewarped).
    """
    found = configured("filter_type=LOWPASS", f"low_pass_filter_fg_f0={cutoff_hz:g}",
                       f"low_pass_filter_order={order}", period_ns=period_ms * MS)  # fmt: skip
    assert found.filter.kind == "LOWPASS"
    assert found.impulses.sum() == pytest.approx(1.0, rel=1e-9)
    angle = 2 * math.pi * cutoff_hz * period_ms * 1e-3
    share = abs(found.impulses @ np.exp(-1j * angle * np.arange(len(found.impulses))))
    assert share == pytest.approx(math.sqrt(0.5) ** order, rel=1e-9)


# Exactly at a limit


@pytest.mark.parametrize(
    ("kp", "is_stable"), [(1.0, True), (2.0, False), (2.0 - 1e-9, True), (2.0 + 1e-9, False)]
)
def test_a_zero_on_the_circle_is_not_stable(kp: float, is_stable: bool) -> None:
    """1 + (kp - 1) q^-1: an error of kp 2 changes its sign in each cycle and stays as large."""
    assert loop(0).is_stable(Law(kp)) is is_stable
    wide = Loop(T_S, const_dist(mean(1), delay(1)), mean(1))
    assert wide.is_stable(Law(kp)) is is_stable


def test_an_offset_that_is_seen_at_once_with_the_wrong_sign_has_no_solution_at_kp_1() -> None:
    """(1 - kp) o(k) = o(k - 1): nothing solves it at kp 1."""
    assert not Loop(T_S, np.array([-1.0]), mean(1)).is_stable(Law(1.0))


@pytest.mark.parametrize("reaction", [0, 1, 3])
def test_with_both_encoders_an_offset_that_is_sent_later_is_waited_for(reaction: int) -> None:
    """Drive and sensor cancel: what is left is the offset that was sent 1 + reaction cycles ago."""
    late = delay(2 + reaction)
    found = both_encoders(mean(1), late, late, reaction)
    assert found.tolist() == [*[0.0] * (1 + reaction), 1.0]
    assert without_offset(np.array([0.0, 1.0, -0.5])).tolist() == [0.0, 0.0, -0.5]
    assert without_offset(np.array([0.0, 1.0])).tolist() == [0.0]
