"""Two axes that move one FMU: the sides of a gantry on one beam."""

from typing import Any

import numpy as np
import pytest
from tests.machine.conftest import RunNc

from axisrig.kernel.errors import UserError

COUPLED = "N20 #SET AX LINK[1, [X2=X,G,15,20]]\nN30 #ENABLE AX LINK[1]\n"
PAIR = "gantry-pair.toml"
BREAKAWAY_N = 160.0


def at_end(out: Any, name: str) -> float:
    return float(out.column(name)[-1])


@pytest.mark.long
def test_both_sides_get_there_and_the_beam_stays_straight(run_nc: RunNc) -> None:
    out = run_nc(COUPLED + "N40 G1 X40 F6000\nN50 G4 X1", "", base=PAIR)
    assert out.alarms == []
    for axis in ("X", "X2"):
        assert at_end(out, f"{axis}.truth_mm") == pytest.approx(40.0, abs=0.01)
    skew = out.column("X.truth_mm") - out.column("X2.truth_mm")
    assert np.abs(skew).max() < 1e-3


@pytest.mark.long
def test_a_side_that_moves_alone_pulls_at_the_other(run_nc: RunNc) -> None:
    """The other end is accelerated by (m/4 - I/L^2) a = 50 N at 0.8 m/s2; its bristles yield.

    The presliding of 20 N/um gives way by up to 2.5 um; two separate axes know nothing of it.
    """
    program = "N40 G1 X10 F6000"
    out = run_nc(program, "", base=PAIR)
    assert out.alarms == []
    moved_um = np.abs(out.column("X2.truth_mm")).max() * 1e3
    assert 0.5 < moved_um < 2 * 2.5
    alone = run_nc(program, "", base="gantry-x.toml")
    assert np.ptp(alone.column("X2.truth_mm")) < 1e-9


@pytest.mark.long
def test_the_stop_of_one_side_carries_what_both_drives_push(run_nc: RunNc) -> None:
    """At rest the motors' forces less dry friction are the force of the stop."""
    out = run_nc(
        COUPLED + "N40 G1 X10.5 F300\nN50 G4 X2",
        "",
        "plant:x.stop_position_2_mm=10",
        "plant:x.force_limit_motor=1000",
        base=PAIR,
    )
    push = at_end(out, "X.force_n") + at_end(out, "X2.force_n")
    stop = at_end(out, "X2.stop_force_n")
    assert stop > 800.0
    assert abs(push - stop) <= 2 * BREAKAWAY_N
    assert stop == pytest.approx(20e3 * (at_end(out, "X2.truth_mm") - 10.0), rel=1e-3)
    names = out.machine.recorder.table().column_names
    assert "X2.stop_mm" in names
    assert "X.stop_mm" not in names


@pytest.mark.long
def test_the_frames_do_not_depend_on_the_exchange_step(run_nc: RunNc) -> None:
    program = COUPLED + "N40 G1 X5 F3000\nN50 G100 Z249 F600"
    truth = [
        run_nc(program, f"[cycle]\nexchange_us = {step}", base=PAIR).column("X2.truth_mm").tolist()
        for step in (20000, 250)
    ]
    assert truth[0] == truth[1]


@pytest.mark.parametrize(
    ("rig", "assignment", "message"),
    [
        ('[plant.x2]\nshares = "probe"', (), "shares must name the plant of an axis"),
        ('[plant.x2]\nshares = "x2"', (), "shares must name the plant of an axis"),
        ('[plant.x2]\nfmu = "AxisRig.Drives.ServoAxis"', (), "names another"),
        ("[plant.x2]\nstart = { kv = 3 }", (), "belong to x"),
        ('[plant.x2]\nsuffix = "_1"', (), "writes the same input as x"),
        ('[plant.x2]\nkind = "axis"\nsuffix = "_3"', (), "lacks what a plant of the kind axis"),
        ("", ("plant:x2.kv=3",), "has no start values"),
    ],
)
def test_what_cannot_be_shared_is_refused(
    run_nc: RunNc, rig: str, assignment: tuple[str, ...], message: str
) -> None:
    with pytest.raises(UserError, match=message) as caught:
        run_nc("N10 G4 X1", rig, *assignment, base=PAIR)
    if "start values" in message or "belong to" in message:
        assert caught.value.hint == "plant x2 shares the FMU of x: set it there"
