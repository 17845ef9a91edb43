"""PLC programs that cannot be or end in an error: refused with file, line and what is allowed."""

import gc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.machine.plc_programs import HEAD, IDLE

from axisrig.bench.campaign.processes import Died, run_apart
from axisrig.bench.machine.plc.elements import Named
from axisrig.bench.machine.plc.hli import Hli, Inputs, Variables
from axisrig.bench.machine.plc.program import PlcProgram
from axisrig.bench.machine.plc.terminal import ChannelInput
from axisrig.kernel.errors import UserError

MS = 1_000_000
RunNc = Callable[..., Any]


def test_an_exception_is_named_with_file_and_line(run_plc: RunNc) -> None:
    body = """    def cycle(self, inputs, hli):
        if inputs.time_ns > 20_000_000:
            hli.ax["Q"]
"""
    with pytest.raises(UserError) as caught:
        run_plc("N10 G4 1", body)
    assert Path(str(caught.value.file)).name == "plc.py"
    assert caught.value.line == 7
    assert "unknown axis; found 'Q'; allowed: " in str(caught.value)


@pytest.mark.parametrize(
    ("use", "words"),
    [
        ("hli.ax['Q']", "unknown axis; found 'Q'; allowed: X, Z"),
        ("inputs.channel[2]", "unknown channel of the terminal; found 2; allowed: 1"),
        ("hli.ve['FEDE']", "unknown variable V.E.; found 'FEDE'; allowed: FEED"),
        ("hli.ax['Z'].lr_mc_control.timestamp.command_w = True", "timestamp.command_w has a wrong"),
        ("hli.ax['Z'].lr_mc_control.ext_latch.done_w = 1", r"ext_latch.done_w has a wrong type"),
        ("hli.ax['X'].lr_mc_control.override.command_w = 1001", "allowed: 0 .. 1000"),
        ("hli.ch.reset.enable_w = 1", "ch.reset.enable_w has a wrong type; found 1"),
        ("hli.ch.comand_w = 1", "unknown element of hli.ch; found 'comand_w'"),
        ("hli.ve.FEED = 1", "no attribute 'FEED'"),
        ("hli.ax.Z = 1", "no attribute 'Z'"),
        ("del hli.ch.feedhold.command_w", "command_w of the HLI cannot be deleted"),
        ("del hli.ax['Z'].lr_mc_control", "lr_mc_control of the HLI cannot be deleted"),
        ("del hli.ch", "ch of the HLI cannot be deleted"),
        ("hli.ve['FEED'] = '6'", "V.E.FEED has a wrong type; found '6'; allowed: a number"),
        ("hli.ve['FEED'] = True", "V.E.FEED has a wrong type; found True; allowed: a number"),
        ("hli.ve['FEED'] = float('nan')", "V.E.FEED has a wrong type; found nan"),
        ("hli.ve['NEW'] = float('-inf')", "V.E.NEW has a wrong type; found -inf"),
        ("hli.ax['X'].lr_mc_control.ext_latch.please_rw = 0", "ext_latch.please_rw has a wrong"),
        ("hli.ch.override.command_w = -1", "allowed: 0 .. 2000"),
        ("hli.ax['X'].lr_mc_control.override.command_w = -1", "allowed: 0 .. 1000"),
    ],
)
def test_what_is_not_there_is_listed_and_a_wrong_value_has_its_line(
    tmp_path: Path, use: str, words: str
) -> None:
    path = tmp_path / "plc.py"
    path.write_text(f"class Program:\n    def cycle(self, inputs, hli):\n        {use}\n", "utf-8")
    hli = Hli(["X", "Z"])
    hli.ve = Variables({"FEED": 600.0})
    channels = Named("channel of the terminal", {1: ChannelInput()})
    with pytest.raises(UserError, match=words) as caught:
        PlcProgram(path).cycle(Inputs(0, 0, channels), hli)
    assert (caught.value.file, caught.value.line) == (str(path), 3)


@pytest.mark.parametrize(
    ("use", "words"),
    [
        ("hli.ch.feedhold = True", "ch.feedhold has been replaced.*set ch.feedhold.command_w"),
        ("hli.ve.update(FEED='x')", "V.E.FEED has a wrong type"),
        ("hli.ch = None", "ch has been replaced.*set ch.feedhold.command_w"),
        ("hli.ch = type(hli.ch)()", "ch has been replaced.*set ch.feedhold.command_w"),
        ("hli.check = None", "asks for an unknown element of hli; found 'check'"),
        ("hli.ch.reset = hli.ch.override", "ch.reset has been replaced.*set ch.reset.command_w"),
        ("hli.ch.start = None", "ch.start has been replaced.*set ch.start.command_w"),
        ("hli.ax['Z'].lr_state = type(hli.ch)()", r"ax\[Z\].lr_state has been replaced"),
        ("hli.ve = 5", "ve has been replaced"),
        ("hli.ve = {}", r"ve has been replaced.*set ve\[name\]"),
        ("hli.ve = dict(hli.ve)", "ve has been replaced"),
        ("hli.ve.update(A=float('inf'))", "V.E.A has a wrong type"),
        ("hli.ve.update(A=False)", "V.E.A has a wrong type"),
        ("hli.ax = {}", "ax has been replaced"),
        ("hli.ax.clear()", "ax has been replaced"),
        ("hli.ax['Y'] = hli.ax['Z']", "ax has been replaced"),
        ("hli.ax['X'] = hli.ax['Z']", "ax has been replaced"),
        ("hli.ax = dict(hli.ax)", "ax has been replaced"),
        ("del hli.ax['X']", "ax has been replaced"),
        ("hli.ax['X'].lr_mc_control.override = 5", r"ax\[X\].*override has been replaced"),
        ("hli.ax['Z'].lr_mc_control.ext_latch = None", "set ax.Z..lr_mc_control.ext_latch.done_w"),
        ("hli.ax['Z'].lr_mc_control = None", r"ax\[Z\].lr_mc_control has been replaced"),
        ("hli.ax['Z'].lr_state = 1", r"ax\[Z\].lr_state has been replaced"),
    ],
)
def test_what_is_replaced_is_found_after_the_cycle(tmp_path: Path, use: str, words: str) -> None:
    path = tmp_path / "plc.py"
    path.write_text(f"class Program:\n    def cycle(self, inputs, hli):\n        {use}\n", "utf-8")
    with pytest.raises(UserError, match=words) as caught:
        PlcProgram(path).cycle(Inputs(0, 0, {}), Hli(["X", "Z"]))
    assert caught.value.file == str(path)


@pytest.mark.parametrize(
    ("head", "body", "kind"),
    [
        ("def", "return True", "bool"),
        # What counts as false is something too
        ("def", "return False", "bool"),
        ("def", "return 0", "int"),
        ("def", "return 0.0", "float"),
        ("def", "return ''", "str"),
        ("def", "return []", "list"),
        ("def", "yield", "generator"),
        ("async def", "pass", "coroutine"),
    ],
)
def test_a_cycle_that_gives_something_back_is_refused(
    tmp_path: Path, head: str, body: str, kind: str
) -> None:
    """With yield or async nothing of it would be carried out, and nobody would see that."""
    path = tmp_path / "plc.py"
    text = f"class Program:\n    {head} cycle(self, inputs, hli):\n        {body}\n"
    path.write_text(text, "utf-8")
    with pytest.raises(UserError, match="gives something back") as caught:
        PlcProgram(path).cycle(Inputs(0, 0, {}), Hli(["Z"]))
    assert (caught.value.file, caught.value.line, caught.value.value) == (str(path), 2, kind)


@pytest.mark.long
@pytest.mark.parametrize("body", ["pass", "return 1", "raise ValueError"])
def test_a_cycle_with_async_is_closed_without_a_warning_of_python(
    tmp_path: Path, recwarn: pytest.WarningsRecorder, body: str
) -> None:
    path = tmp_path / "plc.py"
    path.write_text(
        f"class Program:\n    async def cycle(self, inputs, hli):\n        {body}\n", "utf-8"
    )
    with pytest.raises(UserError, match="gives something back"):
        PlcProgram(path).cycle(Inputs(0, 0, {}), Hli(["Z"]))
    gc.collect()
    assert [str(each.message) for each in recwarn] == []


def test_an_error_is_at_the_innermost_line_of_the_program(tmp_path: Path) -> None:
    """In a function that the cycle calls, also where a library is called from there."""
    path = tmp_path / "plc.py"
    path.write_text(
        "import json\n\n\ndef read(text):\n    return json.loads(text)\n\n\n"
        "class Program:\n    def cycle(self, inputs, hli):\n        read('{')\n", "utf-8"
    )  # fmt: skip
    with pytest.raises(UserError, match="JSONDecodeError") as caught:
        PlcProgram(path).cycle(Inputs(0, 0, {}), Hli(["Z"]))
    assert (caught.value.file, caught.value.line) == (str(path), 5)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("import math\n\nclass Program\n    pass\n", 3),
        ("class Program:\n    def cycle(self, inputs, hli):\n    pass\n", 3),
        ("class Program:\n    def cycle(self, inputs, hli):\n        x = (1,\n", 3),
    ],
)
def test_a_file_that_is_no_python_is_named_with_its_line(
    tmp_path: Path, text: str, line: int
) -> None:
    path = tmp_path / "plc.py"
    path.write_text(text, "utf-8")
    with pytest.raises(UserError, match="the PLC program has failed: ") as caught:
        PlcProgram(path)
    assert (caught.value.file, caught.value.line) == (str(path), line)


def test_a_text_that_the_program_reads_has_the_line_that_reads_it(tmp_path: Path) -> None:
    """Not the line of its mistake in that text."""
    path = tmp_path / "plc.py"
    body = "        ast.literal_eval('1 +')\n"
    path.write_text(f"import ast\n\n{HEAD}    def cycle(self, inputs, hli):\n{body}", "utf-8")
    with pytest.raises(UserError, match="SyntaxError") as caught:
        PlcProgram(path).cycle(Inputs(0, 0, {}), Hli(["Z"]))
    line = path.read_text("utf-8").splitlines().index(body.rstrip("\n")) + 1
    assert (caught.value.file, caught.value.line) == (str(path), line)


@pytest.mark.parametrize(
    ("channels", "allowed"), [({}, "none"), ({2: ChannelInput(), 7: ChannelInput()}, "2, 7")]
)
def test_a_channel_that_is_not_there_has_those_that_are(
    tmp_path: Path, channels: dict[int, ChannelInput], allowed: str
) -> None:
    path = tmp_path / "plc.py"
    path.write_text(
        f"{HEAD}    def cycle(self, inputs, hli):\n        inputs.channel[1]\n", "utf-8"
    )
    given = Named("channel of the terminal", channels)
    with pytest.raises(UserError) as caught:
        PlcProgram(path).cycle(Inputs(0, 0, given), Hli(["Z"]))
    assert caught.value.message == "the PLC program asks for an unknown channel of the terminal"
    assert (caught.value.value, caught.value.allowed) == (1, allowed)


def test_every_number_in_its_range_is_taken() -> None:
    """The limits themselves: 0 and 100 % of an axis, 200 % of the path, 64 bits of a stamp."""
    hli = Hli(["X"])
    control = hli.ax["X"].lr_mc_control
    for unit, values in (
        (control.override, (0, 1000)), (hli.ch.override, (0, 2000)),
        (control.timestamp, (-(2**63), 2**63 - 1)), (control.probing_position, (-(2**63), 0)),
    ):  # fmt: skip
        for value in values:
            unit.command_w = value
            assert unit.command_w == value
    hli.ve["A"], hli.ve["B"] = 3, -1e308
    hli.check()


@pytest.mark.parametrize("end", ["pass", "return", "return None"])
def test_a_cycle_that_gives_nothing_back_is_carried_out(tmp_path: Path, end: str) -> None:
    path = tmp_path / "plc.py"
    body = f"        hli.ve['A'] = inputs.cycle\n        {end}\n"
    path.write_text(f"class Program:\n    def cycle(self, inputs, hli):\n{body}", "utf-8")
    program, hli = PlcProgram(path), Hli(["Z"])
    for cycle in (3, 4):
        program.cycle(Inputs(cycle * MS, cycle, {}), hli)
        assert (hli.ve, program.time_ns) == ({"A": cycle}, cycle * MS)


@pytest.mark.parametrize("value", ["True", "False", "1", "0", "property(lambda self: self.is_on)"])
@pytest.mark.parametrize("name", ["probe_on", "is_idle", "outlives_program"])
def test_each_attribute_of_a_program_is_asked_by_itself(
    tmp_path: Path, name: str, value: str
) -> None:
    """Without them the probe is on, the program idle, and the run ends with the NC program."""
    path = tmp_path / "plc.py"
    path.write_text(f"{HEAD}    is_on = True\n    {name} = {value}\n{IDLE}", "utf-8")
    program = PlcProgram(path)
    expected = {"probe_on": True, "is_idle": True, "outlives_program": False}
    expected[name] = value not in ("False", "0")
    found = {each: getattr(program, each) for each in expected}
    assert found == expected
    assert {type(each) for each in found.values()} == {bool}


def test_an_attribute_may_change_from_cycle_to_cycle(tmp_path: Path) -> None:
    path = tmp_path / "plc.py"
    body = "        self.probe_on = inputs.cycle == 1\n        self.is_idle = inputs.cycle == 2\n"
    path.write_text(f"{HEAD}    def cycle(self, inputs, hli):\n{body}", "utf-8")
    program, hli, found = PlcProgram(path), Hli(["Z"]), []
    for cycle in range(4):
        program.cycle(Inputs(0, cycle, {}), hli)
        found.append((program.probe_on, program.is_idle))
    assert found == [(False, False), (True, False), (False, True), (False, False)]


def test_an_attribute_that_fails_is_named_with_its_line(tmp_path: Path) -> None:
    for name in ("probe_on", "is_idle", "outlives_program"):
        path = tmp_path / f"{name}.py"
        text = f"{HEAD}    @property\n    def {name}(self):\n        return 1 / 0\n\n{IDLE}"
        path.write_text(text, "utf-8")
        with pytest.raises(UserError, match="ZeroDivisionError") as caught:
            getattr(PlcProgram(path), name)
        assert (caught.value.file, caught.value.line) == (str(path), HEAD.count("\n") + 3)


def test_a_file_may_have_other_classes_and_may_import_some(tmp_path: Path) -> None:
    """The class with a cycle of its own counts; two of them are one too many."""
    path = tmp_path / "plc.py"
    (tmp_path / "two.py").write_text(f"class A:\n{IDLE}class B:\n{IDLE}", "utf-8")
    path.write_text(
        "from axisrig.bench.machine.plc.program import PlcProgram\n"
        f"class Other:\n    cycle = 3\n\n{HEAD}{IDLE}", "utf-8"
    )  # fmt: skip
    PlcProgram(path).cycle(Inputs(0, 0, {}), Hli(["Z"]))
    with pytest.raises(UserError, match="one class with a method cycle; found 'A, B'") as caught:
        PlcProgram(tmp_path / "two.py")
    assert caught.value.file == str(tmp_path / "two.py")


def test_a_program_knows_its_file_and_may_have_records(tmp_path: Path) -> None:
    """Their types may be texts; what lies beside the program is found by its file."""
    path = tmp_path / "with_records.py"
    (tmp_path / "beside.txt").write_text("7", "utf-8")
    path.write_text(
        "from __future__ import annotations\nfrom dataclasses import dataclass\n"
        "from pathlib import Path\n\n\n@dataclass\nclass Record:\n    value: int = 3\n\n\n"
        "class Program:\n    def cycle(self, inputs, hli):\n"
        "        text = (Path(__file__).parent / 'beside.txt').read_text('utf-8')\n"
        "        hli.ve['A'] = Record().value + int(text)\n", "utf-8"
    )  # fmt: skip
    hli = Hli(["Z"])
    PlcProgram(path).cycle(Inputs(0, 0, {}), hli)
    assert hli.ve == {"A": 10}


def test_of_two_ways_to_make_a_class_the_last_one_counts(tmp_path: Path) -> None:
    path = tmp_path / "plc.py"
    ways = "    def __init__(self): pass\n    def __init__(self, axis): pass\n"
    path.write_text(f"class Program:\n{ways}{IDLE}", "utf-8")
    with pytest.raises(UserError, match=r"made without arguments: .*'axis'") as caught:
        PlcProgram(path)
    assert (caught.value.line, caught.value.value) == (3, "Program")


def test_nothing_of_a_run_is_left_for_the_next(tmp_path: Path) -> None:
    """What a program keeps in its class or its module is new in each run; so is an edited file."""
    path, values = tmp_path / "plc.py", []
    text = (
        "count = []\n\n\nclass Program:\n    seen = []\n    def cycle(self, inputs, hli):\n"
        "        count.append(1)\n        self.seen.append(1)\n"
        "        hli.ve['A'] = STEP * (len(count) + len(self.seen))\n"
    )
    for step in ("1", "1", "10"):
        path.write_text(text.replace("STEP", step), "utf-8")
        program, hli = PlcProgram(path), Hli(["Z"])
        for cycle in range(2):
            program.cycle(Inputs(0, cycle, {}), hli)
        values.append(hli.ve["A"])
    assert values == [4, 4, 40]


def test_a_program_may_look_whether_something_is_there(tmp_path: Path) -> None:
    path = tmp_path / "plc.py"
    looks = "assert 'Q' not in hli.ax and hli.ve.get('A') is None\n"
    looks += "        try:\n            hli.ax['Q']\n"
    looks += "        except KeyError:\n            hli.ve['A'] = 1\n"
    path.write_text(f"class Program:\n    def cycle(self, inputs, hli):\n        {looks}", "utf-8")
    hli = Hli(["Z"])
    PlcProgram(path).cycle(Inputs(0, 0, {}), hli)
    assert hli.ve == {"A": 1}


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("    def circle(self):\n        pass\n", "one class with a method cycle"),
        ("    def cycle(self, inputs, hli)\n", "SyntaxError"),
        ("    def __init__(self):\n        1 / 0\n" + IDLE, "ZeroDivisionError"),
        (
            "    def __init__(self, axis):\n        pass\n" + IDLE,
            "missing a required argument: 'axis'",
        ),
        ("    def cycle(self, inputs, hli):\n        raise SystemExit(3)\n", "SystemExit: 3"),
        (
            '    def cycle(self, inputs, hli):\n        hli.ch.feedhold.command_w = "on"\n',
            "ch.feedhold.command_w has a wrong type; found 'on'; allowed: True or False",
        ),
        (
            "    def cycle(self, inputs, hli):\n"
            '        hli.ax["Z"].lr_mc_control.timestamp.command_w = 2**63\n',
            "timestamp.command_w is out of its range",
        ),
        (
            "    def cycle(self, inputs, hli):\n        hli.ch.override.command_w = 2001\n",
            "ch.override.command_w is out of its range; found 2001; allowed: 0 .. 2000",
        ),
        (
            "    def cycle(self, inputs, hli):\n        hli.ch.feedhold.comand_w = True\n",
            "unknown element of ch.feedhold; found 'comand_w'; did you mean: command_w",
        ),
        (
            "    def cycle(self, inputs, hli):\n        hli.ve['A'] = 'x'\n",
            "V.E.A has a wrong type",
        ),
    ],
)
def test_a_program_that_cannot_be_is_refused(run_plc: RunNc, body: str, words: str) -> None:
    with pytest.raises(UserError) as caught:
        run_plc("N10 G4 0.1", body)
    assert words in str(caught.value)
    assert "plc.py" in str(caught.value)


def test_a_class_with_parameters_is_named_by_the_line_of_its_init(tmp_path: Path) -> None:
    path = tmp_path / "plc.py"
    path.write_text(HEAD + "    name = 1\n\n    def __init__(self, axis):\n        pass\n\n" + IDLE)
    with pytest.raises(UserError) as caught:
        PlcProgram(path)
    assert caught.value.line == HEAD.count("\n") + 3


def _cycle_of(path: Path) -> None:
    PlcProgram(path).cycle(Inputs(5_300_000, 0, {}), Hli(["Z"]))


@pytest.mark.long
@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("while True:\n            pass", "a call did not come back within 1 s: it was in cycle"),
        ("import os\n        os._exit(3)", "ended the process in cycle"),
    ],
)
def test_a_cycle_that_never_ends_is_ended_by_the_limit_of_a_call(
    tmp_path: Path, body: str, reason: str
) -> None:
    path = tmp_path / "plc.py"
    path.write_text(f"{HEAD}    def cycle(self, inputs, hli):\n        {body}\n")
    (died,) = run_apart(_cycle_of, [(path,)], call_limit_s=1.0)
    assert isinstance(died, Died)
    assert reason in died.reason
    assert "at t = 5.300000 ms" in died.reason
    assert f"the PLC program {path}" in died.reason.replace("(", "").replace(")", "")


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("period_us = 10", "greater than or equal to 50"),
        ("period_us = 2000\nperiode = 1", "unknown rig key plc.periode"),
        ("period_us = 2000\n[plc.terminal]\ninput_1 = 'prob'", "plc.terminal.input_1 must name"),
        ("period_us = 2000\nswitches = 'probe'", "must name a probe that can be switched on"),
        ("offset_us = 1", "lacks the key plc.period_us"),
        (
            "period_us = 2000\n[plc.terminal]\nsegment = 'can9'\nnode = 20",
            "needs a simulated segment of this rig",
        ),
        (
            "period_us = 2000\n[plc.terminal]\nsegment = 'can1'\nnode = 3",
            "the terminal has the node id of axis Z on segment can1",
        ),
        (
            "period_us = 2000\n[plc.terminal]\nsegment = 'can1'\nnode = 20\noffset_us = 5",
            "a node on a CAN bus has none",
        ),
    ],
)
def test_a_table_that_cannot_be_is_refused_with_its_line(
    run_plc: RunNc, keys: str, words: str
) -> None:
    with pytest.raises(UserError) as caught:
        run_plc("N10 G4 0.1", IDLE, keys=keys)
    assert words in str(caught.value)
    assert caught.value.line is not None


def test_a_program_that_is_missing_is_named(run_nc: RunNc) -> None:
    with pytest.raises(UserError, match=r"rig1\.toml:4: the PLC program is no file"):
        run_nc(
            "N10 G4 0.1",
            '[plc]\nperiod_us = 2000\nprogram = "nowhere.py"\n',
            base="probe-z.toml",
        )
