"""What the PLC side and a program see of 3D distance control, and its sensor."""

import math
from typing import Any

import pytest
from tests.channel.distance3d.programs import HEAD, TILTED, Make, rising

from axisrig.kernel.channel.distance.diagnosis import diagnosis
from axisrig.kernel.distance import DistanceCommand, DistanceState
from axisrig.kernel.errors import Alarm
from axisrig.kernel.plc.unit import Refreshed


@pytest.mark.long
def test_the_plc_sees_inclination_and_length_of_every_cycle(make_head: Make) -> None:
    """FCT-M3 12.5, of the actual positions; with kinematic 98 [30; 60] at 40 deg: 90.440 mm."""
    made = make_head()
    seen: list[tuple[float | None, float | None]] = []
    tool = made.channel.plc.tool
    made.channel.observers.append(lambda _c: seen.append((tool.tilt_deg, tool.length_mm)))
    made.run(
        HEAD.replace("#TRAFO [9]\n", "")
        + "V.G.KIN_STEP[1].ID[98].PARAM[1]=300000\nV.G.KIN_STEP[1].ID[98].PARAM[2]=600000\n"
        "V.G.KIN_STEP[1].ID[98].PARAM[3]=800000\n#TIME 0.01\n#TRAFO [9, 98]\nG1 F60000 A-40\n"
        "#TIME 0.02\nV.P.TILT = V.E.TOOL_TILT\nV.P.LENGTH = V.E.TOOL_LENGTH\n"
        '#MSG ["%.3f %.3f", V.P.TILT, V.P.LENGTH]\n#TRAFO OFF\n#TIME 0.01'
    )
    assert made.alarm_ids == []
    assert (None, None) in seen
    assert seen[-1] == (None, None)
    tilts = [tilt for tilt, _ in seen if tilt is not None]
    assert max(tilts) == pytest.approx(40.0, abs=1e-4)
    assert any(5 < tilt < 35 for tilt in tilts)
    l2_mm = 80 * math.cos(math.radians(30)) / math.cos(math.radians(40))
    assert max(length for _, length in seen if length) == pytest.approx(l2_mm, abs=1e-3)
    assert made.bench.messages[-1][1] == f"40.000 {l2_mm:.3f}"


# The list of FCT-M3 12.8.3, and what figure 56 shows of it in cycles of 1 ms
LIST_12_8_3 = {
    "kp": 0.3, "tn_s": 0.0, "tv_s": 0.01, "filter_type": "MOVING_AVERAGE", "n_cycles": 20,
    "smoothing_factor": 0.05, "kalman_sigma": 2000.0, "max_change_mm_s": 10_000.0,
    "low_pass_filter_fg_f0": 50.0, "low_pass_filter_order": 3, "v_max_mm_s": 10.0,
    "a_max_mm_s2": 100.0,
}  # fmt: skip
FIGURE_56 = {
    "tast_offset": "0", "referenzwert": "0", "sollw": "0", "sollw_prog": "0", "kp": "0.300000",
    "i_tn": "0.000000", "d_tv": "0.010000", "filter_type": "MOVING_AVERAGE", "n_cycles": "20",
    "smooth_fact": "0.050000", "sigma": "2000.000000", "max_dist_change": "10000",
    "fg_f0": "50.000000", "order": "3", "v_max": "100000", "a_max": "100", "logged_events": "0",
    "cmd_offset": "0", "cmd_offset_frozen": "0", "act_offset": "0", "delta_tool_length": "0",
    "f_freeze": "0", "f_wait_for_finished": "0", "f_use_weighting": "0", "active_mode": "OFF(0)",
    "new_mode": "OFF(0)", "active_ax_idx": "0", "new_ax_idx": "0",
}  # fmt: skip


def test_diagnosis_data_of_the_printed_list_are_those_of_the_figure(make_tool_loop: Make) -> None:
    loop = make_tool_loop(**LIST_12_8_3)
    shown = dict(diagnosis(loop.control3d, is_awaited=False))
    assert shown.pop("zstd") == "INACTIVE(0)"
    assert list(shown.items()) == list(FIGURE_56.items())
    loop.control3d._period_ns = 2_000_000  # as many mm/s are twice as many um in 2 ms
    assert dict(diagnosis(loop.control3d, is_awaited=True)).items() >= {
        ("max_dist_change", "20000"),
        ("v_max", "100000"),
        ("f_wait_for_finished", "1"),
    }
    loop.control3d._period_ns = 1_000_000
    loop.plan("MCS", "Z").on(set_pos=0.0)
    shown = dict(diagnosis(loop.control3d, is_awaited=False))
    assert (shown["active_mode"], shown["new_mode"]) == ("MCS(3)", "MCS(3)")
    assert (shown["active_ax_idx"], shown["new_ax_idx"]) == ("0", "2")


def test_diagnosis_data_show_the_set_value_that_acts_and_a_held_offset(
    make_tool_loop: Make, tool: Any
) -> None:
    """Over a surface 2 mm higher than SET_POS and SET_DIST say; held by an axis, frozen, on."""
    loop = make_tool_loop(plane=tool.plane(height_mm=lambda _k: 2.0))
    loop.plan("MCS")
    for words, acts in (({"set_pos": 1.0}, "10000"), ({"set_dist": 81.0}, "810000")):
        loop.on(**words)
        loop.run(20)
        assert loop.control.offset_mm != 0.0
        for is_held, command, is_frozen in (
            (False, None, False),
            (True, None, True),
            (False, DistanceCommand.FREEZE, True),
        ):
            loop.control3d.is_held = is_held
            if command is not None:
                loop.say(command)
            loop.run(2)
            shown = dict(diagnosis(loop.control3d, is_awaited=False))
            offset = f"{round(loop.control.offset_mm * 1e4)}"
            assert shown["f_freeze"] == f"{int(is_frozen)}"
            assert shown["cmd_offset_frozen"] == (offset if is_frozen else "0")
            if command is None:
                assert shown["sollw"] == acts


@pytest.mark.parametrize("v_permille", [0, 800])
@pytest.mark.parametrize("a_permille", [0, 500])
def test_diagnosis_data_have_each_its_own_value(
    make_tool_loop: Make, tool: Any, v_permille: int, a_permille: int
) -> None:
    """Beside those of the printed list: one weight alone is one in use, and the rest by name."""
    loop = make_tool_loop(
        plane=tool.plane(height_mm=lambda _k: 0.5),
        ref_offset_mm=3.5,
        is_optimized=False,
        **LIST_12_8_3 | {"v_max_mm_s": 1e3, "a_max_mm_s2": 1e6, "max_change_mm_s": 1e6, "kp": 0.2},
        v_weight_down_permille=v_permille,
        a_weight_down_permille=a_permille,
    )
    shown = dict(diagnosis(loop.control3d, is_awaited=True))
    assert shown["f_use_weighting"] == f"{int(v_permille + a_permille > 0)}"
    assert (shown["f_wait_for_finished"], shown["f_freeze"]) == ("1", "0")
    assert (shown["referenzwert"], shown["max_dist_change"]) == ("35000", "1000000")
    loop.plan("ACS", "Y")
    shown = dict(diagnosis(loop.control3d, is_awaited=False))
    assert (shown["active_mode"], shown["new_mode"]) == ("OFF(0)", "ACS(1)")
    assert (shown["active_ax_idx"], shown["new_ax_idx"]) == ("0", "1")
    assert shown["f_wait_for_finished"] == "0"
    loop.plan("ECS").on(set_pos=0.3)
    sent = loop.control3d.output_mm
    for _ in range(3):
        loop.run(1)
        shown = dict(diagnosis(loop.control3d, is_awaited=False))
        offset = loop.control.offset_mm
        assert (shown["cmd_offset"], shown["act_offset"]) == (
            f"{round(offset * 1e4)}",
            f"{round(sent * 1e4)}",
        )
        sent = offset
    assert sent != 0.0
    assert (shown["active_mode"], shown["new_mode"], shown["active_ax_idx"]) == (
        *("ECS(2)", "ECS(2)"),
        "0",
    )
    assert (shown["sollw"], shown["sollw_prog"]) == ("3000", "3000")
    loop.control.set_distance(77.0)
    shown = dict(diagnosis(loop.control3d, is_awaited=False))
    assert (shown["sollw"], shown["sollw_prog"]) == ("3000", "770000")


def test_diagnosis_data_count_the_cycles_that_fail(make_tool_loop: Make, tool: Any) -> None:
    loop = make_tool_loop(
        plane=tool.plane(height_mm=lambda _k: 3.0), kp=0.5, max_deviation_mm=1.0
    ).plan("MCS")
    for count in (1, 2):
        loop.on(set_pos=0.0)
        with pytest.raises(Alarm, match="310017"):
            loop.run(9)
        shown = dict(diagnosis(loop.control3d, is_awaited=False))
        assert (shown["logged_events"], shown["zstd"]) == (f"{count}", "ERROR(5)")
        loop.say(DistanceCommand.OFF).run(3)


# ---- the sensor


@pytest.mark.long
@pytest.mark.provokes(310020, 7, owner="the channel")
def test_check_pos_and_ref_are_those_of_the_distance(make_head: Make) -> None:
    """At A -40 the clamping point is 80 cos 40 = 61.284 mm above the surface."""
    made = make_head(min_pos_mm=60.0).run(TILTED + "#DIST CTRL CHECK_POS")
    assert made.alarm_ids == []
    made = make_head(min_pos_mm=62.0).run(TILTED + "#TIME 0.01\n#DIST CTRL [CHECK_POS]")
    assert made.alarm_ids == [310020]
    assert made.channel.alarms[0].values["value_mm"] == pytest.approx(61.2836, abs=1e-3)
    made = make_head().run(TILTED + "#TIME 0.05\n#DIST CTRL REF\n#TIME 0.05")
    assert made.alarm_ids == []
    assert made.control3d.shown_sensor_mm == pytest.approx(0.0, abs=1e-4)
    assert made.control3d.control.zero_mm == pytest.approx(-61.2836, abs=1e-3)


@pytest.mark.long
@pytest.mark.provokes(900315, 1, owner="the channel")
def test_a_variable_that_nobody_writes_is_warned_of(make_head: Make) -> None:
    """It is 0 for ever: the distance seems to be 0. A value with a period is watched (900314)."""
    made = make_head()
    made.channel.plc.inputs.clear()
    made.run(TILTED + "#DIST CTRL DRYRUN [SET_POS=0]\n#TIME 0.02")
    assert made.alarm_ids == [900315]


@pytest.mark.long
@pytest.mark.provokes(900314, 7, owner="the channel")
def test_a_value_that_does_not_come_any_more_freezes_it(make_head: Make) -> None:
    made = make_head(rising)
    refreshed = Refreshed(period_ns=1_000_000)
    made.channel.plc.refreshed["SENSOR"] = refreshed

    def grow_old() -> None:
        refreshed.age_cycles += 1

    made.at({700 + k: grow_old for k in range(20)})
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0]\n#TIME 1.5")
    assert made.alarm_ids == [900314]
    at = made.state.index(DistanceState.ERROR)
    assert at == 703  # aged once in 700, so that it is four cycles old there: more than three
    assert set(made.offset_mm[at:]) == {made.offset_mm[at]}
