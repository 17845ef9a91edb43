"""#DIST CTRL: both forms of FCT-M3 12.2 to a plain command, and what is refused before."""

import math
from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.coordinates import OffsetTables
from axisrig.kernel.nc.decoder.base.context import ChannelControl

Run = Callable[..., Any]


@pytest.fixture
def machine(plane_machine: Any) -> Any:
    """A channel with 3D distance control; `plane`: where its offset changes now."""

    class Machine(plane_machine):
        known: ChannelControl | None = ChannelControl()

        def channel_distance(self) -> ChannelControl | None:
            return self.known

    return Machine(dict.fromkeys(("X", "Y", "Z"), 0.0), None)


def commands(run: Run, machine: Any, *blocks: str) -> list[Any]:
    lines = "\n".join(blocks)
    found: list[Any] = run(f"%t\n{lines}\nM30\n", machine, external={"SENSOR": 0.0})
    return found


def one(run: Run, machine: Any, *blocks: str) -> canon.DistanceCommand:
    found = commands(run, machine, *blocks)
    (command,) = (c for c in found if isinstance(c, canon.DistanceCommand))
    assert command.axis is None
    return command


# What is written, and what the channel gets
FORMS: list[tuple[str, dict[str, Any]]] = [
    ("ON [SURFACE SET_POS=10]", {"action": "on", "set_pos_mm": 10.0}),
    ("ON [SET_POS=10]", {"action": "on", "set_pos_mm": 10.0}),
    ("WAIT ON [SURFACE]", {"action": "on", "wait": True}),
    ("WAIT [ON SET_POS=10]", {"action": "on", "wait": True, "set_pos_mm": 10.0}),
    ("[WAIT ON SET_POS=10]", {"action": "on", "wait": True, "set_pos_mm": 10.0}),
    ("ON", {"action": "on"}),
    ("ON [CONST_DIST SET_DIST=80]", {"action": "on_const", "set_dist_mm": 80.0}),
    ("WAIT [ON CONST_DIST]", {"action": "on_const", "wait": True}),
    ("DRYRUN [CONST_DIST SET_DIST=1]", {"action": "on_const", "dry_run": True, "set_dist_mm": 1}),
    ("[DRYRUN]", {"action": "on", "dry_run": True}),
    ("OFF", {"action": "off"}),
    ("[OFF]", {"action": "off"}),
    ("WAIT OFF", {"action": "off", "wait": True}),
    ("OFF NO_MOVE", {"action": "off", "no_move": True}),
    ("WAIT [OFF NO_MOVE]", {"action": "off", "no_move": True, "wait": True}),
    ("WAIT FREEZE", {"action": "freeze", "wait": True}),
    ("[FREEZE]", {"action": "freeze"}),
    ("CHECK_POS", {"action": "check"}),
    ("[REF]", {"action": "ref"}),
    ("[MODE=ECS DIRECTION=Z]", {"mode": "ECS", "direction": "Z"}),
    ("ON [CONST_DIST SET_DIST=1 MODE=ACS DIRECTION=Z]",
     {"action": "on_const", "set_dist_mm": 1.0, "mode": "ACS", "direction": "Z"}),
    ("[SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]",
     {"sensor_source": "VARIABLE", "sensor_variable": "SENSOR"}),
    ("[FILTER_TYPE=MOVING_AVERAGE FILTER_TIME=0.02]",
     {"parameters": {"filter_type": "MOVING_AVERAGE", "filter_time_s": 0.02}}),
    ("[KP=0.3 I_TN=5 D_TV=0.01 FILTER_TYPE=LOWPASS FG_F0=50 ORDER=3 VAL2=7]",
     {"parameters": {"kp": 0.3, "tn_s": 5.0, "tv_s": 0.01, "filter_type": "LOWPASS",
                     "low_pass_filter_fg_f0": 50.0, "low_pass_filter_order": 3},
      "values": (None, 7.0, None, None, None)}),
    ("[N_CYCLES=20 SMOOTH_FACT=0.05 KALMAN_SIGMA=2000]",
     {"parameters": {"n_cycles": 20, "smoothing_factor": 0.05, "kalman_sigma": 2000.0}}),
]  # fmt: skip


@pytest.mark.parametrize(("words", "expected"), FORMS)
def test_both_forms_of_the_chapter_mean_the_same(
    run: Run, machine: Any, words: str, expected: dict[str, Any]
) -> None:
    found = one(run, machine, f"N10 #DIST CTRL {words}")
    assert found == canon.DistanceCommand(found.block, None, **expected)


@pytest.mark.parametrize(
    "words",
    ["ON [SURFACE SET_POS=10 MODE=ECS]", "[SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]"],
)
def test_a_command_is_one_block_over_several_lines(run: Run, machine: Any, words: str) -> None:
    split = words.replace(" ", " \\\n", 1)
    assert one(run, machine, f"#DIST CTRL {words}").set_pos_mm == (
        one(run, machine, f"#DIST CTRL {split}").set_pos_mm
    )


def test_inches_count(run: Run, machine: Any) -> None:
    found = one(run, machine, "G70", "#DIST CTRL [SET_POS=1 SET_DIST=0.5]")
    assert (found.set_pos_mm, found.set_dist_mm) == (25.4, 12.7)


def test_the_normal_is_z_of_the_active_system(run: Run, machine: Any) -> None:
    """#CS turned by 30 deg about Y: its Z leans by 30 deg to +X."""
    found = one(run, machine, "#CS ON[10,20,30,0,30,0]", "#DIST CTRL ON [SET_POS=1 MODE=MCS]")
    assert found.normal == pytest.approx((0.5, 0.0, math.sqrt(0.75)), abs=1e-15)
    assert found.origin_mm == (10.0, 20.0, 30.0)
    plain = one(run, machine, "#DIST CTRL ON [SET_POS=1]")
    assert (plain.normal, plain.origin_mm) == ((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))


def test_after_off_no_move_the_program_counts_from_where_the_axes_are(
    run: Run, plane_machine: Any
) -> None:
    class Led(plane_machine):
        def channel_distance(self) -> ChannelControl:
            return ChannelControl()

        def execute(self) -> None:
            is_off = any(isinstance(c, canon.DistanceCommand) and c.no_move for c in self.queue)
            super().execute()
            for axis, way_mm in (("Y", -1.0), ("Z", 2.0)):
                self.acs_mm[axis] += way_mm if is_off else 0.0

    machine = Led(dict.fromkeys(("X", "Y", "Z"), 0.0), None)
    found = commands(
        run, machine, "G0 Y5 Z10", "#DIST CTRL [OFF NO_MOVE]", "G91 G0 Y1 Z1", "G90 G0 Y70 Z0"
    )
    moves = [c.target_mm for c in found if isinstance(c, canon.LinearMove)]
    assert [(m["Y"], m["Z"]) for m in moves] == [(5.0, 10.0), (5.0, 13.0), (70.0, 0.0)]


def test_after_off_no_move_all_axes_of_the_channel_count_from_where_they_are(
    run: Run, plane_machine: Any
) -> None:
    """Also those behind the main axes."""
    axes = ("X", "Y", "Z", "U", "V")

    class Led(plane_machine):
        def channel_distance(self) -> ChannelControl:
            return ChannelControl()

        def execute(self) -> None:
            is_off = any(isinstance(c, canon.DistanceCommand) and c.no_move for c in self.queue)
            super().execute()
            if is_off:
                self.acs_mm.update({axis: mm + 2.0 for axis, mm in self.acs_mm.items()})

    text = "%t\nG0 X1 U5\n#DIST CTRL [OFF NO_MOVE]\nG91 G0 X1 Y1 Z1 U1 V1\nM30\n"
    found = run(text, Led(dict.fromkeys(axes, 0.0), None), axes=axes)
    last = [c.target_mm for c in found if isinstance(c, canon.LinearMove)][-1]
    assert last == {"X": 4.0, "Y": 3.0, "Z": 3.0, "U": 8.0, "V": 3.0}


# ---- refused


@pytest.mark.provokes(20209, 2, word="#DIST CTRL")
@pytest.mark.parametrize("words", ["ON [SURFACE SET_POS=3]", "[]"])
def test_20209_without_p_chan_00500(run: Run, machine: Any, words: str) -> None:
    """FCT-M3 12.7 prints the command with empty brackets."""
    machine.known = None
    with pytest.raises(Alarm) as caught:
        commands(run, machine, f"N30 #DIST CTRL {words}")
    assert (caught.value.id, caught.value.values) == (20209, {"word": "#DIST CTRL"})
    assert str(caught.value.place).endswith("block N30")


def test_empty_brackets_set_nothing(run: Run, machine: Any) -> None:
    (found,) = (
        each
        for each in commands(run, machine, "#DIST CTRL []")
        if isinstance(each, canon.DistanceCommand)
    )
    assert (found.action, found.parameters, found.mode, found.wait) == (None, {}, None, False)


@pytest.mark.provokes(21837, 2, word="#DIST CTRL")
def test_21837_without_the_option(run: Run, machine: Any) -> None:
    machine.known = ChannelControl(is_licensed=False)
    with pytest.raises(Alarm) as caught:
        commands(run, machine, "#DIST CTRL [KP=1]")
    assert caught.value.id == 21837


@pytest.mark.provokes(22356, 2)
@pytest.mark.parametrize(("written", "value"), [("PCS", "PCS"), ("1", "1")])
def test_22356_for_every_orientation_of_the_workpiece(
    run: Run, machine: Any, written: str, value: str
) -> None:
    with pytest.raises(Alarm) as caught:
        commands(run, machine, f"#DIST CTRL ON [SET_POS=1 WP_ORIENTATION={written}]")
    assert (caught.value.id, caught.value.values) == (22356, {"value": value})


@pytest.mark.provokes(900467, 2, axis="Y", linear="X Z")
@pytest.mark.parametrize("mode", ["", " MODE=ACS", " MODE=ECS"])
def test_900467_for_a_rotary_axis(run: Run, machine: Any, mode: str) -> None:
    text = f"%t\n#DIST CTRL [DIRECTION=Y{mode}]\nM30\n"
    with pytest.raises(Alarm) as caught:
        run(text, machine, tables=OffsetTables(rotary=frozenset("Y")))
    assert (caught.value.id, caught.value.values) == (900467, {"axis": "Y", "linear": "X Z"})


@pytest.mark.provokes(900121, 2)
@pytest.mark.parametrize("name", ["TOOL_TILT", "TOOL_LENGTH"])
def test_a_program_reads_inclination_and_length_and_does_not_write_them(
    run: Run, machine: Any, name: str
) -> None:
    program, external = f"%t\nV.P.X = V.E.{name}\nV.E.{name} = 1\nM30\n", {name: 0.0}
    with pytest.raises(Alarm) as caught:
        run(program, machine, external=external)
    assert (caught.value.id, caught.value.values) == (900121, {"name": f"V.E.{name}"})
    machine.known = None  # a PLC may have a variable of this name
    run(program, machine, external=external)


@pytest.mark.parametrize(
    ("words", "alarm_id"),
    [
        ("KP=P1", 900300), ("D_TV=P1", 900300), ("N_CYCLES=P1/2", 900300),
        ("FILTER_TIME=P1-3", 900300), ("I_TN=60", 22096), ("ORDER=7", 22142),
    ],
)  # fmt: skip
@pytest.mark.provokes(900300, 2, owner="the channel")
@pytest.mark.provokes(22096, 2)
@pytest.mark.provokes(22142, 2)
def test_values_out_of_range_have_the_ids_of_an_axis(
    run: Run, machine: Any, words: str, alarm_id: int
) -> None:
    with pytest.raises(Alarm) as caught:
        commands(run, machine, "P1=3", f"#DIST CTRL [{words}]")
    assert caught.value.id == alarm_id


@pytest.mark.parametrize("words", ["WAIT CHECK_POS", "WAIT REF", "WAIT [REF]", "[WAIT REF]"])
def test_wait_may_be_beside_every_action(run: Run, machine: Any, words: str) -> None:
    """FCT-M3 12.2; both act when they are reached, so that there is nothing to wait for."""
    given = commands(run, machine, f"N10 #DIST CTRL {words}")
    (found,) = (each for each in given if isinstance(each, canon.DistanceCommand))
    assert (found.wait, found.action) == (True, "ref" if "REF" in words else "check")


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("ON OFF", "ON and OFF of #DIST CTRL exclude each other"),
        ("FREEZE [ON]", "FREEZE and ON of #DIST CTRL exclude each other"),
        ("ON [SURFACE CONST_DIST SET_DIST=1]", "SURFACE and CONST_DIST of #DIST CTRL exclude"),
        ("[NO_MOVE]", "NO_MOVE of #DIST CTRL needs OFF"),
        ("[SURFACE SET_POS=1]", "SURFACE of #DIST CTRL needs ON or DRYRUN"),
        ("WAIT", "WAIT of #DIST CTRL needs"),
        ("WAIT [KP=0.1]", "WAIT of #DIST CTRL needs"),
        ("[N_CYCLES=3 FILTER_TIME=0.1]", "N_CYCLES and FILTER_TIME of #DIST CTRL are the same"),
        ("", "#DIST CTRL says nothing"),
        ("ON [MODE=PCS]", "MODE takes"),
        ("ON [MODE=ACS DIRECTION=W]", "no such axis"),
        ("[SENSOR_SOURCE=THIRD]", "SENSOR_SOURCE takes"),
        ("ON [SET_POS 1 SPEED=3]", "unknown keyword"),
    ],
)
def test_what_the_text_cannot_mean_is_refused_with_its_place(
    run: Run, machine: Any, words: str, reason: str
) -> None:
    with pytest.raises(UserError) as caught:
        commands(run, machine, f"N10 #DIST CTRL {words}")
    assert reason in str(caught.value)
    assert (caught.value.file, caught.value.line) == ("test.nc", 2)


# ---- what a control that is on forbids

TURNS = (
    "#CS ON[0,0,5,0,0,0]",
    "#CHANNEL INIT[CMDPOS]",
    "#CHANNEL INIT[ACTPOS]",
    "#CHANNEL INIT[ACTPOS AX=X]",
)


@pytest.mark.parametrize("plane", ["ACS", "ECS", "MCS"])
@pytest.mark.parametrize("block", TURNS)
@pytest.mark.provokes(51062, 7)
def test_51062_for_what_begins_the_position_of_the_channel_anew(
    run: Run, machine: Any, block: str, plane: str
) -> None:
    machine.known = ChannelControl(plane)
    with pytest.raises(Alarm) as caught:
        commands(run, machine, f"N20 {block}")
    assert (caught.value.id, caught.value.values["plane"]) == (51062, plane)
    assert str(caught.value.values["word"]) in block


@pytest.mark.parametrize("block", TURNS)
def test_it_is_allowed_while_no_axis_offset_changes(run: Run, machine: Any, block: str) -> None:
    commands(run, machine, block)


@pytest.mark.parametrize("block", ["G92 Z5", "G54", "G18", "#CS DEF[1][0,0,5,0,0,0]"])
def test_shifts_of_the_program_are_allowed_at_any_time(run: Run, machine: Any, block: str) -> None:
    machine.known = ChannelControl("MCS")
    assert isinstance(commands(run, machine, block)[-1], canon.EndOfProgram)


def test_a_channel_without_3d_control_is_not_waited_for(run: Run, machine: Any) -> None:
    machine.known = None
    found = commands(run, machine, "#CS ON[0,0,5,0,0,0]")
    assert [type(c) for c in found] == [canon.EndOfProgram]
