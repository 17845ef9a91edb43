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
from typing import Any

from axisrig.bench.machine.plc.distance_elements import (
    DistanceCommandElements,
    DistanceControlUnit,
    DistanceStateElements,
)
from axisrig.bench.machine.plc.elements import (
    SGN64,
    Kept,
    Named,
    out_of_range,
    put,
    replaced,
    require,
    require_number,
)
from axisrig.bench.machine.plc.terminal import ChannelInput
from axisrig.kernel.distance import DistanceCommand, DistanceState
from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.motion.feed import FULL
from axisrig.kernel.plc.probing import LatchTask

HLI_DIST_CTRL_OFF = int(DistanceCommand.OFF)
HLI_DIST_CTRL_ON = int(DistanceCommand.ON)
HLI_DIST_CTRL_FREEZE = int(DistanceCommand.FREEZE)
HLI_DIST_CTRL_ON_CONST_DIST = int(DistanceCommand.ON_CONST_DIST)
HLI_DIST_CTRL_STATE_INACTIVE = int(DistanceState.INACTIVE)
HLI_DIST_CTRL_STATE_ACTIVE = int(DistanceState.ACTIVE)
HLI_DIST_CTRL_STATE_FREEZE = int(DistanceState.FREEZE)
HLI_DIST_CTRL_STATE_TURNING_OFF = int(DistanceState.TURNING_OFF)
HLI_DIST_CTRL_STATE_ACTIVE_CONST_DIST = int(DistanceState.ACTIVE_CONST_DIST)
HLI_DIST_CTRL_STATE_ERROR = int(DistanceState.ERROR)
HLI_EXT_LATCH_ENABLE_PROBE = int(LatchTask.ENABLE)
HLI_EXT_LATCH_DISABLE_PROBE = int(LatchTask.DISABLE)
HLI_EXT_LATCH_PREPARE_PROBE = int(LatchTask.PREPARE)
WRITTEN = ("enable_w", "command_w")
"""Elements of a unit that the program sets."""
HIGHEST_PERMILLE = 2000
"""Of the override of the path; of an axis 1000 is the most."""


class Variables(Named[str, float]):
    """V.E. variables. Raises UserError for a value that is no number where it is set."""

    __slots__ = ()

    def __init__(self, values: Mapping[str, float]) -> None:
        super().__init__("variable V.E.", values)

    def __setitem__(self, name: str, value: float) -> None:
        """Set one."""
        require_number(name, value)
        super().__setitem__(name, value)


@dataclass(frozen=True, slots=True)
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
class BoolUnit(Kept):
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
            require(f"{self.label}.{element}", value, bool)
        put(self, element, value)


@dataclass(slots=True)
class Sgn64Unit(Kept):
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
            require(f"{self.label}.{element}", value, bool)
        elif element == "command_w":
            require(f"{self.label}.{element}", value, int)
            if value not in self.allowed:
                raise out_of_range(f"{self.label}.command_w", value, self.allowed)
        put(self, element, value)


@dataclass(slots=True)
class ExtLatchUnit(Kept):
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
            require(f"{self.label}.{element}", value, bool)
        put(self, element, value)


@dataclass(slots=True)
class McControl(Kept):
    """lr_mc_control of an axis; probing_position in 0.1 um or 0.0001 deg, override in 0.1 %."""

    probing_signal: BoolUnit = field(default_factory=BoolUnit)
    timestamp: Sgn64Unit = field(default_factory=Sgn64Unit)
    probing_position: Sgn64Unit = field(default_factory=Sgn64Unit)
    ext_latch: ExtLatchUnit = field(default_factory=ExtLatchUnit)
    feedhold: BoolUnit = field(default_factory=BoolUnit)
    override: Sgn64Unit = field(default_factory=lambda: Sgn64Unit(command_w=1000))
    distance_control: DistanceControlUnit = field(default_factory=DistanceControlUnit)


@dataclass(slots=True)
class LrState(Kept):
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
class AxisHli(Kept):
    """One axis."""

    lr_mc_control: McControl = field(default_factory=McControl)
    lr_state: LrState = field(default_factory=LrState)


@dataclass(slots=True)
class ChannelHli(Kept):
    """The channel; state_r: its state in words (RUNNING, READY ..).

    feedhold, override (0.1 %): of the path. reset, start: a rising edge of command_w resets the
    channel, or starts the program of the run. tool_tilt_r, tool_length_r: of the tool while a
    kinematic is on, inclination to Z of the machine in 0.0001 deg, length from the clamping point
    to the tool centre point in 0.1 um, virtually extended or not; 0 without one.
    """

    state_r: str = ""
    tool_tilt_r: int = 0
    tool_length_r: int = 0
    feedhold: BoolUnit = field(default_factory=BoolUnit)
    override: Sgn64Unit = field(default_factory=lambda: Sgn64Unit(command_w=1000))
    reset: BoolUnit = field(default_factory=BoolUnit)
    start: BoolUnit = field(default_factory=BoolUnit)


class Hli(Kept):
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
            raise replaced("ax", self.ax, "ax[name].lr_mc_control")
        if any(self.ax.get(name) is not axis for name, axis in self._axes.items()):
            raise replaced("ax", self.ax, "ax[name].lr_mc_control")
        if self.ch is not self._ch:
            raise replaced("ch", self.ch, "ch.feedhold.command_w")
        if type(self.ve) is not Variables:
            raise replaced("ve", self.ve, "ve[name]")
        for name, axis in self._axes.items():
            if type(axis.lr_mc_control) is not McControl:
                elements = f"ax[{name}].lr_mc_control.probing_signal.command_w"
                raise replaced(f"ax[{name}].lr_mc_control", axis.lr_mc_control, elements)
            if type(axis.lr_state) is not LrState:
                raise replaced(f"ax[{name}].lr_state", axis.lr_state, f"ax[{name}].lr_mc_control")
            _check_units(f"ax[{name}].lr_mc_control", axis.lr_mc_control)
        _check_units("ch", self.ch)
        for name, value in self.ve.items():
            require_number(name, value)


_UNITS = {
    McControl: {
        "probing_signal": BoolUnit,
        "timestamp": Sgn64Unit,
        "probing_position": Sgn64Unit,
        "ext_latch": ExtLatchUnit,
        "feedhold": BoolUnit,
        "override": Sgn64Unit,
        "distance_control": DistanceControlUnit,
    },
    ChannelHli: {
        "feedhold": BoolUnit,
        "override": Sgn64Unit,
        "reset": BoolUnit,
        "start": BoolUnit,
    },
}


_WORDS: Mapping[type, str] = {
    Hli: "hli",
    AxisHli: "hli.ax[..]",
    McControl: "lr_mc_control",
    LrState: "lr_state",
    ChannelHli: "hli.ch",
    BoolUnit: "the unit",
    Sgn64Unit: "the unit",
    ExtLatchUnit: "the unit",
    DistanceControlUnit: "the unit",
    DistanceCommandElements: "command_w",
    DistanceStateElements: "state_r",
    Inputs: "inputs",
    ChannelInput: "inputs.channel[..]",
}
"""What a program may ask for an element, in words where it has no label of its own."""


def _label(head: str, holder: McControl | ChannelHli) -> None:
    for name in _UNITS[type(holder)]:
        getattr(holder, name).label = f"{head}.{name}"
    if isinstance(holder, McControl):
        holder.distance_control.command_w.label = f"{head}.distance_control.command_w"


def _check_units(head: str, holder: McControl | ChannelHli) -> None:
    for name, kind in _UNITS[type(holder)].items():
        if type(found := getattr(holder, name)) is not kind:
            elements = "ext_latch.done_w" if kind is ExtLatchUnit else f"{name}.command_w"
            raise replaced(f"{head}.{name}", found, f"{head}.{elements}")


def unknown_element(error: AttributeError) -> UserError | None:
    """Return the message about an element that is not there; None for anything else."""
    holder: Any = error.obj
    name, words = error.name, _WORDS.get(type(holder))
    if isinstance(holder, Named) and name is not None:
        where = "hli.ve" if isinstance(holder, Variables) else "hli.ax"
        hint = f'write {where}["{name}"]'
        return UserError(
            f"the PLC program asks for an unknown element of {where}", value=name, hint=hint
        )
    if words is None or name is None:
        return None
    label = str(getattr(holder, "label", "")) or words
    slots = type(holder).__slots__
    known = [each for each in slots if each[0] != "_" and each != "label"]
    return UserError(
        f"the PLC program asks for an unknown element of {label}",
        value=name,
        allowed=nearest(name, known, 1) or known,
    )
