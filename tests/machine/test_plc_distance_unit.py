"""A PLC program that reaches distance control: control unit, semaphore, the tool of the HLI."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.machine.plc.elements import Named
from axisrig.bench.machine.plc.hli import (
    HLI_DIST_CTRL_ON,
    HLI_DIST_CTRL_ON_CONST_DIST,
    Hli,
    Inputs,
    Variables,
)
from axisrig.bench.machine.plc.program import PlcProgram
from axisrig.bench.machine.plc.task_units import TaskUnits
from axisrig.bench.machine.plc.terminal import ChannelInput
from axisrig.kernel.distance import DistanceCommand, DistanceState, Source
from axisrig.kernel.errors import UserError
from axisrig.kernel.plc.unit import AxisUnit

UNIT = "hli.ax['Z'].lr_mc_control.distance_control"


@pytest.mark.parametrize(
    ("use", "words"),
    [
        (f"{UNIT}.comand_w", "element of ax[Z].lr_mc_control.distance_control; found 'comand_w'"),
        (f"{UNIT}.command_w.set_poss = 1", "did you mean: set_pos"),
        (f"{UNIT}.state_r.offset", "unknown element of state_r; found 'offset'"),
        (
            "hli.ax['Z'].lr_mc_control.distance_contrl",
            "unknown element of lr_mc_control; found 'distance_contrl'; did you mean:"
            " distance_control",
        ),
        ("hli.ax['Z'].lr_stat", "unknown element of hli.ax[..]; found 'lr_stat'; did you mean"),
        ("hli.ax['Z'].lr_state.positon_r", "did you mean: position_r"),
        ("hli.ch.overide.command_w = 1", "unknown element of hli.ch; found 'overide'"),
        ("hli.axs", "unknown element of hli; found 'axs'; did you mean: ax"),
        ("inputs.chanel[1]", "unknown element of inputs; found 'chanel'; did you mean: channel"),
        ("inputs.channel[1].imput", "did you mean: input"),
        ("hli.ax.Z", "unknown element of hli.ax; found 'Z'"),
        ("hli.ve.FEED", "unknown element of hli.ve; found 'FEED'"),
        (
            f"{UNIT}.command_w.transition = 4",
            "transition is out of its range; found 4; allowed: 0 .. 3",
        ),
        (f"{UNIT}.command_w.set_pos = 30.5", "set_pos has a wrong type; found 30.5"),
        (f"{UNIT}.command_w.set_dist = 2**31", "set_dist is out of its range"),
        (f"{UNIT}.enable_w = 1", "distance_control.enable_w has a wrong type; found 1"),
        (f"{UNIT}.command_w = 1", "distance_control.command_w has been replaced; found 1"),
        ("hli.ax['Z'].lr_mc_control.distance_control = 1", "distance_control has been replaced"),
    ],
)
def test_what_cannot_be_is_named_with_its_line_and_the_nearest(
    tmp_path: Path, use: str, words: str
) -> None:
    path = tmp_path / "plc.py"
    path.write_text(f"class Program:\n    def cycle(self, inputs, hli):\n        {use}\n", "utf-8")
    hli = Hli(["X", "Z"])
    hli.ve = Variables({"FEED": 600.0})
    inputs = Inputs(0, 0, Named("channel of the terminal", {1: ChannelInput()}))
    with pytest.raises(UserError) as caught:
        PlcProgram(path).cycle(inputs, hli)
    assert words in str(caught.value)
    assert caught.value.file == str(path)


def test_a_program_may_ask_for_an_element_and_has_errors_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "plc.py"
    body = "        assert not hasattr(hli.ch, 'what')\n        self.what\n"
    path.write_text(f"class Program:\n    def cycle(self, inputs, hli):\n{body}", "utf-8")
    with pytest.raises(
        UserError, match="AttributeError: 'Program' object has no attribute"
    ) as caught:
        PlcProgram(path).cycle(Inputs(0, 0, {}), Hli(["Z"]))
    assert caught.value.line == 4


class Wire:
    """The unit of an axis at the PLC and at the CNC; cnc takes as the kernel does."""

    def __init__(self, *, has_columns: bool = False) -> None:
        self.axis, self.notes = AxisUnit(), list[str]()
        units = {"Z": self.axis}
        self.between = TaskUnits(units, self.notes.append, has_columns=has_columns)
        self.plc = Hli(["Z"]).ax["Z"].lr_mc_control.distance_control
        self.taken: list[tuple[Any, Any, Any]] = []
        self._shown, self._writes = self.between.shown("Z"), self.between.written("Z", self.plc)

    def plc_cycle(self, act: Callable[[Any], None] = lambda _unit: None) -> "Wire":
        self.between.read("Z", self.plc, self._shown)
        act(self.plc)
        self._writes = self.between.written("Z", self.plc)
        return self

    def cnc_cycle(self) -> "Wire":
        self.between.take("Z", self._writes)
        unit = self.axis.distance
        if unit.command_semaphor_rw and unit.enable_w:
            unit.command_semaphor_rw = False
            wanted = unit.command_w
            self.taken.append((wanted.transition, wanted.set_pos_mm, wanted.set_dist_mm))
        self._shown = self.between.shown("Z")
        return self


def test_a_distance_can_be_given_anew_in_every_cycle() -> None:
    """FCT-M3 5.2. PLC and CNC in turn: each command is taken once, and the semaphore is free."""
    wire, given = Wire(), iter(range(10_000, 10_020))

    def command(unit: Any) -> None:
        assert not unit.command_semaphor_rw
        unit.enable_w = unit.command_semaphor_rw = True
        unit.command_w.transition = HLI_DIST_CTRL_ON_CONST_DIST
        unit.command_w.set_dist = next(given)

    for _ in range(20):
        wire.plc_cycle(command).cnc_cycle()
    wanted = [(DistanceCommand.ON_CONST_DIST, None, k / 1e4) for k in range(10_000, 10_020)]
    assert wire.taken == wanted
    assert wire.plc_cycle().plc.command_semaphor_rw is False


def test_a_slow_cnc_takes_the_command_that_came_with_the_semaphore() -> None:
    """Three cycles of the PLC in one of the CNC: what is changed meanwhile does not count."""
    wire = Wire()

    def first(unit: Any) -> None:
        unit.enable_w = unit.command_semaphor_rw = True
        unit.command_w.transition, unit.command_w.set_pos = HLI_DIST_CTRL_ON, 300_000

    def later(unit: Any) -> None:
        assert unit.command_semaphor_rw
        unit.command_w.set_pos = 500_000

    wire.plc_cycle(first).plc_cycle(later).plc_cycle().cnc_cycle().cnc_cycle()
    assert wire.taken == [(DistanceCommand.ON, 30.0, None)]
    assert wire.notes == ["Z.distance_control = ON"]
    assert not wire.plc_cycle().plc.command_semaphor_rw


def test_a_command_waits_for_enable() -> None:
    wire = Wire()

    def command(unit: Any) -> None:
        unit.command_w.set_pos, unit.command_semaphor_rw = 1, True

    wire.plc_cycle(command).cnc_cycle()
    assert wire.plc_cycle().plc.command_semaphor_rw is True
    wire.cnc_cycle()
    assert wire.taken == []

    def enable(unit: Any) -> None:
        unit.enable_w = True

    wire.plc_cycle(enable).cnc_cycle()
    assert wire.taken == [(None, 1e-4, None)]
    assert not wire.plc_cycle().plc.command_semaphor_rw


@pytest.mark.parametrize("has_columns", [True, False])
def test_columns_keep_what_they_have_enabled(has_columns: bool) -> None:
    wire = Wire(has_columns=has_columns)
    wire.axis.distance.enable_w = True
    wire.plc_cycle().cnc_cycle()
    assert wire.axis.distance.enable_w is has_columns


def test_the_state_is_that_of_the_kernel_in_a_tenth_of_a_micrometre() -> None:
    wire = Wire()
    state = wire.axis.distance.state_r
    wire.cnc_cycle().plc_cycle()
    assert (wire.plc.state_r.surface, wire.plc.state_r.distance) == (0, 0)
    state.state, state.source = DistanceState.FREEZE, Source.PLC
    state.surface_mm, state.distance_mm, state.actual_offset_mm = -1.5, 2.00004, 0.3
    seen = wire.cnc_cycle().plc_cycle().plc.state_r
    assert (seen.state, seen.source) == (2, 1)
    assert (seen.surface, seen.distance, seen.actual_offset) == (-15_000, 20_000, 3_000)


@pytest.mark.long
def test_a_program_sees_inclination_and_length_of_the_tool(
    tmp_path: Path, run_nc: Callable[..., Any]
) -> None:
    """FCT-M3 12.5; A -55 with HD2 = 50: L2 = 80 cos 50 / cos 55; both 0 without a kinematic."""
    (tmp_path / "plc.py").write_text(
        "class Program:\n    def cycle(self, inputs, hli):\n"
        "        hli.ve['TILT'] = hli.ch.tool_tilt_r\n"
        "        hli.ve['LENGTH'] = hli.ch.tool_length_r\n",
        "utf-8",
    )
    shown = '#TIME 0.005\n#MSG SYN["%f %f", V.E.TILT, V.E.LENGTH]\n'
    run = run_nc(
        f"{shown}V.G.WZ_AKT.L = 80\n#TRAFO ON\n{shown}#TRAFO OFF\n{shown}",
        '[plc]\nperiod_us = 1000\nprogram = "plc.py"\n',
        "plc:V.E.TILT=9",
        "plc:V.E.LENGTH=9",
        "plant:a.position_start_mm=-55",
        base="distance-5axis.toml",
    )
    seen = [list(message.values) for message in run.observed.facts.messages]
    length = 8e5 * math.cos(math.radians(50)) / math.cos(math.radians(55))
    assert seen[0] == seen[2] == [0.0, 0.0]
    assert seen[1] == pytest.approx([550_000, length], abs=1.5)


def test_a_command_gets_to_the_axis_and_its_state_back(
    tmp_path: Path, run_nc: Callable[..., Any]
) -> None:
    """The tool is 2 mm above the surface at 30 mm, SET_POS is 29.9: the offset is 0.1 mm."""
    (tmp_path / "plc.py").write_text(
        "class Program:\n"
        "    given = False\n\n"
        "    def cycle(self, inputs, hli):\n"
        f"        unit = {UNIT}\n"
        "        if not self.given and hli.ve['BEGIN']:\n"
        "            unit.enable_w = unit.command_semaphor_rw = self.given = True\n"
        "            unit.command_w.transition, unit.command_w.set_pos = 1, 299_000\n"
        "        state = unit.state_r\n"
        "        shown = (state.state, state.source, state.surface, state.distance,\n"
        "                 state.actual_offset, unit.command_semaphor_rw)\n"
        "        for number, value in enumerate(shown):\n"
        "            hli.ve[f'S{number}'] = int(value)\n",
        "utf-8",
    )
    run = run_nc(
        "G0 Z32\nV.E.BEGIN = 1\n#TIME 0.15\n"
        '#MSG SYN["%f %f %f %f %f %f", V.E.S0, V.E.S1, V.E.S2, V.E.S3, V.E.S4, V.E.S5]',
        '[plc]\nperiod_us = 2000\nprogram = "plc.py"\n',
        "plc:V.E.BEGIN=0",
        *(f"plc:V.E.S{number}=9" for number in range(6)),
        base="distance-z.toml",
    )
    (message,) = run.observed.facts.messages
    assert message.values == pytest.approx((1, 1, 300_000, 21_000, 1_000, 0), abs=2)
    notes = [note for note in run.observed.facts.plc if "distance_control" in str(note)]
    assert len(notes) == 1


def test_what_a_program_takes_back_before_it_was_handed_over_makes_room_for_the_next() -> None:
    """The semaphore goes and comes again in two cycles of the PLC before the CNC looks."""
    wire = Wire()

    def order(set_dist: int) -> Callable[[Any], None]:
        def command(unit: Any) -> None:
            unit.enable_w = unit.command_semaphor_rw = True
            unit.command_w.transition = HLI_DIST_CTRL_ON_CONST_DIST
            unit.command_w.set_dist = set_dist

        return command

    def take_back(unit: Any) -> None:
        unit.command_semaphor_rw = False

    wire.plc_cycle(order(10_000)).plc_cycle(take_back).plc_cycle(order(20_000)).cnc_cycle()
    assert wire.taken == [(DistanceCommand.ON_CONST_DIST, None, 2.0)]
    wire.plc_cycle(take_back).plc_cycle(order(30_000)).cnc_cycle()
    assert [mm for _, _, mm in wire.taken] == [2.0, 3.0]
