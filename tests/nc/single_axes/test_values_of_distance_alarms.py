"""DIST_CTRL and #DIST CTRL: every value of their alarms, their limits, and the unit of their ways.

The ranges are those of P-AXIS-00507, 00759, 00764, 00765 and of P-CHAN-00816, 00821 to 00823.
"""

from collections.abc import Mapping
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import AdoptActual, DistanceCommand, Homing, Wait
from axisrig.kernel.nc.coordinates import OffsetTables
from axisrig.kernel.nc.decoder.base.context import ChannelControl

XYZA = ("X", "Y", "Z", "A")
AXIS, CHANNEL = "Z[DIST_CTRL {}]", "#DIST CTRL [{}]"
OWNERS = {AXIS: "axis Z", CHANNEL: "the channel"}


@pytest.fixture
def machine(plane_machine: Any) -> Any:
    """A channel with 3D distance control, and controls of Y and Z in a state each."""

    class Machine(plane_machine):
        known: ChannelControl | None = ChannelControl()
        states: Mapping[str, str] = {}

        def channel_distance(self) -> ChannelControl | None:
            return self.known

        def distance_state(self, axis: str) -> str | None:
            return self.states.get(axis)

    return Machine(dict.fromkeys(XYZA, 0.0), None)


def refused(run: Any, machine: Any, block: str, **more: Any) -> tuple[int, Mapping[str, object]]:
    with pytest.raises(Alarm) as caught:
        run(f"X0 F9\n{block}", machine, axes=XYZA, **more)
    assert caught.value.place == "test.nc line 2"
    return caught.value.id, caught.value.values


def words(run: Any, machine: Any, text: str, **more: Any) -> list[DistanceCommand]:
    found = run(text, machine, axes=XYZA, **more)
    return [command for command in found if isinstance(command, DistanceCommand)]


@pytest.mark.parametrize(
    ("form", "keyword", "value", "allowed"),
    [
        *((form, *row) for form in OWNERS for row in (
            ("KP", "0", "above 0.0, up to 2.0"),
            ("KP", "2.5", "above 0.0, up to 2.0"),
            ("D_TV", "-0.5", "0.0 .. 2.0 s"),
            ("D_TV", "2.5", "0.0 .. 2.0 s"),
            ("N_CYCLES", "1.5", "whole numbers"),
        )),
        (AXIS, "DISTC_N_CYCLES", "2.5", "whole numbers"),
        (CHANNEL, "FILTER_TIME", "0", "above 0"),
        (CHANNEL, "FILTER_TIME", "-0.25", "above 0"),
    ],
)  # fmt: skip
def test_900300_names_what_is_allowed_and_whose_it_is(
    run: Any, machine: Any, form: str, keyword: str, value: str, allowed: str
) -> None:
    block = f"P1={value}\n{form.format(f'{keyword}=P1')}"
    with pytest.raises(Alarm) as caught:
        run(block, machine, axes=XYZA)
    assert caught.value.id == 900300
    assert caught.value.values == {
        "keyword": keyword,
        "value": value,
        "owner": OWNERS[form],
        "allowed": allowed,
    }


@pytest.mark.parametrize("form", OWNERS)
def test_limits_with_ids_of_their_own(run: Any, machine: Any, form: str) -> None:
    for value in (-1.0, 50.5):
        found = refused(run, machine, form.format(f"I_TN={value}"))
        assert found == (22096, {"value_s": value, "low_s": 0, "high_s": 50})
    for keyword in ("ORDER", "DISTC_ORDER")[: 2 if form == AXIS else 1]:
        for value in ("7", "-1", "2.5"):
            found = refused(run, machine, form.format(f"{keyword}={value}"))
            assert found == (22142, {"value": value, "low": 0, "high": 6})


@pytest.mark.parametrize("value", ["2", "0.5", "-1"])
def test_22349_shows_what_is_neither_0_nor_1(run: Any, machine: Any, value: str) -> None:
    block = AXIS.format(f"BOTH_ENCODER={value}")
    assert refused(run, machine, block) == (22349, {"value": value})


@pytest.mark.parametrize("form", OWNERS)
def test_values_at_the_limits_are_handed_on_under_their_names(
    run: Any, machine: Any, form: str
) -> None:
    """Whole numbers as whole numbers; the others as they are."""
    low = "KP=0.001 I_TN=0 D_TV=0 ORDER=0 N_CYCLES=3 SMOOTH_FACT=0.5"
    high = "KP=2 I_TN=50 D_TV=2 ORDER=6 KALMAN_SIGMA=0.25 FG_F0=7.5"
    first, last = words(run, machine, f"{form.format(low)}\n{form.format(high)}")
    assert first.parameters == {
        "kp": 0.001, "tn_s": 0.0, "tv_s": 0.0, "low_pass_filter_order": 0, "n_cycles": 3,
        "smoothing_factor": 0.5,
    }  # fmt: skip
    assert isinstance(first.parameters["n_cycles"], int)
    assert last.parameters == {
        "kp": 2.0, "tn_s": 50.0, "tv_s": 2.0, "low_pass_filter_order": 6, "kalman_sigma": 0.25,
        "low_pass_filter_fg_f0": 7.5,
    }  # fmt: skip


def test_names_that_only_one_of_the_two_has(run: Any, machine: Any) -> None:
    text = (
        "Z[DIST_CTRL DISTC_ORDER=2 DISTC_N_CYCLES=4 BOTH_ENCODER=0]\n"
        "Z[DIST_CTRL BOTH_ENCODER=1]\n#DIST CTRL [FILTER_TIME=0.001]"
    )
    assert [each.parameters for each in words(run, machine, text)] == [
        {"low_pass_filter_order": 2, "n_cycles": 4, "both_encoders": False},
        {"both_encoders": True},
        {"filter_time_s": 0.001},
    ]


def test_ways_are_in_the_unit_of_the_program_and_of_the_axis(run: Any, machine: Any) -> None:
    text = (
        "G70\nZ[DIST_CTRL ON SET_POS=2]\nA[DIST_CTRL ON SET_POS=2]\n"
        "#DIST CTRL [ON CONST_DIST SET_DIST=2]\nG71\nZ[DIST_CTRL ON CONST_DIST SET_DIST=2]"
    )
    found = words(run, machine, text, tables=OffsetTables(rotary=frozenset("A")))
    ways = [(each.axis, each.set_pos_mm, each.set_dist_mm) for each in found]
    assert ways == [
        ("Z", 50.8, None),
        ("A", 2.0, None),
        (None, None, 50.8),
        ("Z", None, 2.0),
    ]


def test_free_values_keep_their_places(run: Any, machine: Any) -> None:
    (found,) = words(run, machine, "Z[DIST_CTRL ON VAL5=5 VAL2=-2]")
    assert found.values == (None, -2.0, None, None, 5.0)
    (found,) = words(run, machine, "Z[DIST_CTRL]")
    assert (found.action, found.values) == ("off", (None,) * 5)


def test_the_channel_gets_where_the_active_system_is(run: Any, machine: Any) -> None:
    """#CS ON[1,2,3,0,90,0]: its Z is X of the machine."""
    (found,) = words(run, machine, "#CS ON[1,2,3,0,90,0]\n#DIST CTRL [ON SURFACE]")
    assert found.origin_mm == (1.0, 2.0, 3.0)
    assert found.normal == pytest.approx((1.0, 0.0, 0.0), abs=1e-15)


def test_a_channel_without_the_control_or_without_its_option(run: Any, machine: Any) -> None:
    machine.known = None
    assert refused(run, machine, "#DIST CTRL ON") == (20209, {"word": "#DIST CTRL"})
    machine.known = ChannelControl(is_licensed=False)
    assert refused(run, machine, "#DIST CTRL ON") == (21837, {"word": "#DIST CTRL"})


def test_a_direction_is_a_linear_axis(run: Any, machine: Any) -> None:
    tables = OffsetTables(rotary=frozenset("AY"))
    found = refused(run, machine, "#DIST CTRL [MODE=ACS DIRECTION=A]", tables=tables)
    assert found == (900467, {"axis": "A", "linear": "X Z"})


@pytest.mark.parametrize(
    ("block", "word"),
    [("G74 X1 Z2", "G74"), ("#CHANNEL INIT [ACTPOS AX=Z]", "#CHANNEL INIT[ACTPOS]")],
)
@pytest.mark.parametrize("state", ["INACTIVE", "FREEZE", "ACTIVE"])
def test_51062_for_an_axis_whose_offset_changes(
    run: Any, machine: Any, block: str, word: str, state: str
) -> None:
    machine.known, machine.states = None, {"Z": state, "Y": "ACTIVE"}
    if state == "ACTIVE":
        assert refused(run, machine, block) == (51062, {"word": word, "plane": "ACS"})
        return
    commands = run(block, machine, axes=XYZA)
    assert isinstance(commands[0], Wait)  # its state is that of now
    assert any(isinstance(command, Homing | AdoptActual) for command in commands)


@pytest.mark.parametrize("state", ["INACTIVE", "FREEZE", "ACTIVE"])
def test_70333_for_an_axis_that_is_to_leave_with_its_control_on(
    run: Any, machine: Any, state: str
) -> None:
    machine.known, machine.states = None, {"Z": state}
    if state != "INACTIVE":
        assert refused(run, machine, "#PUT AX [X, Z]") == (70333, {"axis": "Z"})
        return
    assert run("#PUT AX [X, Z]", machine, axes=XYZA)


@pytest.mark.parametrize("plane", ["ACS", "ECS", "MCS", None])
@pytest.mark.parametrize("block", ["#CS ON[1,2]", "#CHANNEL INIT [CMDPOS]", "#CS OFF ALL"])
def test_51062_names_the_coordinates_in_which_the_offset_of_the_channel_changes(
    run: Any, machine: Any, block: str, plane: str | None
) -> None:
    machine.known = ChannelControl(plane=plane)
    if plane is None:
        assert run(block, machine, axes=XYZA)
        return
    alarm_id, values = refused(run, machine, block)
    assert (alarm_id, values["plane"]) == (51062, plane)
    assert str(values["word"]) == block.partition(" [")[0].partition("[")[0]
