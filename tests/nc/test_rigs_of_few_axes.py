"""A rig with less than three axes: planes, systems, dwell times, indices of axes."""

import math

import pytest
from tests.nc.conftest import of, texts

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.canon import ArcMove, Dwell, LinearMove, Warn

TWO = ("X", "Z")


@pytest.mark.parametrize("plane", ["G17", "G19"])
def test_900152_names_the_plane_and_the_axes_that_there_are(run, plane):
    with pytest.raises(Alarm) as caught:
        run(f"F9\n{plane} G2 X5 R9", axes=TWO)
    assert (caught.value.id, caught.value.place) == (900152, "test.nc line 2")
    assert caught.value.values == {"plane": plane, "axes": "X Z"}


def test_the_plane_of_both_axes_has_arcs(run):
    """G18: half a circle of radius 2.5 about X2.5, from the first axis Z to X."""
    (arc,) = of(run("F9 G18\nG2 X5 Z0 I2.5", axes=TWO), ArcMove)
    assert arc.target_mm == {"X": 5.0, "Z": 0.0}
    assert arc.centre_mm == pytest.approx({"X": 2.5, "Z": 0.0})
    assert arc.angle_rad == pytest.approx(math.pi)


@pytest.mark.parametrize("command", ["#CS ON[1,2]", "#CS DEF[1][1]", "#CS ADD[A][1]"])
def test_a_coordinate_system_needs_three_axes(run, command):
    with pytest.raises(UserError, match="needs three main axes") as caught:
        run(f"G0 X1\n  {command}", axes=TWO)
    assert (caught.value.line, caught.value.column, caught.value.value) == (2, 3, "X, Z")
    run("#CS OFF ALL", axes=TWO)  # none is on: nothing to take off


@pytest.mark.parametrize(("axes", "first", "other"), [(TWO, "X", "Z"), (("Z", "X"), "Z", "X")])
def test_the_time_of_g4_may_be_at_the_first_axis_alone(run, axes, first, other):
    (dwell,) = of(run(f"G4 {first}1.5", axes=axes), Dwell)
    assert dwell.duration_ns == 1_500_000_000
    commands = run(f"G4 {first}2 {other}1", axes=axes)
    assert [each.duration_ns for each in of(commands, Dwell)] == [2_000_000_000]
    assert [each.alarm.values for each in of(commands, Warn)] == [{"axis": other}]
    with pytest.raises(Alarm) as caught:
        run(f"G4 {other}1", axes=axes)
    assert caught.value.id == 900171


def test_the_index_of_an_axis_is_its_place_in_the_channel(run):
    text = (
        "V.G.NP[1].V[0]=5\nV.G.NP[1].V[1]=7\nG54 G0 X0 Z0\n"
        '#MSG ["%g %g", V.G.NP[1].V.Z, V.G.NP_AKT.V[1]]'
    )
    commands = run(text, axes=("Z", "X"))
    assert [move.target_mm for move in of(commands, LinearMove)] == [{"Z": 5.0, "X": 7.0}]
    assert texts(commands) == ["5 7"]


@pytest.mark.parametrize(("axes", "moved"), [(("X",), "X"), (("C",), "C"), (("X2",), "X2")])
def test_a_rig_of_one_axis_has_its_words(run, axes, moved):
    commands = run(f'G0 {moved}=5\nG91 {moved}=1\n#MSG ["%g", V.A.ABS.{moved}]', axes=axes)
    assert [move.target_mm for move in of(commands, LinearMove)] == [{moved: 5.0}, {moved: 6.0}]
    assert texts(commands) == ["6"]
    with pytest.raises(UserError) as caught:
        run("G0 Y1", axes=axes)
    assert (caught.value.value, caught.value.allowed) == ("Y", moved)
