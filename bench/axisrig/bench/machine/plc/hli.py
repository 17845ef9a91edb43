"""What a PLC program sees: its inputs, and the HLI of the CNC with the names of the manuals.

A program is a class with `cycle(inputs, hli) -> None`, called once in each cycle of its task:

    from axisrig.bench.machine.plc.hli import Hli, Inputs

    class Program:
        def cycle(self, inputs: Inputs, hli: Hli) -> None:
            unit = hli.ax["Z"].lr_mc_control.probing_signal
            unit.enable_w = True
            unit.command_w = inputs.channel[1].input

Names that end in `_w` are written by the PLC, in `_r` by the CNC, in `_rw` by both. Sources: FCT-C4
7.1 to 7.5 and 8.2.3; HLI, control commands of an axis and of a channel.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import isfinite
from typing import Any

from axisrig.bench.machine.plc.terminal import ChannelInput
from axisrig.kernel.errors import UserError
from axisrig.kernel.motion.feed import FULL
from axisrig.kernel.plc.probing import LatchTask

HLI_EXT_LATCH_ENABLE_PROBE = int(LatchTask.ENABLE)
HLI_EXT_LATCH_DISABLE_PROBE = int(LatchTask.DISABLE)
HLI_EXT_LATCH_PREPARE_PROBE = int(LatchTask.PREPARE)
SGN64 = range(-(2**63), 2**63)
HIGHEST_PERMILLE = 2000
"""Of the override of the path; of an axis 1000 is the most."""


@dataclass(frozen=True)
class Inputs:
    """The process image of one cycle.

    time_ns: of this cycle, bus time. cycle: cycles since the start, left out ones included.
    channel: of the terminal, by number. wc_state: 0 while the terminal answers.
    """

    time_ns: int
    cycle: int
    channel: Mapping[int, ChannelInput]
    wc_state: int = 0


@dataclass(slots=True)
class BoolUnit:
    """MC_CONTROL_BOOL_UNIT: enable_w makes command_w count; request_r: the wish of the CNC itself.

    state_r: what the CNC has taken.
    """

    enable_w: bool = False
    command_w: bool = False
    request_r: bool = False
    state_r: bool = False


@dataclass(slots=True)
class Sgn64Unit:
    """MC_CONTROL_SGN64_UNIT, as `BoolUnit` with 64-bit integers."""

    enable_w: bool = False
    command_w: int = 0
    request_r: int = 0
    state_r: int = 0


@dataclass(slots=True)
class ExtLatchUnit:
    """The interface to external measuring hardware.

    please_rw: the CNC sets it with a task, the PLC takes it back when it has read the task. done_w:
    the task is carried out; the PLC takes it back when it reads the next. task_r: one of
    HLI_EXT_LATCH_*_PROBE. input_r, edge_r: 1 to 255, POS or NEG. task_number_r: `task` of the rig.
    """

    please_rw: bool = False
    done_w: bool = False
    task_r: int = 0
    input_r: int = 0
    edge_r: str = "POS"
    task_number_r: int = 1


@dataclass(slots=True)
class McControl:
    """lr_mc_control of an axis; probing_position in 0.1 um or 0.0001 deg, override in 0.1 %."""

    probing_signal: BoolUnit = field(default_factory=BoolUnit)
    timestamp: Sgn64Unit = field(default_factory=Sgn64Unit)
    probing_position: Sgn64Unit = field(default_factory=Sgn64Unit)
    ext_latch: ExtLatchUnit = field(default_factory=ExtLatchUnit)
    feedhold: BoolUnit = field(default_factory=BoolUnit)
    override: Sgn64Unit = field(default_factory=lambda: Sgn64Unit(command_w=1000))


@dataclass(slots=True)
class LrState:
    """lr_state of an axis: probe actuated, measurement run under way, its last value is valid.

    position_r: actual position, 0.1 um or 0.0001 deg. digital_inputs_r: 60FD of the drive as the
    CNC has it, bits 16 and 17 are its probe inputs.
    """

    probe_actuated_r: bool = False
    measurement_active_r: bool = False
    measure_value_ok_r: bool = False
    position_r: int = 0
    digital_inputs_r: int = 0


@dataclass(slots=True)
class AxisHli:
    """One axis."""

    lr_mc_control: McControl = field(default_factory=McControl)
    lr_state: LrState = field(default_factory=LrState)


@dataclass(slots=True)
class ChannelHli:
    """The channel; state_r: its state in words (RUNNING, READY ..).

    feedhold, override (0.1 %): of the path. reset, start: a rising edge of command_w resets the
    channel, or starts the program of the run.
    """

    state_r: str = ""
    feedhold: BoolUnit = field(default_factory=BoolUnit)
    override: Sgn64Unit = field(default_factory=lambda: Sgn64Unit(command_w=1000))
    reset: BoolUnit = field(default_factory=BoolUnit)
    start: BoolUnit = field(default_factory=BoolUnit)


class Hli:
    """The interface to the CNC; ax: by the name of the axis, ch: the channel.

    ve: V.E. variables by the name after `V.E.`, read and written.
    """

    __slots__ = ("ax", "ch", "ve")

    def __init__(self, axes: Iterable[str]) -> None:
        self.ax = {name: AxisHli() for name in axes}
        self.ch = ChannelHli()
        self.ve: dict[str, float] = {}

    def check(self) -> None:
        """Check what a program has written. Raises UserError for a value of another type."""
        for name, axis in self.ax.items():
            control = axis.lr_mc_control
            for unit in ("probing_signal", "feedhold"):
                _check_bool(f"ax[{name}].lr_mc_control.{unit}", getattr(control, unit))
            for unit in ("timestamp", "probing_position"):
                _check_integer(f"ax[{name}].lr_mc_control.{unit}", getattr(control, unit))
            override = f"ax[{name}].lr_mc_control.override"
            _check_integer(override, control.override, range(FULL + 1))
            for element in ("please_rw", "done_w"):
                value = getattr(control.ext_latch, element)
                _require(f"ax[{name}].lr_mc_control.ext_latch.{element}", value, bool)
        for unit in ("feedhold", "reset", "start"):
            _check_bool(f"ch.{unit}", getattr(self.ch, unit))
        _check_integer("ch.override", self.ch.override, range(HIGHEST_PERMILLE + 1))
        for name, value in self.ve.items():
            if type(value) not in (int, float) or not isfinite(value):
                raise UserError(f"V.E.{name} has a wrong type", value=value, allowed="a number")


def _check_bool(name: str, unit: BoolUnit) -> None:
    _require(f"{name}.enable_w", unit.enable_w, bool)
    _require(f"{name}.command_w", unit.command_w, bool)


def _check_integer(name: str, unit: Sgn64Unit, allowed: range = SGN64) -> None:
    _require(f"{name}.enable_w", unit.enable_w, bool)
    _require(f"{name}.command_w", unit.command_w, int)
    if unit.command_w not in allowed:
        raise UserError(
            f"{name}.command_w is out of its range",
            value=unit.command_w,
            allowed=f"{allowed.start} .. {allowed.stop - 1}",
        )


def _require(name: str, value: Any, kind: type) -> None:
    if type(value) is not kind:
        words = {bool: "True or False", int: "a whole number"}
        raise UserError(f"{name} has a wrong type", value=value, allowed=words[kind])
