"""Several axes or couplings in one program: each one counts, not the first of them alone."""

from collections.abc import Callable
from typing import Any

import pytest
from axis_statements import Machine, alone, decode, kinds, path, single

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.syntax import Number, Variable, Words

Run = Callable[..., list[canon.Command]]
AXES = ("X", "Y", "Z", "C", "X2")


def beside(*axes: str) -> Words:
    """Axes that move to 5 mm beside the program."""
    return single(*(alone(axis, "G90", "G0", POS=5, name="INDP_ASYN") for axis in axes))


def orders(commands: list[canon.Command], kind: type) -> list[Any]:
    return [c for c in commands if isinstance(c, kind)]


def refused(run: Run, *blocks: str) -> tuple[int, dict[str, Any]]:
    with pytest.raises(Alarm) as caught:
        run("\n".join(["%t", *blocks, "M30", ""]), axes=AXES)
    return caught.value.id, caught.value.values


# Axes under way


@pytest.mark.parametrize(
    ("moved", "awaited"),
    [
        ("XY", ("X", "Y")), ("YX", ("X", "Y")), ("YZ", ("Y",)), ("XYZ", ("X", "Y")),
        ("XYC", ("X", "Y", "C")),
    ],
)  # fmt: skip
def test_a_block_waits_for_every_axis_that_it_moves(moved: str, awaited: tuple[str, ...]) -> None:
    commands = decode(beside("X", "Y", "C"), path(**dict.fromkeys(moved, 9.0)))
    (wait,) = orders(commands, canon.WaitIndependent)
    assert sorted(wait.axes) == sorted(awaited)
    assert kinds(commands)[3:] == ["WaitIndependent", "LinearMove", "EndOfProgram"]


def test_an_axis_that_was_waited_for_is_waited_for_once() -> None:
    commands = decode(beside("X", "Y"), path(X=9.0), path(X=8.0, Y=9.0), path(X=7.0, Y=8.0))
    assert [wait.axes for wait in orders(commands, canon.WaitIndependent)] == [("X",), ("Y",)]


def test_homing_waits_for_axes_that_it_does_not_home() -> None:
    """The channel waits until all axes are at standstill."""
    home = Words(g=("G74",), axes=(("Z", Number(1.0)),))
    commands = decode(beside("X", "C"), home)
    (wait,) = orders(commands, canon.WaitIndependent)
    assert wait.axes == ("X", "C")
    assert kinds(commands)[2:] == ["WaitIndependent", "Homing", "Wait", "EndOfProgram"]


@pytest.mark.parametrize("name", ["INDP_SYN", "INDP_ASYN"])
def test_functions_of_an_axis_that_stands_at_its_target_go_to_the_plc_side(
    run: Run, name: str
) -> None:
    """Nothing moves, and M25 and H7 are sent all the same."""
    commands = run(f"%t\nX[{name} G90 G0 POS=0 M25 H7]\nM30\n")
    sent = [(c.letter, c.number) for c in orders(commands, canon.TechnologyFunction)]
    assert sent == [("M", 25), ("H", 7)]
    assert orders(commands, canon.IndependentMove) == []


# Couplings


@pytest.mark.parametrize("group", [1, 31])
def test_groups_are_1_to_31(run: Run, group: int) -> None:
    text = f"%t\n#SET AX LINK[{group}, X2=X]\n#ENABLE AX LINK[{group}]\nM30\n"
    (on,) = orders(run(text, axes=AXES), canon.AxisLinkOn)
    assert on.group == group


@pytest.mark.parametrize("group", [-1, 0, 32, 31.5])
def test_another_group_cannot_be_defined(run: Run, group: float) -> None:
    assert refused(run, f"#SET AX LINK[{group}, X2=X]") == (
        900197, {"group": f"{group:g}", "what": "cannot be defined"},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("limits", "is_right"),
    [("15,20", True), ("15,15", True), ("0.001,0.001", True), ("15,14.999", False),
     ("0,15", False), ("-1,15", False)],
)  # fmt: skip
def test_the_second_limit_of_a_gantry_is_not_below_the_first(
    run: Run, limits: str, is_right: bool
) -> None:
    define = f"#SET AX LINK[1, [X2=X,G,{limits}]]"
    if is_right:
        commands = run(f"%t\n{define}\n#ENABLE AX LINK[1]\nM30\n", axes=AXES)
        first, second = map(float, limits.split(","))
        (on,) = orders(commands, canon.AxisLinkOn)
        assert on.pairs == (canon.AxisPair("X2", "X", (first, second)),)
    else:
        assert refused(run, define)[0] == 900198


def test_a_group_that_is_off_may_be_defined_anew(run: Run) -> None:
    """Before it was ever on, and after it was; the last definition counts."""
    text = (
        "%t\n#SET AX LINK[1, X2=X]\n#SET AX LINK[1, C=Y]\n#ENABLE AX LINK[1]\n#DISABLE AX LINK[1]\n"
        "#SET AX LINK[1, X2=Z]\n#ENABLE AX LINK[1]\nM30\n"
    )
    first, second = orders(run(text, axes=AXES), canon.AxisLinkOn)
    assert (first.pairs, second.pairs) == (
        (canon.AxisPair("C", "Y"),), (canon.AxisPair("X2", "Z"),),
    )  # fmt: skip


@pytest.mark.parametrize("pairs", ["C=Y, X2=X", "X2=X, C=Y"])
def test_each_slave_of_a_group_keeps_its_own_distance(run: Run, pairs: str) -> None:
    """X2 is coupled 7 mm before X, and C 4 mm behind Y; then X goes to 25 and Y to 40."""
    text = (
        f"%t\nG1 X10 Y20 X2=17 C=16 F600\n#SET AX LINK[1, {pairs}]\n#ENABLE AX LINK[1]\n"
        'G1 X25 Y40\n#MSG ["%g %g", V.A.ABS.X2, V.A.ABS.C]\nM30\n'
    )
    (message,) = orders(run(text, axes=AXES), canon.Message)
    assert message.text == "32 36"


@pytest.mark.parametrize(
    ("away", "define"), [("X", "X2=X"), ("X2", "X2=X"), ("Y", "X2=X, C=Y"), ("C", "X2=X, C=Y")]
)
def test_neither_master_nor_slave_of_any_pair_may_be_away(run: Run, away: str, define: str) -> None:
    blocks = f"#PUT AX[{away}]", f"#SET AX LINK[1, {define}]", "#ENABLE AX LINK[1]"
    assert refused(run, *blocks) == (900195, {"axis": away})


@pytest.mark.parametrize("axis", ["X", "Y", "C", "X2"])
def test_no_axis_of_a_coupling_leaves_the_channel(run: Run, axis: str) -> None:
    """20545 names the group in which the axis is, as master or as slave."""
    on = "#ENABLE AX LINK[1]", "#ENABLE AX LINK[2]"
    blocks = "#SET AX LINK[1, X2=X]", "#SET AX LINK[2, C=Y]", *on, f"#PUT AX[Z, {axis}]"
    group = 1 if axis in ("X", "X2") else 2
    assert refused(run, *blocks) == (20545, {"axis": axis, "group": group})


# Axes that are away


@pytest.mark.parametrize("away", ["X", "Z"])
def test_distance_control_of_an_axis_that_is_away_is_refused_at_any_place(
    run: Run, away: str
) -> None:
    both = "X[DIST_CTRL OFF] Z[DIST_CTRL OFF]"
    assert refused(run, f"#PUT AX[{away}]", both) == (900195, {"axis": away})


def test_axes_that_are_called_back_together_begin_where_each_stands(run: Run) -> None:
    """Meanwhile another channel has led X to 3 and X2 to 8."""

    class Elsewhere(Machine):
        def execute(self) -> None:
            if orders(self.queue, canon.AxisExchange):
                self.acs_mm |= {"X": 3.0, "X2": 8.0}
            super().execute()

    from_text = ("%t", "#PUT AX[X, X2]", "#CALL AX[X,1,0] [X2,5,4]", "G1 X3 X2=8 F600", "M30", "")
    commands = run("\n".join(from_text), Elsewhere(), axes=AXES)
    assert orders(commands, canon.LinearMove) == []


def test_an_axis_that_is_not_called_stays_away(run: Run) -> None:
    blocks = "#PUT AX[X, Y]", "#CALL AX[X,1,0]", "G1 X1 F600"
    assert orders(run("\n".join(["%t", *blocks, "M30", ""]), axes=AXES), canon.LinearMove)
    assert refused(run, *blocks, "G1 Y1") == (900195, {"axis": "Y"})


@pytest.mark.parametrize(
    ("away", "called", "alarm_id"),
    [
        # The name or the index of another axis, which is in the channel or away as well
        ("X", "Y,1,0", 21261), ("X, Y", "Y,1,0", 900199),
        ("X", "X,1,1", 21260), ("X, Y", "X,1,1", 900199),
        ("X", "X,1,5", 900199),
    ],
)  # fmt: skip
def test_a_place_that_is_taken_and_one_that_is_wrong(
    run: Run, away: str, called: str, alarm_id: int
) -> None:
    assert refused(run, f"#PUT AX[{away}]", f"#CALL AX[{called}]")[0] == alarm_id


def test_with_actpos_the_set_positions_of_the_other_axes_count_too(run: Run) -> None:
    """Y becomes its actual position; X, which is not named, was led to 3 meanwhile."""

    class Led(Machine):
        def execute(self) -> None:
            if orders(self.queue, canon.AdoptActual):
                self.acs_mm |= {"X": 3.0, "Y": 0.02}
            super().execute()

    text = "%t\n#CHANNEL INIT[ACTPOS AX=Y]\nG1 X3 Y0.02 Z1 F600\nM30\n"
    commands = run(text, Led(), axes=AXES)
    (adopted,) = orders(commands, canon.AdoptActual)
    assert adopted.axes == ("Y",)
    assert [c.target_mm for c in orders(commands, canon.LinearMove)] == [{"Z": 1.0}]


def test_with_cmdpos_the_named_axes_alone_begin_anew(run: Run) -> None:
    """Led to 3 and to 4, and X is named: the program knows that of X alone."""

    class Led(Machine):
        def execute(self) -> None:
            super().execute()
            self.acs_mm |= {"X": 3.0, "Y": 4.0}

    for named, moved in ((" AX=X", {"Y": 4.0}), (" AXNR=2", {"X": 3.0}), ("", None)):
        text = f"%t\n#CHANNEL INIT[CMDPOS{named}]\nG1 X3 Y4 F600\nM30\n"
        targets = [c.target_mm for c in orders(run(text, Led(), axes=AXES), canon.LinearMove)]
        assert targets == ([] if moved is None else [moved])


# Values of distance control


@pytest.mark.parametrize(("value", "expected"), [(0, False), (1, True)])
@pytest.mark.parametrize("axis", ["X", "Z"])
def test_both_encoders_are_switched_on_and_off(
    run: Run, axis: str, value: int, expected: bool
) -> None:
    commands = run(f"%t\n{axis}[DIST_CTRL ON BOTH_ENCODER={value}]\nM30\n")
    (command,) = orders(commands, canon.DistanceCommand)
    assert (command.axis, command.parameters) == (axis, {"both_encoders": expected})


# Names of several letters


def test_asking_for_a_run_of_an_axis_with_a_long_name_takes_a_cycle() -> None:
    """X2 measures beside the program; X, whose name begins alike, does not."""
    run_of_x2 = single(alone("X2", "G100", "G90", POS=9, FEED=100, name="INDP_ASYN"))
    for axis, cycles in (("X2", [True]), ("X", [False])):
        machine = Machine()
        machine.measuring = {"X2"}
        ask = Words(axes=(("C", Variable(f"V.A.MERF.{axis}")),), addresses=(("F", Number(60.0)),))
        commands = decode(run_of_x2, ask, machine=machine)
        assert [c.for_cycle for c in orders(commands, canon.Wait)] == cycles


@pytest.mark.parametrize(
    ("variable", "waits"), [("V.E.F[1]", []), ("V.E.F[P1]", []), ("V.E.F[V.E.N]", [True])]
)
def test_the_index_of_a_sensor_is_read_and_the_sensor_is_not(
    run: Run, variable: str, waits: list[bool]
) -> None:
    """Which variable it is the program says when it gets there; its value is for the control."""
    external = {"F[0]": 0.0, "F[1]": 0.0, "N": 1.0}
    text = f"%t\nP1=1\nZ[DIST_CTRL ON SENSOR_VAR={variable}]\nM30\n"
    commands = run(text, external=external)
    (command,) = orders(commands, canon.DistanceCommand)
    assert command.sensor_variable == "F[1]"
    assert [c.for_cycle for c in orders(commands, canon.Wait)] == waits
