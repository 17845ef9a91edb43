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
from typing import Any, TypeVar

from axisrig.bench.machine.plc.terminal import ChannelInput
from axisrig.kernel.errors import UserError
from axisrig.kernel.motion.feed import FULL
from axisrig.kernel.plc.probing import LatchTask

HLI_EXT_LATCH_ENABLE_PROBE = int(LatchTask.ENABLE)
HLI_EXT_LATCH_DISABLE_PROBE = int(LatchTask.DISABLE)
HLI_EXT_LATCH_PREPARE_PROBE = int(LatchTask.PREPARE)
WRITTEN = ("enable_w", "command_w")
"""Elements of a unit that the program sets."""
SGN64 = range(-(2**63), 2**63)
HIGHEST_PERMILLE = 2000
"""Of the override of the path; of an axis 1000 is the most."""


_Key = TypeVar("_Key")
_Value = TypeVar("_Value")


class UnknownNameError(KeyError):
    """A program asks for something that is not there; what: in words. known: the names there are.

    It is a KeyError, so that a program may catch it as one.
    """

    def __init__(self, what: str, name: object, known: Iterable[object]) -> None:
        super().__init__(name)
        self.what, self.name, self.known = what, name, list(known)


class Named(dict[_Key, _Value]):
    """Things by name; what: one of them in words. Raises UnknownNameError for another name."""

    __slots__ = ("_what",)

    def __init__(self, what: str, items: Mapping[_Key, _Value]) -> None:
        super().__init__(items)
        self._what = what

    def __missing__(self, key: _Key) -> _Value:
        """Say which names there are."""
        raise UnknownNameError(self._what, key, self)


class Variables(Named[str, float]):
    """V.E. variables. Raises UserError for a value that is no number where it is set."""

    __slots__ = ()

    def __init__(self, values: Mapping[str, float]) -> None:
        super().__init__("variable V.E.", values)

    def __setitem__(self, name: str, value: float) -> None:
        """Set one."""
        _require_number(name, value)
        super().__setitem__(name, value)


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

    state_r: what the CNC has taken. label: its name in messages.
    """

    label: str = ""
    enable_w: bool = False
    command_w: bool = False
    request_r: bool = False
    state_r: bool = False

    def __setattr__(self, element: str, value: Any) -> None:
        """Set an element. Raises UserError for one that a program sets to another type."""
        if element in WRITTEN:
            _require(f"{self.label}.{element}", value, bool)
        object.__setattr__(self, element, value)


@dataclass(slots=True)
class Sgn64Unit:
    """MC_CONTROL_SGN64_UNIT, as `BoolUnit` with 64-bit integers; allowed: those of command_w."""

    label: str = ""
    allowed: range = SGN64
    enable_w: bool = False
    command_w: int = 0
    request_r: int = 0
    state_r: int = 0

    def __setattr__(self, element: str, value: Any) -> None:
        """Set an element. Raises UserError for another type, and for what is out of its range."""
        if element == "enable_w":
            _require(f"{self.label}.{element}", value, bool)
        elif element == "command_w":
            _require(f"{self.label}.{element}", value, int)
            if value not in self.allowed:
                raise UserError(
                    f"{self.label}.command_w is out of its range",
                    value=value,
                    allowed=f"{self.allowed.start} .. {self.allowed.stop - 1}",
                )
        object.__setattr__(self, element, value)


@dataclass(slots=True)
class ExtLatchUnit:
    """The interface to external measuring hardware.

    please_rw: the CNC sets it with a task, the PLC takes it back when it has read the task. done_w:
    the task is carried out; the PLC takes it back when it reads the next. task_r: one of
    HLI_EXT_LATCH_*_PROBE. input_r, edge_r: 1 to 255, POS or NEG. task_number_r: `task` of the rig.
    """

    label: str = ""
    please_rw: bool = False
    done_w: bool = False
    task_r: int = 0
    input_r: int = 0
    edge_r: str = "POS"
    task_number_r: int = 1

    def __setattr__(self, element: str, value: Any) -> None:
        """Set an element. Raises UserError for one that a program sets to another type."""
        if element in ("please_rw", "done_w"):
            _require(f"{self.label}.{element}", value, bool)
        object.__setattr__(self, element, value)


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

    __slots__ = ("_axes", "_ch", "ax", "ch", "ve")

    def __init__(self, axes: Iterable[str]) -> None:
        self.ax = Named("axis", {name: AxisHli() for name in axes})
        self.ch = self._ch = ChannelHli()
        self._axes = dict(self.ax)
        self.ve: dict[str, float] = Variables({})
        for name, axis in self.ax.items():
            _label(f"ax[{name}].lr_mc_control", axis.lr_mc_control)
            axis.lr_mc_control.override.allowed = range(FULL + 1)
        _label("ch", self.ch)
        self.ch.override.allowed = range(HIGHEST_PERMILLE + 1)

    def check(self) -> None:
        """Check what a program has put in the place of something else.

        Raises UserError for an axis, a unit, or the variables, in place of which there is something
        else.
        """
        if not isinstance(self.ax, Named) or len(self.ax) != len(self._axes):
            raise _replaced("ax", self.ax, "ax[name].lr_mc_control")
        if any(self.ax.get(name) is not axis for name, axis in self._axes.items()):
            raise _replaced("ax", self.ax, "ax[name].lr_mc_control")
        if self.ch is not self._ch:
            raise _replaced("ch", self.ch, "ch.feedhold.command_w")
        if type(self.ve) is not Variables:
            raise _replaced("ve", self.ve, "ve[name]")
        for name, axis in self._axes.items():
            if type(axis.lr_mc_control) is not McControl:
                elements = f"ax[{name}].lr_mc_control.probing_signal.command_w"
                raise _replaced(f"ax[{name}].lr_mc_control", axis.lr_mc_control, elements)
            if type(axis.lr_state) is not LrState:
                raise _replaced(f"ax[{name}].lr_state", axis.lr_state, f"ax[{name}].lr_mc_control")
            _check_units(f"ax[{name}].lr_mc_control", axis.lr_mc_control)
        _check_units("ch", self.ch)
        for name, value in self.ve.items():
            _require_number(name, value)


_UNITS = {
    McControl: {
        "probing_signal": BoolUnit,
        "timestamp": Sgn64Unit,
        "probing_position": Sgn64Unit,
        "ext_latch": ExtLatchUnit,
        "feedhold": BoolUnit,
        "override": Sgn64Unit,
    },
    ChannelHli: {
        "feedhold": BoolUnit,
        "override": Sgn64Unit,
        "reset": BoolUnit,
        "start": BoolUnit,
    },
}


def _label(head: str, holder: McControl | ChannelHli) -> None:
    for name in _UNITS[type(holder)]:
        getattr(holder, name).label = f"{head}.{name}"


def _check_units(head: str, holder: McControl | ChannelHli) -> None:
    for name, kind in _UNITS[type(holder)].items():
        if type(found := getattr(holder, name)) is not kind:
            elements = "ext_latch.done_w" if kind is ExtLatchUnit else f"{name}.command_w"
            raise _replaced(f"{head}.{name}", found, f"{head}.{elements}")


def _replaced(what: str, found: object, elements: str) -> UserError:
    return UserError(f"{what} has been replaced", value=found, hint=f"set {elements}")


def _require_number(name: str, value: Any) -> None:
    if type(value) not in (int, float) or not isfinite(value):
        raise UserError(f"V.E.{name} has a wrong type", value=value, allowed="a number")


def _require(name: str, value: Any, kind: type) -> None:
    if type(value) is not kind:
        words = {bool: "True or False", int: "a whole number"}
        raise UserError(f"{name} has a wrong type", value=value, allowed=words[kind])
