"""CNC objects: names, units, and when a written one acts."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.distance import DistanceCommand, DistanceState, objects
from axisrig.kernel.distance.objects import accept, channel_objects, read, write
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters.origin import Origin

Command, State = DistanceCommand, DistanceState
PLAN = Origin("plan.csv", 3, 5)

# TF5200 1147811083: index offset, type, unit
PRINTED = {
    "DIST_CTRL_IFC::a_max_int": ("3000", "REAL64", "0.1 um/s2"),
    "DIST_CTRL_IFC::sloped_delta_deviation": ("3001", "SGN64", "0.01 nm"),
    "DIST_CTRL::m_actual_offset": ("3100", "SGN64", "0.01 nm"),
    "DIST_CTRL::v_max_int": ("3102", "REAL64", "0.1 um/s"),
    "DIST_CTRL::set_distance": ("3103", "SGN64", "0.01 nm"),
    "DIST_CTRL::set_pos": ("3104", "SGN64", "0.01 nm"),
}
# 0.01 nm in a mm
PER_MM = 100_000_000


def test_objects_of_the_manual_are_there() -> None:
    found = {n: (o.offset, o.type, o.unit) for n, o in objects().items() if o.offset}
    assert found == PRINTED
    assert not any(objects()[name].is_writable for name in PRINTED)


def test_objects_are_read_in_their_units(make_loop: Callable[..., Any]) -> None:
    loop = make_loop(lambda _k: 0.5, kp=0.25, v_max_mm_s=40.0, a_max_mm_s2=2000.0, kalman_sigma=7.0)
    loop.control.set_surface(0.1)
    loop.say(Command.ON).run(2)
    # two steps of a quarter of what is left of 0.4 mm; 2 mm/s2 more speed in each ms
    assert loop.offsets_mm[-2:] == pytest.approx([0.002, 0.006])
    expected = {
        "DIST_CTRL_IFC::a_max_int": 2000 * 10_000,
        "DIST_CTRL_IFC::sloped_delta_deviation": 0.004 * PER_MM,
        "DIST_CTRL::m_actual_offset": 0.006 * PER_MM,
        "DIST_CTRL::v_max_int": 40 * 10_000,
        "DIST_CTRL::set_distance": 0,
        "DIST_CTRL::set_pos": 0.1 * PER_MM,
        "DIST_CTRL::target_deviation": (0.4 - 0.002) * PER_MM,
        "DIST_CTRL::delta_deviation_pre_limiter": 0.25 * (0.4 - 0.002) * PER_MM,
        "DIST_CTRL::sensor_value": (0.5 - 0.002) * PER_MM,
        "DIST_CTRL::filtered_feedback": 0.4 * PER_MM,
        "DIST_CTRL::zstd": 1,
        "DIST_CTRL::kp": 0.25,
        "DIST_CTRL::v_max": 40_000,
        "DIST_CTRL::a_max": 2000,
        "DIST_CTRL::sigma": 7.0,
        "DIST_CTRL::filter_type": "DEFAULT",
    }
    assert {name: read(loop.control, name) for name in expected} == expected


def holding(attributes: tuple[str, ...], value: float | None) -> Any:
    """An object in which a path of attributes leads to the value."""
    found: Any = value
    for attribute in reversed(attributes):
        found = SimpleNamespace(**{attribute: found})
    return found


@pytest.mark.interpreted
def test_a_whole_number_is_the_nearest_one_and_a_real_number_keeps_its_fraction() -> None:
    """By the columns type and factor of both tables; what is not there yet is 0."""
    counts = {None: 0, 123.7: 124, 123.2: 123, -123.7: -124, -123.2: -123}
    for name, item in objects().items():
        for count, whole in counts.items() if item.type != "STRING" else ():
            control = holding(item.attributes, None if count is None else count / item.factor)
            control.requested = {}.get
            expected = whole if item.type != "REAL64" else count or 0.0
            assert read(control, name) == pytest.approx(expected, rel=1e-9), (name, count)
    for name, shown in channel_objects().items():
        for count, whole in counts.items():
            value = None if count is None else count / shown.factor
            assert shown.read(holding(shown.attributes, value)) == whole, (name, count)


WRITTEN = [
    ("DIST_CTRL::kp", "0.3", "kp", 0.3),
    ("DIST_CTRL::i_tn", "5", "tn_s", 5.0),
    ("DIST_CTRL::d_tv", "0.01", "tv_s", 0.01),
    ("DIST_CTRL::v_max", "1500", "v_max_mm_s", 1.5),
    ("DIST_CTRL::a_max", "0", "a_max_mm_s2", 0),
    ("DIST_CTRL::max_dist_change", "2500", "max_change_mm_s", 2.5),
]
FILTER = [
    ("DIST_CTRL::filter_type", "KALMAN_MA", "kind", "KALMAN_MA"),
    ("DIST_CTRL::n_cycles", "30", "n_cycles", 30),
    ("DIST_CTRL::smooth_fact", "0.5", "smoothing_factor", 0.5),
    ("DIST_CTRL::sigma", "2000", "kalman_sigma", 2000.0),
    ("DIST_CTRL::fg_f0", "50", "low_pass_filter_fg_f0", 50.0),
    ("DIST_CTRL::order", "3", "low_pass_filter_order", 3),
]


def test_every_writable_object_is_tested() -> None:
    tested = {name for name, *_ in [*WRITTEN, *FILTER]}
    assert tested == {name for name, o in objects().items() if o.is_writable}


@pytest.mark.parametrize("state", [State.INACTIVE, State.FREEZE])
@pytest.mark.parametrize("mode", [Command.ON, Command.ON_CONST_DIST])
@pytest.mark.parametrize(("name", "text", "setting", "value"), [*WRITTEN, *FILTER])
def test_a_written_object_acts_when_control_is_switched_on(
    make_loop: Callable[..., Any],
    state: State,
    mode: Command,
    name: str,
    text: str,
    setting: str,
    value: object,
) -> None:
    control = make_loop().lead_to(state).control

    def in_force() -> object:
        settings = control.settings
        return getattr(settings, setting, getattr(settings.filter, setting, None))

    before = in_force()
    write(control, name, accept(name, text, PLAN))
    assert read(control, name) == accept(name, text, PLAN)
    assert in_force() == before != value
    control.command(mode, control.source)
    assert in_force() == value
    assert read(control, name) == accept(name, text, PLAN)


@pytest.mark.parametrize("state", [State.ACTIVE, State.ACTIVE_CONST_DIST])
@pytest.mark.parametrize(("name", "text", "setting", "value"), WRITTEN)
def test_a_written_object_waits_while_control_is_on(
    make_loop: Callable[..., Any], state: State, name: str, text: str, setting: str, value: object
) -> None:
    loop = make_loop().lead_to(state)
    same = Command.ON if state is State.ACTIVE else Command.ON_CONST_DIST
    write(loop.control, name, accept(name, text, PLAN))
    loop.run(3).say(same).run(3)
    assert getattr(loop.control.settings, setting) != value
    loop.say(Command.FREEZE).run(3)
    assert getattr(loop.control.settings, setting) != value
    loop.say(same)
    assert getattr(loop.control.settings, setting) == value


def test_what_the_program_says_later_counts(make_loop: Callable[..., Any]) -> None:
    loop = make_loop().lead_to(State.FREEZE)
    write(loop.control, "DIST_CTRL::kp", 0.3)
    write(loop.control, "DIST_CTRL::filter_type", "KALMAN_MA")
    loop.control.program(kp=0.7, filter_type="EXPO_MEAN")
    loop.say(Command.ON)
    assert loop.control.settings.kp == 0.7
    assert loop.control.settings.filter.kind == "EXPO_MEAN"


def test_an_acceleration_of_0_is_that_of_the_axis(make_loop: Callable[..., Any]) -> None:
    loop = make_loop(a_axis_mm_s2=1234.0)
    write(loop.control, "DIST_CTRL::a_max", 0)
    loop.lead_to(State.ACTIVE)
    assert read(loop.control, "DIST_CTRL_IFC::a_max_int") == 1234 * 10_000


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("DIST_CTRL::kq", "1", "nearest names: DIST_CTRL::kp"),
        ("DIST_CTRL::m_actual_offset", "1", "can only be read"),
        ("DIST_CTRL::kp", "2.5", "above 0.0, up to 2.0"),
        ("DIST_CTRL::n_cycles", "1.5", "type SGN32"),
        ("DIST_CTRL::filter_type", "BUTTER", "KALMAN_EXPO"),
    ],
)
def test_what_no_object_takes(name: str, text: str, words: str) -> None:
    with pytest.raises(UserError, match=words) as caught:
        accept(name, text, PLAN)
    assert str(caught.value).startswith("plan.csv:3:5: ")
