"""Couplings, exchange, homing and position synchronisation: what the channel is told."""

from typing import Any

import pytest
from axis_statements import Machine, alone, decode, kinds, path, single

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.canon import AxisPair
from axisrig.kernel.nc.syntax import Command, Group, Name, Number, Option, Variable, Words


def link(group: float, *pairs: Any, name: str = "SET AX LINK") -> Command:
    """`link(1, "X2=X", ("C=Y", 15, 20))` is #SET AX LINK[1, X2=X, [C=Y,G,15,20]]."""
    arguments: list[Any] = [Number(group)]
    options: list[tuple[str, Option]] = []
    for pair in pairs:
        text, *limits = (pair,) if isinstance(pair, str) else pair
        slave, _, master = text.partition("=")
        option: tuple[str, Option] = (slave, Name(master))
        if isinstance(pair, str):
            options.append(option)
        else:
            numbers = tuple(Number(limit) for limit in limits)
            arguments.append(Group((Name("G"), *numbers), (option,)))
    return Command(name, (Group(tuple(arguments), tuple(options)),))


def enable(group: float | None = None, name: str = "ENABLE AX LINK") -> Command:
    return Command(name, () if group is None else (Number(group),))


def disable(group: float | None = None) -> Command:
    return enable(group, "DISABLE AX LINK")


def exchange(name: str, *brackets: tuple[Any, ...]) -> Command:
    groups = [
        Group(tuple(Name(v) if isinstance(v, str) else Number(v) for v in values))
        for values in brackets
    ]
    return Command(name, tuple(groups))


def put(*axes: str) -> Command:
    return Command("PUT AX", tuple(Name(axis) for axis in axes))


def refused(*statements: Any, machine: Machine | None = None) -> Alarm:
    with pytest.raises(Alarm) as caught:
        decode(*statements, machine=machine)
    return caught.value


# ---- couplings


def test_the_gantry_of_the_manual() -> None:
    """FCT-C4 section 7.3.1, N010 to N030."""
    at_once = Words(g=("G0",), axes=(("X", Number(100.0)), ("X2", Number(0.0))))
    commands = decode(at_once, link(1, ("X2=X", 15, 20)), enable(1))
    assert commands[1:-1] == [
        canon.AxisLinkOn(commands[1].block, 1, (AxisPair("X2", "X", (15.0, 20.0)),))
    ]


@pytest.mark.parametrize("name", ["SET AX LINK", "AX LINK"])
def test_pairs_without_gantry_and_a_gantry_without_limits(name: str) -> None:
    commands = decode(link(2, "C=Y", ("X2=X",), name=name), enable(2, "AX LINK ON"))
    (on,) = (c for c in commands if isinstance(c, canon.AxisLinkOn))
    assert (on.group, on.pairs) == (2, (AxisPair("C", "Y"), AxisPair("X2", "X")))


def test_off_takes_the_group_that_was_switched_on_last_or_the_named_one_or_all() -> None:
    def off(*commands: Command) -> list[int]:
        begin = [link(1, "C=Y"), link(2, "X2=X"), enable(1), enable(2)]
        done = decode(*begin, *commands)
        return [c.group for c in done if isinstance(c, canon.AxisLinkOff)]

    assert off(disable()) == [2]
    assert off(disable(), disable()) == [2, 1]
    assert off(disable(1)) == [1]
    assert off(enable(1, "AX LINK OFF")) == [1]
    assert off(Command("AX LINK OFF", options=(("ALL", None),))) == [2, 1]
    assert off(Command("AX LINK OFF", (Name("ALL"),))) == [2, 1]


def test_behind_a_coupling_the_slave_is_known_to_stand_where_it_was_led() -> None:
    class Led(Machine):
        def execute(self) -> None:
            super().execute()
            self.acs_mm["X2"] = self.acs_mm["X"]

    program = [link(1, "X2=X"), enable(1), path(X=5.0), disable(1), path(X2=5.0), path(X2=6.0)]
    moved = [c for c in decode(*program, machine=Led()) if isinstance(c, canon.LinearMove)]
    assert [c.target_mm for c in moved] == [{"X": 5.0}, {"X2": 6.0}]


@pytest.mark.parametrize(
    "ends", [[disable(1), disable(2)], [Command("AX LINK OFF", options=(("ALL", None),))]]
)
def test_behind_all_couplings_every_slave_is_known_to_stand_where_it_was_led(
    ends: list[Command],
) -> None:
    class Led(Machine):
        def execute(self) -> None:
            super().execute()
            self.acs_mm |= {"X2": self.acs_mm["X"] + 1.0, "C": self.acs_mm["Y"] + 2.0}

    program = [link(1, "X2=X"), link(2, "C=Y"), enable(1), enable(2), path(X=5.0, Y=6.0), *ends]
    for axis, at_mm in (("X2", 6.0), ("C", 8.0)):
        moves = [path(**{axis: at_mm}), path(**{axis: at_mm + 1.0})]
        moved = [
            c for c in decode(*program, *moves, machine=Led()) if isinstance(c, canon.LinearMove)
        ]
        assert [c.target_mm for c in moved] == [{"X": 5.0, "Y": 6.0}, {axis: at_mm + 1.0}]


def test_a_variable_of_a_slave_tells_where_it_was_led() -> None:
    read = Words(axes=(("C", Variable("V.A.ABS.X2")),), addresses=(("F", Number(60.0)),))
    start = path(X=100.0, X2=7.0)
    moved = decode(start, link(1, "X2=X"), enable(1), path(X=105.0), read)
    assert [c.target_mm for c in moved if isinstance(c, canon.LinearMove)][-1] == {"C": 12.0}


def test_switching_on_twice_is_once() -> None:
    assert kinds(decode(link(1, "X2=X"), enable(1), enable(1))) == ["AxisLinkOn", "EndOfProgram"]


COUPLINGS = [
    (20137, [link(1, "X2=X"), enable(1), Words(g=("G74",), axes=(("Z", Number(1.0)),))]),
    (20467, [link(1, "Y=X"), enable(1)]),
    (20472, [link(1, "X2=X"), enable(1), link(1, "X2=Y")]),
    (20475, [link(1, "X=X")]),
    (20476, [link(1, "C=X", "C=Y", "X2=Y")]),
    (20477, [link(1, "X2=X", "C=X2")]),
    (20545, [link(1, "X2=X"), enable(1), put("X")]),
    (21283, [link(1, "X2=X"), link(2, "X2=Y"), enable(1), enable(2)]),
    (21284, [link(1, "C=X2"), link(2, "X2=Y"), enable(1), enable(2)]),
    (21285, [link(1, "X2=X"), link(2, "C=X2"), enable(1), enable(2)]),
    (21481, [link(1, "X2=X"), enable(1), single(alone("X", "G90", "G0", POS=1))]),
    (900196, [link(1, "X2=X"), enable(1), path(X2=1.0)]),
    (900196, [link(1, "X2=X"), enable(1), single(alone("X2", "G90", "G0", POS=1))]),
    (900197, [enable(3)]),
    (900197, [enable()]),
    (900197, [link(0, "X2=X")]),
    (900197, [link(1.5, "X2=X")]),
    (900197, [link(1)]),
    (900197, [disable(1)]),
    (900198, [link(1, "X2=W")]),
    (900198, [link(1, ("X2=X", 15))]),
    (900198, [link(1, ("X2=X", 20, 15))]),
    (900198, [link(1, ("X2=X", 0, 15))]),
]


@pytest.mark.provokes(20137, 2, g_function="G74", group=1)
@pytest.mark.provokes(20467, 2, axis="Y")
@pytest.mark.provokes(20472, 2, group=1)
@pytest.mark.provokes(20475, 2, axis="X", pair=0, group=1)
@pytest.mark.provokes(20476, 2, axis="C")
@pytest.mark.provokes(20477, 2, axis="X2")
@pytest.mark.provokes(20545, 2, axis="X", group=1)
@pytest.mark.provokes(21283, 2, axis="X2", group=1)
@pytest.mark.provokes(21284, 2, axis="X2", group=1)
@pytest.mark.provokes(21285, 2, axis="X2", group=1)
@pytest.mark.provokes(21481, 2, axis="X", group=1)
@pytest.mark.provokes(900196, 2, axis="X2", master="X", group=1)
@pytest.mark.provokes(900197, 2)
@pytest.mark.provokes(900198, 2)
@pytest.mark.parametrize(("alarm_id", "statements"), COUPLINGS)
def test_what_is_no_coupling(alarm_id: int, statements: list[Any]) -> None:
    alarm = refused(*statements)
    assert alarm.id == alarm_id
    assert f"N{10 * len(statements)}" in str(alarm)


# ---- exchange


def test_an_axis_that_was_given_away_comes_back_where_it_stands() -> None:
    """TF5200 programming manual 206995083: giving B away, which is not there, is no error."""
    machine = Machine()
    commands = decode(
        path(X=5.0),
        put("X", "B"),
        path(Y=1.0),
        exchange("CALL AX", ("X", 1, 0)),
        path(X=5.0),
        path(X=6.0),
        machine=machine,
    )
    assert [c for c in commands if isinstance(c, canon.AxisExchange)] == [
        canon.AxisExchange(commands[1].block, ("X",), ()),
        canon.AxisExchange(commands[3].block, (), ("X",)),
    ]
    moved = [c.target_mm for c in commands if isinstance(c, canon.LinearMove)]
    assert moved == [{"X": 5.0}, {"Y": 1.0}, {"X": 6.0}]


def test_all_axes_go_and_some_come_back_in_one_bracket_each() -> None:
    back = exchange("CALL AX", ("X", 1, 0), ("X2", 5, 4))
    commands = decode(Command("PUT AX", options=(("ALL", None),)), back, path(X=1.0, X2=1.0))
    given, called = (c for c in commands if isinstance(c, canon.AxisExchange))
    assert given.given == ("X", "Y", "Z", "C", "X2")
    assert called.called == ("X", "X2")


def test_an_axis_of_the_channel_is_not_called_again() -> None:
    assert kinds(decode(exchange("CALL AX", ("X", 1, 0)))) == ["EndOfProgram"]


def test_an_axis_under_way_is_waited_for_before_it_goes() -> None:
    x = alone("X", "G90", "G0", POS=5, name="INDP_ASYN")
    assert kinds(decode(single(x), put("X"))) == [
        "IndependentMove", "WaitIndependent", "AxisExchange", "EndOfProgram"
    ]  # fmt: skip


EXCHANGES = [
    (20312, [put("X"), exchange("CALL AX", ("X", 77, 0))]),
    (21256, [put("X"), exchange("CALL AX", ("X", 1, 0), ("X", 2, 1))]),
    (21256, [put("X"), exchange("CALL AX", ("x", 1, 0), ("Y", 2, 1), ("X", 3, 2))]),
    (21257, [put("X"), exchange("CALL AX", ("X", 1, 0), ("Y", 2, 0))]),
    (21258, [put("X"), exchange("CALL AX", ("X", 1, 0), ("Y", 1, 1))]),
    (21260, [put("X"), exchange("CALL AX", ("X", 1, 2))]),
    (21261, [put("X"), exchange("CALL AX", ("Y", 1, 0))]),
    (900195, [put("X"), path(X=1.0)]),
    (900195, [put("X"), single(alone("X", "G90", "G0", POS=1))]),
    (900195, [put("X2"), link(1, "X2=X"), enable(1)]),
    (900199, [put("X"), exchange("CALL AX", ("U", 1, 0))]),
    (900199, [put("X", "Y"), exchange("CALL AX", ("X", 1, 1))]),
]


@pytest.mark.provokes(20312, 2, number=77)
@pytest.mark.provokes(21256, 2, axis="X")
@pytest.mark.provokes(21257, 2, index=0)
@pytest.mark.provokes(21258, 2, number=1)
@pytest.mark.provokes(21260, 2, index=2)
@pytest.mark.provokes(21261, 2, axis="Y")
@pytest.mark.provokes(900195, 2)
@pytest.mark.provokes(900199, 2, axis="X")
@pytest.mark.parametrize(("alarm_id", "statements"), EXCHANGES)
def test_what_is_no_exchange(alarm_id: int, statements: list[Any]) -> None:
    assert refused(*statements).id == alarm_id


# ---- homing and positions


def home(**order: float) -> Words:
    return Words(g=("G74",), axes=tuple((a, Number(v)) for a, v in order.items()))


def test_the_numbers_of_g74_are_an_order() -> None:
    """TF5200 programming manual 206138635, both examples."""
    for words, groups in (
        (home(X=2, Y=3, Z=1), (("Z",), ("X",), ("Y",))),
        (home(X=1, Y=1, Z=1), (("X", "Y", "Z"),)),
        (home(X=1, Y=2, Z=2), (("X",), ("Y", "Z"))),
        (home(X=10, Y=9, Z=65535), (("Y",), ("X",), ("Z",))),
    ):
        commands = decode(words)
        assert commands[0] == canon.Homing(commands[0].block, groups)
        assert kinds(commands) == ["Homing", "Wait", "EndOfProgram"]


def test_behind_homing_the_channel_stands_where_the_axes_do() -> None:
    for order in ({"Z": 1, "X": 2}, {"X": 1, "Z": 2}, {"X": 1, "Z": 1}):
        machine = Machine()
        machine.homes = {"Z": 100.0, "X": 50.0}
        blocks = home(**order), path(X=50.0, Z=100.0, Y=1.0), path(X=51.0, Z=101.0)
        commands = decode(*blocks, machine=machine)
        moved = [c.target_mm for c in commands if isinstance(c, canon.LinearMove)]
        assert moved == [{"Y": 1.0}, {"X": 51.0, "Z": 101.0}], order


@pytest.mark.provokes(20816, 2, axis="X", low=1, high=65535)
@pytest.mark.parametrize("place", [0.0, 1.5, -1.0, 70000.0])
def test_20816_for_a_number_that_is_no_place(place: float) -> None:
    assert refused(home(X=place)).id == 20816


def test_channel_init_takes_over_what_is_asked_for() -> None:
    def init(*options: tuple[str, Option]) -> Command:
        return Command("CHANNEL INIT", options=options)

    assert kinds(decode(init(("CMDPOS", None)))) == ["Wait", "EndOfProgram"]
    assert kinds(decode(init())) == ["Wait", "EndOfProgram"]
    every = decode(init(("ACTPOS", None)))[0]
    assert every == canon.AdoptActual(every.block, ("X", "Y", "Z", "C", "X2"))
    some = decode(init(("ACTPOS", None), ("AX", Name("X")), ("AXNR", Number(3.0))))[0]
    assert some == canon.AdoptActual(some.block, ("X", "Z"))
    assert refused(init(("CMDPOS", None), ("AXNR", Number(9.0)))).id == 20312


def test_channel_init_waits_for_axes_under_way() -> None:
    """TF5200 channel parameters 1012527499: with ACTPOS for axes that are not named as well."""
    x = alone("X", "G90", "G0", POS=20, name="INDP_ASYN")
    of_y = (("ACTPOS", None), ("AX", Name("Y")))
    assert kinds(decode(single(x), Command("CHANNEL INIT", options=of_y))) == [
        "IndependentMove", "WaitIndependent", "AdoptActual", "Wait", "EndOfProgram"
    ]  # fmt: skip
    of_y = (("CMDPOS", None), ("AX", Name("Y")))
    assert kinds(decode(single(x), Command("CHANNEL INIT", options=of_y))) == [
        "IndependentMove", "Wait", "EndOfProgram"
    ]  # fmt: skip


@pytest.mark.parametrize("named", [(), ("X", "C", "X2"), ("C",)])
def test_channel_init_leaves_slaves_to_their_masters(named: tuple[str, ...]) -> None:
    """A slave is where its master puts it; behind its coupling it is taken over as any other."""
    options: list[tuple[str, Option]] = [("ACTPOS", None), *(("AX", Name(a)) for a in named)]
    init = Command("CHANNEL INIT", options=tuple(options))
    commands = decode(link(1, "X2=X"), link(2, "C=Y"), enable(1), enable(2), init, disable(1), init)
    adopted = [c.axes for c in commands if isinstance(c, canon.AdoptActual)]
    every = named or ("X", "Y", "Z", "C", "X2")
    assert adopted == [
        tuple(axis for axis in every if axis not in slaves) for slaves in (("C", "X2"), ("C",))
    ]
