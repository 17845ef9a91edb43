"""Each setting of a channel and of an axis is its own parameter; nothing else changes with it."""

from dataclasses import fields
from typing import Any

import pytest

from axisrig.kernel.channel import AxisSettings, ChannelSettings
from axisrig.kernel.channel.path.settings import OverrideMode
from axisrig.kernel.motion.dynamics import Motion
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.parameters import Origin, ParameterSet

HERE = Origin("a.lst", 1)

OF_CHANNEL = [
    ("meas_error_no_signal", "1", "error_no_signal", True),
    ("meas_fixed_stop_no_error", "1", "stop_may_be_missing", True),
    ("independent_axis_error_stop", "1", "each_axis_halts", True),
    ("max_vb_override", "1500", "override_max_permille", 1500),
    ("prog_start.slope.profile", "1", "slope", "TRAPEZ"),
    ("prog_start.slope.profile", "2", "slope", "SIN2"),
    ("prog_start.slope.acceleration", "2", "weighted_acceleration", 2),
    ("prog_start.slope.ramp_time", "3", "weighted_time", 3),
    ("meas_use_std_dynamic", "1", "weighs_measuring", True),
]


def of_list(kind: str, **written: str) -> ParameterSet:
    found = ParameterSet(kind)
    for path, text in written.items():
        found.load(path, text, HERE)
    return found


def settings(written: dict[str, str], **operator: Any) -> ChannelSettings:
    given = {"start_after_ns": None, "optional_stop": False} | operator
    return ChannelSettings.read(of_list("channel", **written), **given)


def changed(one: Any, other: Any) -> set[str]:
    return {f.name for f in fields(one) if getattr(one, f.name) != getattr(other, f.name)}


@pytest.mark.parametrize(("path", "text", "name", "value"), OF_CHANNEL)
def test_a_parameter_of_the_channel_is_the_setting_of_its_own_name(
    path: str, text: str, name: str, value: Any
) -> None:
    usual, found = settings({}), settings({path: text})
    assert getattr(found, name) == value
    assert changed(usual, found) == {name}


@pytest.mark.parametrize(
    ("name", "value"), [("optional_stop", True), ("start_after_ns", 0), ("start_after_ns", 7)]
)
def test_what_the_operator_does_is_no_parameter(name: str, value: Any) -> None:
    usual, found = settings({}), settings({}, **{name: value})
    assert getattr(found, name) == value
    assert changed(usual, found) == {name}


def axis(**written: str) -> AxisSettings:
    return AxisSettings.read("Q", of_list("axis", **written), ParameterSet("channel"))


@pytest.mark.parametrize(
    ("path", "text", "names", "values"),
    [
        ("kenngr.messachse", "1", {"may_measure"}, {"may_measure": True}),
        ("getriebe[0].window", "250", {"window_mm"}, {"window_mm": 0.025}),
        ("kopf.achs_nr", "7", {"number"}, {"number": 7}),
        ("kenngr.indp_override_mode", "1", {"override_mode"},
         {"override_mode": OverrideMode.LEAST}),
        ("kenngr.indp_override_mode", "2", {"override_mode"}, {"override_mode": OverrideMode.AXIS}),
    ],
)  # fmt: skip
def test_a_parameter_of_an_axis_is_the_setting_of_its_own_name(
    path: str, text: str, names: set[str], values: dict[str, Any]
) -> None:
    usual, found = axis(), axis(**{path: text})
    assert {name: getattr(found, name) for name in names} == values
    assert changed(usual, found) == names


@pytest.mark.parametrize(
    ("structure", "is_newer"), [("kenngr.dist_ctrl[0].kp", True), ("kenngr.distc.kp", False)]
)
def test_the_ids_of_distance_control_are_those_of_the_structure_of_the_list(
    structure: str, is_newer: bool
) -> None:
    assert not axis().tells_newer_ids
    assert axis(**{structure: "0.5"}).tells_newer_ids is is_newer


def test_an_axis_stops_by_itself_with_its_emergency_ramp_where_a_list_has_one() -> None:
    """P-AXIS-00003; without it with that of a stop, though the parameter has a default."""
    usual = axis()
    assert usual.emergency is None
    assert usual.own_stop == usual.dynamics[Motion.FEED].stop_deceleration
    found = axis(**{"getriebe[0].dynamik.a_emergency": "7000"})
    assert found.emergency == found.own_stop == Slope(7000.0, 7000.0, 1.0)
    assert found.of_set_points(1000.0).a_mm_s2 >= 7000.0
