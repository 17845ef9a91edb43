"""#SLOPE and the weights G130 to G134, from their text to the commands of the channel."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc import canon

Run = Callable[..., list[Any]]


def chosen(commands: list[Any]) -> list[str | None]:
    return [c.profile for c in commands if isinstance(c, canon.SlopeChoice)]


def weights(commands: list[Any]) -> list[tuple[str, dict[str, float]]]:
    return [(c.what, dict(c.shares)) for c in commands if isinstance(c, canon.DynamicWeights)]


def test_the_profile_of_the_path(run: Run) -> None:
    text = """#SLOPE [TYPE=TRAPEZ]
N10 #SLOPE [TYPE=sin2 NO_OPT=0]
N20 #SLOPE [TYPE=STEP NO_OPT=1]
N30 #SLOPE DEFAULT"""
    assert chosen(run(text)) == ["TRAPEZ", "SIN2", "STEP", None]


@pytest.mark.provokes(21629, 2)
def test_21629_for_an_unknown_profile(run: Run) -> None:
    with pytest.raises(Alarm) as raised:
        run("N10 #SLOPE [TYPE=TRAPEZE]")
    assert raised.value.id == 21629
    assert "TRAPEZE" in str(raised.value)
    assert "STEP TRAPEZ SIN2" in str(raised.value)


def test_hsc_and_a_wrong_no_opt_are_refused(run: Run) -> None:
    with pytest.raises(Alarm, match="HSC") as raised:
        run("N10 #SLOPE [TYPE=HSC]")
    assert raised.value.id == 900100
    with pytest.raises(Alarm, match="NO_OPT") as raised:
        run("P1 = 2\nN10 #SLOPE [TYPE=SIN2 NO_OPT=P1]")
    assert raised.value.id == 900105
    with pytest.raises(UserError, match="TYPE"):
        run("N10 #SLOPE [NO_OPT=1]")


def test_weights_are_shares_of_the_lists_by_axis(run: Run) -> None:
    """The example of the manual: 206596619."""
    text = """N10 G132 X200
N20 G01 F1000 X100
N30 G132 Y50
N40 Y100
N50 G133 = 100 X10 Y20
N60 G134 = 50 X1
N70 G130 X70
N80 G131 = 80"""
    commands = run(text)
    every = dict.fromkeys(("X", "Y", "Z"), 1.0)
    assert weights(commands) == [
        ("ramp_time", {"X": 2.0}),
        ("ramp_time", {"Y": 0.5}),
        ("ramp_time", every),
        ("contour_time", dict.fromkeys(every, 0.5)),
        ("acceleration", {"X": 0.7}),
        ("acceleration", dict.fromkeys(every, 0.8)),
    ]
    moved = [dict(c.target_mm) for c in commands if isinstance(c, canon.LinearMove)]
    assert moved == [{"X": 100.0}, {"Y": 100.0}, {"X": 10.0, "Y": 20.0}, {"X": 1.0}]


@pytest.mark.provokes(900174, 2)
@pytest.mark.parametrize("block", ["G130 X0", "G131 = -5", "G132 Y=0", "G133 = 0", "G134 = 0"])
def test_900174_for_a_weight_that_leaves_no_motion(run: Run, block: str) -> None:
    with pytest.raises(Alarm) as raised:
        run(f"N10 {block}")
    assert raised.value.id == 900174


@pytest.mark.parametrize("block", ["G131", "G133 X10", "G130", "G132"])
def test_a_weight_without_a_value_is_refused_with_its_place(run: Run, block: str) -> None:
    with pytest.raises(UserError, match="needs"):
        run(f"N10 {block}")


def test_a_weight_without_axes_is_that_of_every_axis_and_one_with_axes_of_those(run: Run) -> None:
    """Main axes, further ones and rotary ones."""
    axes = ("X", "Y", "Z", "C", "X2")
    for word in ("G131", "G133", "G134"):
        ((_, shares),) = weights(run(f"{word} = 70", axes=axes))
        assert shares == dict.fromkeys(axes, 0.7)
    for word in ("G130", "G132"):
        ((_, shares),) = weights(run(f"{word} X2=50 C120", axes=axes))
        assert shares == {"X2": 0.5, "C": 1.2}
