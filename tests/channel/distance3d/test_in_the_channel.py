"""3D distance control of a channel: what a program, the PLC side and other functions do to it."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from axisrig.kernel.channel.distance.settings import AxisDistanceSettings
from axisrig.kernel.channel.path.soft_limits import SoftLimits
from axisrig.kernel.distance import DistanceState
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.plc.unit import Refreshed

Make = Callable[..., Any]
LONG = partial(pytest.param, marks=pytest.mark.long)
INCREMENT_MM = 10 / 2**20
SENSOR = "#DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]\n"
HEAD = "V.G.KIN_STEP[0].ID[9].PARAM[0]=1000000\nV.G.WZ_AKT.L=80\n#TRAFO [9]\n"
TILTED = HEAD + "G1 F60000 A-40\n" + SENSOR


def rising(ms: float) -> float:
    """A plane that rises by 1 mm within 0.5 s, from 500 ms on."""
    return min(max(0.0, (ms - 500) * 2e-3), 1.0)


def dwell(ms: int) -> str:
    return f"#TIME {ms / 1e3}\n"


def test_a_program_of_the_manual_runs(make_head: Make) -> None:
    """Example 2 of FCT-M3 12.2 with a surface at 1.5 mm: 0.5 mm along the tool, then out."""
    made = make_head(lambda _ms: 1.5)
    made.run(
        TILTED
        + "#DIST CTRL ON [SURFACE SET_POS=1 MODE=ECS DIRECTION=Z]\n"
        + dwell(300)
        + "#DIST CTRL WAIT OFF\nG0 Z0"
    )
    assert made.alarm_ids == [900315]
    assert max(made.offset_mm) == pytest.approx(0.5, abs=INCREMENT_MM)
    at = made.offset_mm.index(max(made.offset_mm))
    away = made.sent["Y"][at] - made.interpolated["Y"][at]
    assert away == pytest.approx(0.5 * math.tan(math.radians(40)), abs=2 * INCREMENT_MM)
    assert made.state[-1] is DistanceState.INACTIVE
    assert {n: p[-1] for n, p in made.sent.items()} == {
        n: p[-1] for n, p in made.interpolated.items()
    }


@pytest.mark.parametrize(
    "after",
    [
        "#DIST CTRL ON [SET_POS=1 MODE=MCS]\n",
        "#CS ON[0,0,0,10,0,0]\n#DIST CTRL ON [SET_POS=1]\n",
        LONG("#DIST CTRL ON [SET_POS=80 MODE=ACS DIRECTION=Z]\n"),
    ],
)
@pytest.mark.parametrize("is_optimized", [True, LONG(False)])
def test_wait_off_lasts_until_no_offset_is_on_its_way(
    make_head: Make, after: str, is_optimized: bool
) -> None:
    """The next command may take another mode or another normal at once."""
    made = make_head(lambda _ms: 1.5, is_optimized=is_optimized).run(
        TILTED
        + "#DIST CTRL ON [SET_POS=1 MODE=ECS]\n"
        + dwell(100)
        + "#DIST CTRL WAIT OFF\n"
        + after
    )
    assert made.alarm_ids == [900315]


def test_another_set_distance_while_on_is_a_warning_for_each_change(make_head: Make) -> None:
    made = make_head().run(
        TILTED
        + "#DIST CTRL ON [CONST_DIST SET_DIST=80 MODE=MCS]\n"
        + "#DIST CTRL [SET_DIST=79]\n#DIST CTRL [SET_DIST=79]\n#DIST CTRL [SET_DIST=80]\n"
        + "#DIST CTRL [SET_DIST=78]\n"
    )
    assert made.alarm_ids == [900315, 900464, 900464]


@pytest.mark.provokes(20209, 2)
def test_20209_without_its_function(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(*map(words.axis, "XYZ"), bitrate=5_000_000)
    program = parse_program("%t\n#DIST CTRL ON\nM30\n", file="t.nc", axes=("X", "Y", "Z"))
    interpreter = Interpreter(program, ("X", "Y", "Z"), bench.channel, external={})
    bench.run(interpreter.commands())
    assert bench.alarm_ids == [20209]


@pytest.mark.provokes(21837, 2)
def test_21837_without_the_option(make_head: Make) -> None:
    made = make_head(is_licensed=False).run("#DIST CTRL [KP=1]")
    assert made.alarm_ids == [21837]


# ---- what freezes it


def hold_path(plc: Any, is_on: bool) -> None:
    plc.feedhold = is_on


def stop_path(plc: Any, is_on: bool) -> None:
    plc.override_permille = 0 if is_on else 1000


def hold(axis: str) -> Any:
    def act(plc: Any, is_on: bool) -> None:
        plc.axis[axis].feedhold = is_on

    return act


def stop(axis: str) -> Any:
    def act(plc: Any, is_on: bool) -> None:
        plc.axis[axis].override_permille = 0 if is_on else 1000

    return act


def while_held(made: Any, act: Any, begin: int, end: int) -> None:
    plc = made.channel.plc
    made.at({begin: lambda: act(plc, True), end: lambda: act(plc, False)})


@pytest.mark.parametrize("mode", [LONG("MCS"), "ECS"])
@pytest.mark.parametrize("act", [hold_path, LONG(stop_path), LONG(hold("A")), stop("C")])
def test_path_feedhold_override_0_and_axes_that_it_does_not_move_change_nothing(
    make_head: Make, mode: str, act: Any
) -> None:
    made = make_head(rising)
    while_held(made, act, 600, 950)
    made.run(TILTED + f"#DIST CTRL ON [SET_POS=0 MODE={mode}]\n" + dwell(1200))
    assert made.offset_mm[900] == pytest.approx(0.8, abs=0.02)
    assert len(set(made.offset_mm[650:900])) > 200


@pytest.mark.parametrize(
    ("mode", "act"),
    [
        LONG("MCS", hold("Z")),
        ("MCS", stop("Z")),
        ("ECS", hold("Y")),
        LONG("ECS", stop("Z")),
    ],
)
def test_an_axis_that_it_moves_freezes_all_of_it_to_the_bit(
    make_head: Make, mode: str, act: Any
) -> None:
    made = make_head(rising)
    while_held(made, act, 700, 900)
    made.run(TILTED + f"#DIST CTRL ON [SET_POS=0 MODE={mode}]\n" + dwell(1300))
    assert set(made.offset_mm[700:900]) == {made.offset_mm[699]}
    assert 0.3 < made.offset_mm[699] < 0.5
    for name in ("Y", "Z"):
        assert len(set(made.sent[name][700:900])) == 1
    assert made.offset_mm[-1] == pytest.approx(1.0, abs=1e-4)


def test_mcs_is_not_frozen_by_an_axis_that_only_ecs_moves(make_head: Make) -> None:
    made = make_head(rising)
    while_held(made, hold("Y"), 700, 900)
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0 MODE=MCS]\n" + dwell(1300))
    assert len(set(made.offset_mm[700:900])) > 150


def test_an_override_of_an_axis_scales_v_max(make_head: Make) -> None:
    made = make_head(lambda _ms: 1.0, v_max_mm_s=2.0)
    made.channel.plc.axis["Y"].override_permille = 500
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n" + dwell(300))
    steps = [b - a for a, b in zip(made.offset_mm, made.offset_mm[1:], strict=False)]
    assert max(steps) == pytest.approx(1e-3, rel=1e-9)


def test_g4_and_a_wait_for_the_plc_do_not_stop_it(make_head: Make) -> None:
    made = make_head(rising)
    made.channel.plc.acknowledged_later = frozenset({"M50"})
    made.at({1200: made.channel.plc.acknowledge})
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0]\nM50\nG4 0.01")
    assert made.offset_mm[1150] == pytest.approx(1.0, abs=1e-4)


# ---- its end


@pytest.mark.parametrize("buffer_cycles", [LONG(0), 7])
def test_off_no_move_leaves_the_axes_and_the_next_block_reaches_its_true_target(
    make_head: Make, tool: Any, buffer_cycles: int
) -> None:
    """FCT-M3 12.4.4: Y 60 with the offset, NO_MOVE, then Y 70 without it."""
    made = make_head(lambda _ms: 1.5, options={"buffer_cycles": buffer_cycles})
    made.run(
        TILTED + "G1 F6000 Y0 Z0\n#DIST CTRL WAIT [ON SET_POS=1 MODE=ECS]\nY5\n"
        "#TIME 0.2\n#DIST CTRL WAIT [OFF NO_MOVE]\n#TIME 0.1\nY7 Z0"
    )
    off = len(made.state) - 1 - made.state[::-1].index(DistanceState.ACTIVE) + 1
    for name in ("X", "Y", "Z"):
        sent = made.sent[name]
        assert max(abs(p - sent[off - 1]) for p in sent[off : off + 90]) < 1e-9
    tcp = tool.tcp_of([made.sent[n][off + 50] for n in tool.names])
    assert tcp == pytest.approx((0.0, 5.0 + 0.5 * math.tan(math.radians(40)), 0.5), abs=1e-3)
    assert tool.tcp_of([made.sent[n][-1] for n in tool.names]) == pytest.approx(
        (0.0, 7.0, 0.0), abs=1e-9
    )


def test_off_runs_out_on_the_fly_and_wait_holds_the_next_block(make_head: Make) -> None:
    for word, is_moving in (("WAIT OFF", False), ("OFF", True)):
        made = make_head(lambda _ms: 1.0, v_max_mm_s=4.0)
        made.run(TILTED + f"#DIST CTRL ON [SET_POS=0]\n#TIME 0.4\n#DIST CTRL {word}\nG1 F600 X3")
        first = made.state.index(DistanceState.TURNING_OFF)
        last = len(made.state) - 1 - made.state[::-1].index(DistanceState.TURNING_OFF)
        assert last - first > 200
        assert (made.interpolated["X"][last] > 0) is is_moving
        assert made.interpolated["X"][-1] == pytest.approx(3.0)
        assert made.offset_mm[-1] == 0.0


def test_a_reset_keeps_the_offset_and_follows_no_more(make_head: Make) -> None:
    made = make_head(lambda ms: 1.0 if ms < 600 else 3.0)
    plc = made.channel.plc
    plc.outlives_program = True
    turns: list[int] = []
    plc.is_idle = lambda: len(turns) > 900

    def turn() -> None:
        turns.append(0)
        plc.wants_reset = len(turns) == 500

    plc.take_turn = turn
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 5")
    assert made.alarm_ids == [900315]
    assert made.state[-1] is DistanceState.INACTIVE
    assert set(made.offset_mm[550:]) == {made.offset_mm[550]}
    assert made.offset_mm[-1] == pytest.approx(1.0, abs=1e-4)
    assert len(set(made.sent["Y"][550:])) == 1


def test_the_end_of_the_program_keeps_it_too_and_warns_of_nothing(make_head: Make) -> None:
    made = make_head(lambda _ms: 1.0)
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 0.2")
    assert made.alarm_ids == [900315]
    assert made.state[-1] is DistanceState.INACTIVE
    assert made.sent["Y"][-1] - made.interpolated["Y"][-1] == pytest.approx(
        math.tan(math.radians(40)), abs=1e-4
    )


# ---- beside others


REFUSED = [
    ("#DIST CTRL ON [SET_POS=0 MODE=ACS]", 900461),
    ("#TRAFO OFF\n#DIST CTRL ON [SET_POS=0 MODE=ECS]", 900460),
    LONG("#TRAFO OFF\n#DIST CTRL ON [SET_POS=0]", 900461),
    LONG("#DIST CTRL ON", 310024),
    LONG("#DIST CTRL ON [CONST_DIST]", 900311),
    LONG("#DIST CTRL FREEZE", 900310),
    ("#DIST CTRL [SENSOR_SOURCE=SECOND_ENCODER]", 310029),
    ("G1 A-86\n#DIST CTRL ON [SET_POS=0 MODE=ECS]", 900463),
    ("#DIST CTRL [FILTER_TIME=0.0001]", 900465),
]


@pytest.mark.parametrize(("text", "alarm_id"), REFUSED)
@pytest.mark.provokes(900461, 2)
@pytest.mark.provokes(900460, 2)
@pytest.mark.provokes(310024, 7)
@pytest.mark.provokes(900311, 7)
@pytest.mark.provokes(900310, 7)
@pytest.mark.provokes(310029, 7)
@pytest.mark.provokes(900463, 7)
@pytest.mark.provokes(900465, 2)
def test_what_is_refused_says_where_and_moves_nothing(
    make_head: Make, text: str, alarm_id: int
) -> None:
    made = make_head(lambda _ms: 1.0).run(TILTED + f"{text}\nG1 F6000 X5")
    assert made.alarm_ids == [alarm_id]
    assert "test.nc" in str(made.channel.alarms[-1].place)
    assert set(made.offset_mm) == {0.0}
    assert made.interpolated["X"][-1] == 0.0


@pytest.mark.provokes(310027, 7)
def test_310027_without_a_variable(make_head: Make) -> None:
    made = make_head().run(HEAD + "#DIST CTRL ON [SET_POS=0]")
    assert made.alarm_ids == [310027]


@pytest.mark.parametrize(
    "word",
    [LONG("#CS ON[0,0,5,0,0,0]"), "#TRAFO OFF", LONG("#TRAFO [9]"), LONG("#CHANNEL INIT[CMDPOS]")],
)
@pytest.mark.provokes(51062, 7, plane="ECS")
def test_51062_while_its_offset_may_change(make_head: Make, word: str) -> None:
    begin = TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 0.1\n"
    made = make_head().run(begin + word)
    assert made.alarm_ids == [900315, 51062]
    for allowed in ("FREEZE", "WAIT OFF"):
        made = make_head(lambda _ms: 0.5).run(begin + f"#DIST CTRL {allowed}\n{word}\n#TIME 0.1")
        assert made.alarm_ids == [900315]
    made = make_head().run(TILTED + f"#DIST CTRL DRYRUN [MODE=ECS]\n{word}")
    assert made.alarm_ids == [900315]


def test_frozen_over_a_change_of_the_kinematic_no_axis_moves(make_head: Make) -> None:
    made = make_head(lambda _ms: 0.5)
    made.run(
        TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 0.2\n#DIST CTRL FREEZE\n#TIME 0.05\n"
        "#TRAFO OFF\n#TIME 0.1\n#TRAFO [9]\n#TIME 0.1"
    )
    first = made.state.index(DistanceState.FREEZE)
    for name in ("Y", "Z"):
        assert len(set(made.sent[name][first:])) == 1


def test_a_frozen_offset_goes_on_with_the_same_kinematic_built_again(make_head: Make) -> None:
    """#TRAFO OFF and ON between: another object, of the same numbers."""
    made = make_head(lambda ms: 0.5 if ms < 500 else 0.8)
    made.run(
        TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 0.2\n#DIST CTRL FREEZE\n#TRAFO OFF\n"
        "#TRAFO [9]\n#DIST CTRL ON\n#TIME 0.6"
    )
    assert made.alarm_ids == [900315]
    assert made.offset_mm[-1] == pytest.approx(0.8, abs=1e-4)


@pytest.mark.parametrize("counts", [False, True])
def test_software_limits_count_it_where_the_list_says_so(make_head: Make, counts: bool) -> None:
    """Z at 180 + 1 mm with the limit 180.5: P-CHAN-00809."""
    limits = {"Z": {"limits": SoftLimits(-1e3, 180.5, 0.0)}}
    made = make_head(lambda _ms: 1.0, spec=limits, checks_limits=counts)
    made.run(HEAD + SENSOR + "#DIST CTRL ON [SET_POS=0]\n#TIME 0.3")
    assert made.alarm_ids == ([900315, 70021] if counts else [900315])


# ---- one control for an axis

OWN = "Z[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR SET_POS=0 DRYRUN]"
WHOLE = "#DIST CTRL DRYRUN [SET_POS=0 MODE=MCS]"


@pytest.mark.provokes(900466, 7)
@pytest.mark.parametrize(("first", "second", "owner"), [(OWN, WHOLE, "the channel"),
                                                        (WHOLE, OWN, "axis Z")])  # fmt: skip
def test_an_axis_has_the_offset_of_one_control(
    make_head: Make, tool: Any, first: str, second: str, owner: str
) -> None:
    wide = tool.wide(sensor_sign=1)
    spec = {"Z": {"distance": AxisDistanceSettings(wide, is_optimized=True)}}
    made = make_head(lambda _ms: 80.0, spec=spec).run(TILTED + f"{first}\n#TIME 0.05\n{second}")
    assert made.alarm_ids[-1] == 900466
    assert made.channel.alarms[-1].values["owner"] == owner


def test_another_axis_may_have_its_own(make_head: Make, tool: Any) -> None:
    """In ACS 3D control moves one axis; Y is free."""
    spec = {"Y": {"distance": AxisDistanceSettings(tool.wide(sensor_sign=1), is_optimized=True)}}
    made = make_head(spec=spec).run(
        HEAD + SENSOR + "#DIST CTRL ON [SET_POS=100 MODE=ACS DIRECTION=Z]\n"
        "Y[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR SET_POS=80 ON]\n#TIME 0.05"
    )
    assert [i for i in made.alarm_ids if i not in (900315, 70332)] == []


@pytest.mark.provokes(70333, 7)
@pytest.mark.provokes(310000, 7, axis="X", owner="the channel")
@pytest.mark.parametrize(("block", "alarm_id"), [("#PUT AX[X]", 70333), ("G100 X5 F100", 310000)])
def test_its_axes_neither_leave_nor_measure(make_head: Make, block: str, alarm_id: int) -> None:
    made = make_head().run(
        TILTED
        + "#TRAFO OFF\n#DIST CTRL ON [CONST_DIST SET_DIST=61.284 MODE=ACS DIRECTION=X]\n"
        + block
    )
    assert made.alarm_ids[-1] == alarm_id


# ---- what the PLC side and a program see


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


# ---- the sensor


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


@pytest.mark.provokes(900315, 1, owner="the channel")
def test_a_variable_that_nobody_writes_is_warned_of(make_head: Make) -> None:
    """It is 0 for ever: the distance seems to be 0. A value with a period is watched (900314)."""
    made = make_head()
    made.channel.plc.inputs.clear()
    made.run(TILTED + "#DIST CTRL DRYRUN [SET_POS=0]\n#TIME 0.02")
    assert made.alarm_ids == [900315]


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
