"""From a list to the settings: units, fallbacks, the family of IDs."""

from pathlib import Path

import pytest

from axisrig.kernel.channel.distance.settings import (
    AxisDistanceSettings,
    ChannelDistanceSettings,
)
from axisrig.kernel.distance import DistanceSettings, names_newer
from axisrig.kernel.distance.filters.build import OF_CHANNEL
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import ParameterSet, read_list, write_list

# Every parameter of the control with a value that is not its default
LIST = """
getriebe[0].dynamik.a_max 1500
kenngr.distc.n_cycles 20
kenngr.distc.max_deviation 20000
kenngr.distc.v_max 50000
kenngr.distc.max_act_value_change 7500
kenngr.distc.ref_offset 1
kenngr.distc.max_pos 40000
kenngr.distc.min_pos -30000
kenngr.distc.tolerance 5000
kenngr.distc.mode_dist_use_both_encoder 1
kenngr.distc.use_adaptive_acceleration 1
kenngr.distc.a_min 100
kenngr.distc.dist_error_a_min 250
kenngr.distc.dist_error_a_max 700
kenngr.distc.v_weight_down 300
kenngr.distc.a_weight_down 400
kenngr.distc.kp 0.3
kenngr.distc.i_tn 5
kenngr.distc.d_tv 0.01
kenngr.distc.filter_type KALMAN_MA
"""


@pytest.fixture
def listed(tmp_path: Path) -> object:
    def make(text: str) -> ParameterSet:
        path = tmp_path / "axis.lst"
        path.write_text(text, encoding="utf-8")
        return read_list(path, "axis")

    return make


def test_a_list_that_says_nothing_has_the_printed_defaults() -> None:
    found = DistanceSettings.read(ParameterSet("axis"))
    assert found == DistanceSettings(a_max_mm_s2=1000.0)
    assert found.a_mm_s2 == DistanceSettings().a_mm_s2


def test_every_parameter_in_its_unit(listed: object) -> None:
    found = DistanceSettings.read(listed(LIST))  # type: ignore[operator]
    assert found == DistanceSettings(
        kp=0.3, tn_s=5.0, tv_s=0.01, both_encoders=True, max_deviation_mm=2.0, v_max_mm_s=50.0,
        a_max_mm_s2=1500.0, a_axis_mm_s2=1500.0, v_weight_down_permille=300,
        a_weight_down_permille=400, is_adaptive=True, a_min_mm_s2=100.0, error_a_min_mm=0.025,
        error_a_max_mm=0.07, max_change_mm_s=7.5, min_pos_mm=-3.0, max_pos_mm=4.0,
        tolerance_mm=0.5, has_absolute_sensor=True, is_newer=False,
    ).replaced(n_cycles=20, filter_type="KALMAN_MA")  # fmt: skip


@pytest.mark.parametrize(
    ("line", "a_mm_s2"),
    [
        ("", 800.0),
        ("kenngr.distc.a_max 90\n", 90.0),
        ("kenngr.distc.a_max 900\n", 900.0),
        ("kenngr.distc.a_max 0\n", 800.0),
    ],
)
def test_without_a_max_that_of_the_axis_counts(listed: object, line: str, a_mm_s2: float) -> None:
    axis = listed(f"getriebe[0].dynamik.a_max 800\n{line}")  # type: ignore[operator]
    assert DistanceSettings.read(axis).a_mm_s2 == a_mm_s2


@pytest.mark.parametrize(
    ("text", "is_newer"),
    [
        ("kenngr.distc.kp 0.3\n", False),
        ("getriebe[0].kv 1000\n", False),
        ("kenngr.distc.kp 0.3\nkenngr.dist_ctrl[0].v_max 5000\n", True),
        ("kenngr.dist_ctrl[0].max_istw_sprung 5000\n", True),
    ],
)
def test_the_structure_chooses_the_family_of_ids(listed: object, text: str, is_newer: bool) -> None:
    axis = listed(text)  # type: ignore[operator]
    assert names_newer(axis) is is_newer
    settings = DistanceSettings.read(axis)
    assert settings.is_newer is is_newer
    assert settings.alarm((310024, 70335), owner="axis Z").id == (310024 if is_newer else 70335)
    assert settings.alarm((900311,), owner="axis Z").id == 900311


def test_a_cell_of_a_plan_may_choose_it_too() -> None:
    axis = ParameterSet("axis")
    axis.set("kenngr.distc.kp", "0.3", "plan")
    assert not names_newer(axis)
    axis.set("kenngr.dist_ctrl[0].kp", "0.3", "plan")
    assert names_newer(axis)


@pytest.mark.parametrize("structure", ["kenngr.distc.", "kenngr.dist_ctrl[0]."])
def test_a_list_that_is_written_keeps_the_family(
    listed: object, tmp_path: Path, structure: str
) -> None:
    axis = listed(f"{structure}kp 0.3\n")  # type: ignore[operator]
    write_list(axis, tmp_path / "again.lst")
    again = read_list(tmp_path / "again.lst", "axis")
    assert DistanceSettings.read(again) == DistanceSettings.read(axis)
    assert names_newer(again) is (structure != "kenngr.distc.")


def test_a_name_that_there_is_not() -> None:
    with pytest.raises(TypeError):
        DistanceSettings().replaced(kq=1.0)


# ---- the list of the channel (3D)

# FCT-M3 12.8.3, as printed but for what its misprints are
CHANNEL = """
configuration.decoder.function FCT_3D_DIST_CTRL
dist_ctrl[0].max_deviation 10000000
dist_ctrl[0].v_max 10000
dist_ctrl[0].a_max 100
dist_ctrl[0].max_act_value_change 10000000
dist_ctrl[0].v_weight_down 0
dist_ctrl[0].a_weight_down 0
dist_ctrl[0].ref_offset 0
dist_ctrl[0].max_pos 1500000
dist_ctrl[0].min_pos -1500000
dist_ctrl[0].tolerance 0
dist_ctrl[0].kp 0.3
dist_ctrl[0].i_tn 0.0
dist_ctrl[0].d_tv 0.01
dist_ctrl[0].n_cycles 20
dist_ctrl[0].filter_type MOVING_AVERAGE
dist_ctrl[0].smoothing_factor 0.05
dist_ctrl[0].kalman_sigma 2000
dist_ctrl[0].low_pass_filter_order 3
dist_ctrl[0].low_pass_filter_fg_f0 50
dist_ctrl[0].use_adaptive_acceleration 0
dist_ctrl[0].a_min 1
dist_ctrl[0].dist_error_a_min 400
dist_ctrl[0].dist_error_a_max 2500
"""


def of_channel(path: Path, text: str) -> ParameterSet:
    path.write_text(text, encoding="utf-8")
    return read_list(path, "channel")


def test_the_list_of_the_channel_has_the_same_in_the_same_units(tmp_path: Path) -> None:
    found = DistanceSettings.read(of_channel(tmp_path / "c.lst", CHANNEL), OF_CHANNEL)
    assert found == DistanceSettings(
        kp=0.3, tv_s=0.01, max_deviation_mm=1000.0, v_max_mm_s=10.0, a_max_mm_s2=100.0,
        a_axis_mm_s2=0.0, a_min_mm_s2=1.0, error_a_min_mm=0.04, error_a_max_mm=0.25,
        max_change_mm_s=1e4, min_pos_mm=-150.0, max_pos_mm=150.0, is_newer=True, sensor_sign=-1,
    ).replaced(
        filter_type="MOVING_AVERAGE", n_cycles=20, smoothing_factor=0.05, kalman_sigma=2000.0,
        low_pass_filter_order=3, low_pass_filter_fg_f0=50.0, prefix=OF_CHANNEL,
    )  # fmt: skip


def test_there_is_no_acceleration_of_an_axis_to_fall_back_on(tmp_path: Path) -> None:
    text = CHANNEL.replace("dist_ctrl[0].a_max 100\n", "")
    found = DistanceSettings.read(of_channel(tmp_path / "c.lst", text), OF_CHANNEL)
    assert found.a_mm_s2 == 0.0  # 315001 at the start sets it to 1 mm/s2


def test_the_channel_has_the_control_where_its_list_releases_it(tmp_path: Path) -> None:
    lines = "dist_ctrl[0].optimized_scheduling 1\ndist_ctrl[0].check_sw_limit_switch 1\n"
    text = CHANNEL.replace("ref_offset 0", "ref_offset 30000") + lines
    found = ChannelDistanceSettings.read(of_channel(tmp_path / "c.lst", text), is_licensed=False)
    assert found is not None
    assert (found.ref_offset_mm, found.is_licensed) == (3.0, False)
    assert found.is_optimized
    assert found.checks_limits
    assert found.control.has_absolute_sensor
    without = CHANNEL.replace("FCT_3D_DIST_CTRL", "FCT_USE_CACHED_FILES")
    assert ChannelDistanceSettings.read(of_channel(tmp_path / "d.lst", without)) is None


@pytest.mark.parametrize("name", ["dist_ctrl[1].kp", "dist_ctrl[0].nonsense"])
def test_there_is_one_control_for_a_channel(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError):
        of_channel(tmp_path / "c.lst", f"{name} 1\n")


@pytest.mark.parametrize(
    ("line", "flags"),
    [
        ("", (False, False)),
        ("optimized_scheduling 1", (True, False)),
        ("check_sw_limit_switch 1", (False, True)),
    ],
)
def test_each_flag_of_a_control_is_its_own_parameter(
    tmp_path: Path, listed: object, line: str, flags: tuple[bool, bool]
) -> None:
    text = f"{CHANNEL}dist_ctrl[0].{line}\n" if line else CHANNEL
    of_axis = f"lr_param.distance_control_on 1\n{f'kenngr.dist_ctrl[0].{line}' if line else ''}\n"
    for found in (
        ChannelDistanceSettings.read(of_channel(tmp_path / "c.lst", text)),
        AxisDistanceSettings.read(listed(of_axis)),  # type: ignore[operator]
    ):
        assert found is not None
        assert (found.is_optimized, found.checks_limits) == flags


@pytest.mark.parametrize(("offset", "is_absolute"), [(0, False), (1, True), (-1, True)])
def test_a_reference_on_either_side_of_0_is_that_of_an_absolute_sensor(
    tmp_path: Path, offset: int, is_absolute: bool
) -> None:
    """P-AXIS-00418, and `ref_offset` of the channel: 0 alone is none."""
    text = CHANNEL.replace("ref_offset 0", f"ref_offset {offset}")
    of_all = DistanceSettings.read(of_channel(tmp_path / "c.lst", text), OF_CHANNEL)
    path = tmp_path / "z.lst"
    path.write_text(LIST.replace("ref_offset 1", f"ref_offset {offset}"), encoding="utf-8")
    of_axis = DistanceSettings.read(read_list(path, "axis"))
    assert [of_all.has_absolute_sensor, of_axis.has_absolute_sensor] == [is_absolute] * 2
