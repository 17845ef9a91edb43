"""3D distance control beside other functions: what is refused, whose offset an axis has."""

from typing import Any

import pytest
from tests.channel.distance3d.programs import HEAD, LONG, SENSOR, TILTED, Make

from axisrig.kernel.channel.distance.settings import AxisDistanceSettings
from axisrig.kernel.channel.path.soft_limits import SoftLimits
from axisrig.kernel.distance import DistanceState

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


@pytest.mark.long
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
@pytest.mark.long
def test_51062_while_its_offset_may_change(make_head: Make, word: str) -> None:
    begin = TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 0.1\n"
    made = make_head().run(begin + word)
    assert made.alarm_ids == [900315, 51062]
    for allowed in ("FREEZE", "WAIT OFF"):
        made = make_head(lambda _ms: 0.5).run(begin + f"#DIST CTRL {allowed}\n{word}\n#TIME 0.1")
        assert made.alarm_ids == [900315]
    made = make_head().run(TILTED + f"#DIST CTRL DRYRUN [MODE=ECS]\n{word}")
    assert made.alarm_ids == [900315]


@pytest.mark.long
def test_frozen_over_a_change_of_the_kinematic_no_axis_moves(make_head: Make) -> None:
    made = make_head(lambda _ms: 0.5)
    made.run(
        TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 0.2\n#DIST CTRL FREEZE\n#TIME 0.05\n"
        "#TRAFO OFF\n#TIME 0.1\n#TRAFO [9]\n#TIME 0.1"
    )
    first = made.state.index(DistanceState.FREEZE)
    for name in ("Y", "Z"):
        assert len(set(made.sent[name][first:])) == 1


@pytest.mark.long
def test_a_frozen_offset_goes_on_with_the_same_kinematic_built_again(make_head: Make) -> None:
    """#TRAFO OFF and ON between: another object, of the same numbers."""
    made = make_head(lambda ms: 0.5 if ms < 500 else 0.8)
    made.run(
        TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 0.2\n#DIST CTRL FREEZE\n#TRAFO OFF\n"
        "#TRAFO [9]\n#DIST CTRL ON\n#TIME 0.6"
    )
    assert made.alarm_ids == [900315]
    assert made.offset_mm[-1] == pytest.approx(0.8, abs=1e-4)


@pytest.mark.long
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


@pytest.mark.long
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


@pytest.mark.long
@pytest.mark.provokes(70333, 7)
@pytest.mark.provokes(900521, 7, axis="X", owner="the channel")
@pytest.mark.parametrize(("block", "alarm_id"), [("#PUT AX[X]", 70333), ("G100 X5 F100", 900521)])
def test_its_axes_neither_leave_nor_measure(make_head: Make, block: str, alarm_id: int) -> None:
    made = make_head().run(
        TILTED
        + "#TRAFO OFF\n#DIST CTRL ON [CONST_DIST SET_DIST=61.284 MODE=ACS DIRECTION=X]\n"
        + block
    )
    assert made.alarm_ids[-1] == alarm_id


BARRED = pytest.mark.provokes(310005, 7, owner="the channel")


@pytest.mark.parametrize(
    ("word", "ids"), [pytest.param("ON", [310005], marks=BARRED), ("DRYRUN", [])]
)
@pytest.mark.long(but=1)
def test_an_axis_that_measures_beside_the_program_bars_all_but_a_dry_run(
    make_head: Make, word: str, ids: list[int]
) -> None:
    """A dry run moves nothing, so that the run of the axis is not touched."""
    made = make_head().run(
        HEAD
        + SENSOR
        + "#TRAFO OFF\nX[INDP_ASYN G100 G90 POS=50 FEED=600]\n#TIME 0.05\n"
        + f"#DIST CTRL {word} [SET_POS=100 MODE=ACS DIRECTION=X]\n#TIME 0.05"
    )
    assert [i for i in made.alarm_ids if i != 900315] == ids
    assert set(made.offset_mm) == {0.0}
