"""How a machine puts its parts together: each axis gets what is its own, nobody is left out."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import machine as module
from axisrig.bench.machine.machine import Machine
from axisrig.kernel.channel import ChannelState
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.time.clock import MS, US

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

BLOCK = Block(1, 10, "N10")


class Made(SimpleNamespace):
    """Keeps the words of its constructor."""

    def __init__(self, *words: Any, **named: Any) -> None:
        super().__init__(words=words, **named)


# What a program prints


@pytest.mark.parametrize("is_shown", [False, True])
def test_each_message_is_kept_and_put_out_as_it_is_shown(is_shown: bool) -> None:
    shown: list[str] = []
    machine: Any = SimpleNamespace(messages=[], _put_out=shown.append if is_shown else None)
    sent = [canon.Message(BLOCK, f"a={n}", (float(n),)) for n in (1, 2, 3)]
    for message in sent:
        Machine._message(machine, message)
    assert machine.messages == sent
    assert shown == ([message.shown for message in sent] if is_shown else [])


# What acts on the drives of each part


class Functions:
    """Accesses that note what was begun with them."""

    is_waiting = is_busy = False

    def __init__(self) -> None:
        self.begun: list[str] = []

    def begin(self, command: Any) -> None:
        self.begun.append(command.axis)


def functions_of(*parts: tuple[str, Any]) -> Any:
    """Parts as axes in a row and what acts on them."""
    installed = [
        SimpleNamespace(links=dict.fromkeys(axes), functions=lambda made=made: made)
        for axes, made in parts
    ]
    machine: Any = SimpleNamespace(installed=installed)
    return Machine._build_functions(machine)


def test_a_command_goes_to_the_part_that_has_its_axis() -> None:
    first, second = Functions(), Functions()
    made = functions_of(("XZ", first), ("W", None), ("Y", second))
    for axis in "ZYXY":
        made.begin(canon.DriveWrite(BLOCK, axis, "KEY", 1.0, waits=False))
    assert (first.begun, second.begun) == (["Z", "X"], ["Y", "Y"])
    assert functions_of(("W", None), ("Y", second)) is second


def test_the_watch_is_over_all_drives_segments_and_presences(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def part(name: str, presence: Any) -> Any:
        return SimpleNamespace(presence=lambda: presence, watch=lambda axis: f"{axis} of {name}")

    parts = [part("first", None), part("second", "master 2"), part("third", "master 3")]
    monkeypatch.setattr(module, "Monitor", Made)
    machine: Any = SimpleNamespace(
        installed=parts, links={"Y": "link Y", "X": "link X"},
        _carriers={"can1": "carrier 1", "can2": "carrier 2"},
        part_of={"Y": parts[1], "X": parts[0]},
    )  # fmt: skip
    links, carriers, watches, presences = Machine._build_monitor(machine).words  # type: ignore[attr-defined]
    assert (links, carriers) == (["link Y", "link X"], ["carrier 1", "carrier 2"])
    assert (watches, presences) == (["Y of second", "X of first"], ["master 2", "master 3"])


# Between two cycles


def test_all_who_look_between_two_cycles_do_so_in_every_one() -> None:
    looked: list[str] = []
    hardware, onlooker = object(), lambda machine: looked.append(machine.name)
    for outside, looks in ((None, ["m"]), (hardware, ["outside", "m"])):
        machine: Any = SimpleNamespace(
            name="m", _hardware=outside, _onlooker=onlooker,
            _look_outside=lambda found: looked.append("outside" if found is hardware else "?"),
        )  # fmt: skip
        look = Machine._between_cycles(machine)
        assert look is not None
        looked.clear()
        look()
        look()
        assert looked == looks * 2
    nobody: Any = SimpleNamespace(_hardware=None, _onlooker=None)
    assert Machine._between_cycles(nobody) is None


def test_an_operator_stops_once_and_each_alarm_of_a_part_stops() -> None:
    stopped: list[Any] = []
    lost = [Alarm(900071, segment=name, reason="gone") for name in ("a", "b", "c")]
    looks = [[lost[:2], [lost[2]]], [[], []]]
    parts = [SimpleNamespace(look=lambda n=n: iter(looks[min(len(turns), 1)][n])) for n in (0, 1)]
    turns: list[int] = []
    machine: Any = SimpleNamespace(
        is_stopped=False, installed=parts, channel=SimpleNamespace(stop=stopped.append)
    )
    wants = iter([False, True, True, False, True])
    hardware: Any = SimpleNamespace(stop=lambda: next(wants))
    Machine._look_outside(machine, hardware)
    assert (stopped, machine.is_stopped) == (lost, False)
    turns.append(1)
    for _ in range(4):
        Machine._look_outside(machine, hardware)
        assert machine.is_stopped
    assert [alarm.id for alarm in stopped[3:]] == [900070]


def test_drives_outside_are_left_with_each_of_their_segments_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    left: list[Any] = []
    monkeypatch.setattr(module, "power_down", lambda *words: left.append(words))
    segments = {"X": "can1", "Y": "can2", "Z": "can1", "W": "can3"}
    machine: Any = SimpleNamespace(
        channel=SimpleNamespace(state=ChannelState.RUNNING), outside=frozenset("ZXY"),
        part_of={axis: f"part of {axis}" for axis in segments},
        settings=SimpleNamespace(
            rig=SimpleNamespace(
                axis={axis: SimpleNamespace(segment=name) for axis, name in segments.items()}
            )
        ),
        _carriers={"can1": 1, "can2": 2, "can3": 3}, scheduler="clock", timing="timing",
    )  # fmt: skip
    Machine._leave(machine)
    parts = {axis: f"part of {axis}" for axis in "XYZ"}
    assert left == [("clock", parts, [1, 2], "timing")]
    assert machine.channel.state is ChannelState.ENDED


# The PLC side


@pytest.mark.parametrize("columns", [{}, {"V.E.A": "0; 1 at=M50"}])
def test_a_task_switches_the_probe_of_its_table_and_knows_of_columns(
    monkeypatch: pytest.MonkeyPatch, columns: dict[str, str]
) -> None:
    """The plants go on to the instant first: before it they were as they had been switched."""
    calls: list[Any] = []
    probe = SimpleNamespace(switch=lambda *words: calls.append(("switch", *words)))
    other = SimpleNamespace(switch=lambda *words: calls.append("other"))
    table = SimpleNamespace(switches="probe")
    machine: Any = SimpleNamespace(
        settings=SimpleNamespace(rig=SimpleNamespace(plc_task=table), plc=columns),
        plant=SimpleNamespace(
            probes={"other": other, "probe": probe},
            advance_to=lambda at: calls.append(("advance", at)),
        ),
        scheduler=SimpleNamespace(now_ns=3 * MS), channel="channel", part_of="parts",
        beside=SimpleNamespace(task="trouble"), _build_terminal=lambda *_: "terminal",
        _commands_of=lambda file: f"commands of {file}",
    )  # fmt: skip
    monkeypatch.setattr(module, "PlcTaskRunner", Made)
    made: Any = Machine._build_plc_task(machine, 7)
    assert made.words == (table, "channel", machine.scheduler)
    assert (made.terminal, made.carriers, made.trouble) == ("terminal", "parts", "trouble")
    assert (made.has_columns, made.program()) == (bool(columns), "commands of None")
    for at_ns, is_on in ((4 * MS, True), (5 * MS, False), (6 * MS, True)):
        machine.scheduler.now_ns = at_ns
        made.switch(is_on)
        assert calls == [("advance", at_ns), ("switch", is_on, at_ns)]
        calls.clear()
    table.switches = None
    without: Any = Machine._build_plc_task(machine, 7)
    without.switch(True)
    assert calls == []
    machine.settings.rig.plc_task = None
    assert Machine._build_plc_task(machine, 7) is None


@pytest.mark.parametrize(
    ("writes", "plc", "task", "constant"),
    [
        (False, {}, None, True),
        (True, {}, None, False),
        (False, {"V.E.A": object()}, None, False),
        (False, {}, object(), False),
    ],
)
def test_a_program_is_interpreted_with_what_rig_and_lists_say(
    monkeypatch: pytest.MonkeyPatch, writes: bool, plc: Any, task: Any, constant: bool
) -> None:
    passed: list[Any] = []

    class Interpreted(Made):
        def pass_over(self, words: Any) -> None:
            passed.append(words)

    monkeypatch.setattr(module, "Interpreter", Interpreted)
    language = SimpleNamespace(pass_over=["#TIMER"])
    rig = SimpleNamespace(axis={"Z": 1, "X": 2}, plc=plc, plc_task=task, language=language)
    machine: Any = SimpleNamespace(
        settings=SimpleNamespace(
            rig=rig, offset_tables="tables",
            channel=SimpleNamespace(integer={"messtyp": 5}.__getitem__),
        ),
        channel=SimpleNamespace(plc=SimpleNamespace(values={"A": 1.0})),
        plc_side=SimpleNamespace(writes_variables=writes),
    )  # fmt: skip
    made: Any = Machine._build_interpreter(machine, "program")  # type: ignore[arg-type]
    assert made.words == ("program", ("Z", "X"), machine.channel)
    assert made.external is machine.channel.plc.values
    assert (made.default_measuring_type, made.tables) == (5, "tables")
    assert made.plc_is_constant is constant
    assert passed == [["#TIMER"]]


# Times and hash


@pytest.mark.parametrize(
    ("end_us", "found_us"), [(None, 7300), (0, 0), (1, 2000), (2000, 2000), (2001, 4000)]
)
def test_a_run_ends_with_the_period_in_which_its_program_ended(
    end_us: int | None, found_us: int
) -> None:
    machine: Any = SimpleNamespace(
        channel=SimpleNamespace(end_ns=None if end_us is None else end_us * US),
        timing=SimpleNamespace(period_ns=2 * MS), scheduler=SimpleNamespace(now_ns=7300 * US),
    )  # fmt: skip
    end: Any = Machine.end_ns
    assert end.fget(machine) == found_us * US
