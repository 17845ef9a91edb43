"""INDP_SYN, INDP_ASYN and #WAIT INDP: what the channel is told, and what is refused."""

from dataclasses import replace

import pytest
from axis_statements import Machine, alone, decode, kinds, measuring_type, moves, path, single

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.syntax import AxisCommand, Command, Group, Name, Number, Variable, Words


def test_axes_of_one_block_begin_together_and_the_next_block_waits_for_both() -> None:
    """FCT-C4, %Independent_measurement_path."""
    x = alone("X", "G100", "G90", POS=100, FEED=500)
    y = alone("Y", "G100", "G90", POS=100, FEED=1000)
    commands = decode(single(x, y), path(X=1.0))
    assert kinds(commands) == [
        *["IndependentMove"] * 2, "WaitIndependent", "Wait", "LinearMove", "EndOfProgram"
    ]  # fmt: skip
    first, second = moves(commands)
    assert (first.axis, first.target_mm, first.feed_mm_min) == ("X", 100.0, 500.0)
    assert (second.axis, second.target_mm, second.feed_mm_min) == ("Y", 100.0, 1000.0)
    assert (first.measuring_type, second.measuring_type) == (1, 1)
    assert commands[2] == canon.WaitIndependent(commands[2].block, ("X", "Y"))


def test_the_path_of_the_block_moves_at_the_same_time() -> None:
    z = alone("Z", "G1", "G90", POS=5, FEED=100)
    assert kinds(decode(single(z, X=10.0), path(Y=1.0))) == [
        "IndependentMove", "LinearMove", "WaitIndependent", "LinearMove", "EndOfProgram"
    ]  # fmt: skip


def test_an_asynchronous_axis_is_waited_for_when_a_block_moves_it() -> None:
    """TF5200 channel parameters 502430091, first example, and mode 0 of P-CHAN-00451."""
    x = alone("X", "G90", "G1", POS=50, FEED=3000, name="INDP_ASYN")
    commands = decode(single(x), path(Y=20.0), path(X=50.0, Y=25.0), path(X=60.0))
    assert kinds(commands) == [
        "IndependentMove", "LinearMove", "LinearMove", "WaitIndependent", "LinearMove",
        "EndOfProgram",
    ]  # fmt: skip


def test_an_asynchronous_axis_is_waited_for_before_it_is_commanded_again() -> None:
    x = alone("X", "G90", "G1", POS=50, FEED=3000, name="INDP_ASYN")
    back = alone("X", "G90", "G0", POS=0, name="INDP_ASYN")
    assert kinds(decode(single(x), single(back))) == [
        "IndependentMove", "WaitIndependent", "IndependentMove", "EndOfProgram"
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("command", "awaited"),
    [
        (Command("WAIT INDP", (Name("X"),)), ("X",)),
        (Command("WAIT INDP", (Name("Y"), Name("Z"))), ("Y",)),
        (Command("WAIT INDP", (Name("ALL"),)), ("X", "Y")),
        (Command("WAIT INDP"), ("X", "Y")),
    ],
)
def test_wait_indp_waits_for_those_that_are_under_way(
    command: Command, awaited: tuple[str, ...]
) -> None:
    orders = [alone(a, "G90", "G1", POS=50, FEED=3000, name="INDP_ASYN") for a in "XY"]
    commands = decode(single(*orders), command)
    assert [c.axes for c in commands if isinstance(c, canon.WaitIndependent)] == [awaited]


def test_speeds_and_weights() -> None:
    commands = decode(
        single(
            alone("X", "G90", "G1", POS=1, TIME=2.5, ACC_WEIGHT=50),
            alone("Y", "G90", "G1", POS=1, FEED_MAX_WEIGHT=20),
            alone("Z", "G90", "G0", POS=1, RAPID_ACC_WEIGHT=25, ACC_WEIGHT=50),
            alone("C", "G90", POS=1, FEED=30, SLOPE_TYPE="STEP"),
        )
    )
    x, y, z, c = moves(commands)
    assert (x.time_s, x.acceleration_share, x.feed_mm_min) == (2.5, 0.5, None)
    assert (y.speed_share, y.acceleration_share) == (0.2, 1.0)
    assert (z.feed_mm_min, z.time_s, z.speed_share, z.acceleration_share) == (None,) * 3 + (0.25,)
    assert (c.feed_mm_min, c.measuring_type) == (30.0, None)


def test_positions_are_axis_positions_unless_offsets_are_included() -> None:
    shift = Words(g=("G92",), axes=(("X", Number(10.0)), ("Y", Number(10.0))))
    plain = alone("X", "G90", "G0", POS=5)
    shifted = alone("Y", "G90", "G0", "INCL_OFFSETS", POS=5)
    commands = decode(shift, single(plain, shifted), path(X=0.0, Y=0.0))
    assert [m.target_mm for m in moves(commands)] == [5.0, 15.0]
    assert [c.target_mm for c in commands if isinstance(c, canon.LinearMove)] == [
        {"X": 10.0, "Y": 10.0}
    ]


def test_relative_positions_count_from_the_target_before() -> None:
    step = alone("X", "G91", "G0", POS=2)
    commands = decode(single(step), single(step), single(step), path(X=6.0, Y=1.0))
    assert [m.target_mm for m in moves(commands)] == [2.0, 4.0, 6.0]
    assert [c.target_mm for c in commands if isinstance(c, canon.LinearMove)] == [{"Y": 1.0}]


def test_an_axis_that_is_there_does_not_move() -> None:
    assert kinds(decode(single(alone("X", "G90", "G0", POS=0)))) == [
        "WaitIndependent", "EndOfProgram"
    ]  # fmt: skip


def test_the_measured_value_of_an_independent_axis() -> None:
    machine = Machine()
    machine.measured = {"X": 40.0}
    run = alone("X", "G100", "G90", POS=100, FEED=500, name="INDP_ASYN")
    names = ("MESS", "MERF", "MOFFS", "MEAS.ACS.VALUE")
    results = [path(Y=1.0)] + [
        Words(axes=(("C", Variable(f"V.A.{name}.X")),), addresses=(("F", Number(60.0)),))
        for name in names
    ]
    wait = Command("WAIT INDP", (Name("X"),))
    commands = decode(single(run), wait, *results, path(X=41.0), machine=machine)
    targets = [c.target_mm for c in commands if isinstance(c, canon.LinearMove)]
    assert [t["C"] for t in targets if "C" in t] == [40.0, 1.0, -60.0, 40.0]
    assert targets[-1] == {"X": 41.0}


class Later(Machine):
    """The second run of X is under way for `cycles` waits; brings: what it measures."""

    def __init__(self, cycles: int, brings: float | None) -> None:
        super().__init__()
        self.measured, self._cycles, self._brings = {"X": 40.0}, cycles, brings

    def execute(self) -> None:
        if any(c.target_mm == 90.0 for c in moves(self.queue)):
            self.measuring = {"X"}
        if self.measuring:
            self._cycles -= 1
        if self._cycles < 0 and self.measuring:
            self.measuring = set()
            self.measured = {} if self._brings is None else {"X": self._brings}
        super().execute()


FIRST = single(alone("X", "G100", "G90", POS=100, FEED=500))
SECOND = single(alone("X", "G100", "G90", POS=90, FEED=500, name="INDP_ASYN"))


def read(name: str) -> Words:
    """Let C show a variable of X."""
    variable = Variable(f"V.A.{name}.X")
    return Words(g=("G1",), axes=(("C", variable),), addresses=(("F", Number(60.0)),))


def shown(commands: list[canon.Command]) -> list[float]:
    return [c.target_mm["C"] for c in commands if isinstance(c, canon.LinearMove)]


def test_from_the_start_of_a_run_its_axis_has_no_result() -> None:
    aside = Words(g=("G1",), axes=(("C", Number(7.0)),), addresses=(("F", Number(60.0)),))
    text = [FIRST, read("MERF"), aside, SECOND, read("MERF")]
    commands = decode(*text, machine=Later(99, 50.0))
    assert shown(commands) == [1.0, 7.0, 0.0]


INCLUDE = Words(g=("G101",), axes=(("X", Number(1.0)),))


@pytest.mark.parametrize("asks", [read("MESS"), read("MOFFS"), INCLUDE])
def test_what_is_not_measured_yet_is_refused(asks: Words) -> None:
    with pytest.raises(Alarm) as caught:
        decode(FIRST, SECOND, asks, machine=Later(99, 50.0))
    assert (caught.value.id, caught.value.values["axis"]) == (900101, "X")


def test_the_result_is_there_as_soon_as_the_run_has_ended() -> None:
    """Without #WAIT INDP; asking takes a cycle as long as the run is under way."""
    asks = [read("MERF"), read("MESS"), read("MOFFS")]
    commands = decode(FIRST, SECOND, *asks, machine=Later(0, 50.0))
    assert shown(commands) == [1.0, 50.0, -40.0]
    waits = [c.for_cycle for c in commands if isinstance(c, canon.Wait)]
    assert waits == [False, True, False, False]


def test_a_run_that_ended_without_a_signal_leaves_nothing_of_the_one_before() -> None:
    aside = Words(g=("G1",), axes=(("C", Number(7.0)),), addresses=(("F", Number(60.0)),))
    commands = decode(FIRST, SECOND, aside, read("MERF"), machine=Later(0, None))
    assert shown(commands) == [7.0, 0.0]
    with pytest.raises(Alarm, match="900101"):
        decode(FIRST, SECOND, aside, read("MESS"), machine=Later(0, None))


def test_g101_takes_the_run_that_has_ended_and_waits_for_none() -> None:
    commands = decode(FIRST, SECOND, INCLUDE, path(X=1.0), machine=Later(0, 50.0))
    (move,) = [c for c in commands if isinstance(c, canon.LinearMove)]
    assert move.target_mm == {"X": pytest.approx(1.0 - 40.0)}
    waits = [type(c).__name__ for c in commands[commands.index(moves(commands)[1]) + 1 :]]
    assert waits == ["Wait", "WaitIndependent", "LinearMove", "EndOfProgram"]


REFUSED = [
    (21068, alone("X", "G3", "G90", POS=1, FEED=1), {"g_function": "G3", "axis": "X"}),
    (50603, alone("X", "G90", "G0", POS=1, FEED=1), {"option": "FEED with G00"}),
    (50603, alone("X", "G90", "G1", POS=1, FEED=0), {"option": "FEED=0"}),
    (50603, alone("X", "G90", "G1", POS=1, FEED_MAX_WEIGHT=120), {"option": "FEED_MAX_WEIGHT=120"}),
    (50603, alone("X", "G90", "G1", POS=1, FEED=1, ACC_WEIGHT=-1), {"option": "ACC_WEIGHT=-1"}),
    (900103, alone("X", "G90", "G100", POS=0, FEED=1), {"axes": "X"}),
    (900194, alone("X", "G90", "G1", FEED=1), {"what": "no POS"}),
    (900194, alone("X", "G90", "G1", POS=1), {"what": "no FEED or TIME or FEED_MAX_WEIGHT"}),
    (900194, alone("X", "G90", "G1", POS=1, FEED=1, TIME=1), {"what": "FEED and TIME at a time"}),
    (900194, alone("X", "G90", "G91", "G0", POS=1), {"what": "G90 and G91 at a time"}),
]  # fmt: skip


@pytest.mark.provokes(21068, 2, axis="X")
@pytest.mark.provokes(50603, 4, axis="X")
@pytest.mark.provokes(900194, 2, axis="X")
@pytest.mark.parametrize(
    ("alarm_id", "command", "values"), [row for row in REFUSED if row[0] not in (900100, 900103)]
)
def test_what_an_independent_axis_cannot_be_told(
    alarm_id: int, command: AxisCommand, values: dict[str, str]
) -> None:
    with pytest.raises(Alarm) as caught:
        decode(single(command))
    assert caught.value.id == alarm_id
    assert values.items() <= caught.value.values.items()
    assert "N10" in str(caught.value)


@pytest.mark.parametrize(
    ("alarm_id", "command", "values"), [row for row in REFUSED if row[0] in (900100, 900103)]
)
def test_what_has_no_way_or_does_not_act(
    alarm_id: int, command: AxisCommand, values: dict[str, str]
) -> None:
    with pytest.raises(Alarm) as caught:
        decode(single(command))
    assert (caught.value.id, values.items() <= caught.value.values.items()) == (alarm_id, True)


@pytest.mark.provokes(21588, 2, axis="X", type=3)
def test_measuring_types_of_independent_axes() -> None:
    mode = measuring_type(3)
    with pytest.raises(Alarm, match="21588"):
        decode(mode, single(alone("X", "G100", "G90", POS=1, FEED=1)))
    (type_2,) = moves(decode(measuring_type(2), single(alone("X", "G100", "G90", POS=1))))
    assert (type_2.measuring_type, type_2.feed_mm_min) == (2, None)
    to_stop = single(alone("X", "G100", "G90", POS=1, FEED=1))
    (type_7,) = moves(decode(measuring_type(7), to_stop))
    assert (type_7.measuring_type, type_7.feed_mm_min) == (7, 1.0)


@pytest.mark.provokes(21071, 2, axis="X", transformation="Cartesian")
def test_an_axis_of_a_transformation_cannot_move_alone() -> None:
    on = Command("CS ON", (Group(tuple(Number(v) for v in (0, 0, 0, 0, 0, 45))),))
    with pytest.raises(Alarm, match="21071"):
        decode(on, single(alone("X", "G90", "G0", POS=1)))
    assert moves(decode(on, single(alone("C", "G90", "G0", POS=1))))


@pytest.mark.parametrize("name", ["INDP_SYN", "INDP_ASYN"])
def test_a_relative_block_counts_from_where_its_axis_has_ended_a_run(name: str) -> None:
    """The run to 50 ends at 7; another axis is not waited for, and its block counts from 3."""
    run = alone("X", "G100", "G90", POS=50, FEED=300, name=name)
    y = alone("Y", "G1", "G90", POS=3, FEED=300, name="INDP_ASYN")
    for axis, target in (("X", 8.0), ("Y", 4.0)):
        machine = Machine()
        machine.measured["X"] = 7.0
        block = replace(path(**{axis: 1.0}), g=("G91",))
        commands = decode(single(run, y), block, machine=machine)
        (moved,) = [c.target_mm for c in commands if isinstance(c, canon.LinearMove)]
        assert moved == {axis: target}
        waits = [c.axes for c in commands if isinstance(c, canon.WaitIndependent)]
        assert waits == [("X",)] * (name == "INDP_SYN" or axis == "X") + [("Y",)] * (axis == "Y")
