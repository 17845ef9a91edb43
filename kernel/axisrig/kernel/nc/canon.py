"""What the interpreter hands to the channel: plain commands in machine axes and millimetres.

Everything the language has of coordinate systems, shifts and variables is resolved here: a
channel moves axes, runs measurements and puts out messages without reading a word of NC text.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.nc import canon_drives
from axisrig.kernel.nc.block import Block

DriveWrite = canon_drives.DriveWrite
DriveRead = canon_drives.DriveRead
DriveWait = canon_drives.DriveWait
DriveCommand = DriveWrite | DriveRead | DriveWait

# V.E. variables of a channel with 3D distance control: degrees, mm; 0 without a kinematic. The
# channel writes them, no program does.
TOOL_TILT, TOOL_LENGTH = "TOOL_TILT", "TOOL_LENGTH"
SHOWN_OF_TOOL = (TOOL_TILT, TOOL_LENGTH)


@dataclass(frozen=True)
class LinearMove:
    """A straight move of all axes together.

    target_mm: every axis that changes, in axis coordinates; in tool coordinates while a
    kinematic is on, as in every other command of the path. rapid: G0, else G1.
    feed_mm_min: path feed, None for rapid.
    """

    block: Block
    target_mm: Mapping[str, float]
    rapid: bool
    feed_mm_min: float | None


@dataclass(frozen=True)
class KinematicChoice:
    """Targets are tool coordinates of this kinematic from here on (#TRAFO); None: of the axes.

    axes: those that it contains, in its order. ids, tool_mm, written: what it was built from: IDs
    of its steps, length of the tool, V.G.KIN_STEP[].ID[].PARAM[] by its three indices.
    """

    block: Block
    kinematic: Kinematic | None
    axes: tuple[str, ...] = ()
    ids: tuple[int, ...] = ()
    tool_mm: float = 0.0
    written: Mapping[tuple[int, ...], float] = field(default_factory=dict)


@dataclass(frozen=True)
class SlopeChoice:
    """The acceleration profile of the path from here on (#SLOPE).

    profile: STEP, TRAPEZ or SIN2; None = that of P-CHAN-00071.
    """

    block: Block
    profile: str | None


@dataclass(frozen=True)
class DynamicWeights:
    """Weights of feed blocks from here on (G130 to G134).

    what: acceleration, ramp_time or contour_time. shares: 1 = as in the lists, by axis.
    """

    block: Block
    what: str
    shares: Mapping[str, float]


@dataclass(frozen=True)
class ArcMove:
    """An arc of a circle; everything else moves in proportion to its angle.

    target_mm: every axis that takes part. centre_mm: the axes of the circle; the radius
    vector from it to where they are is at right angles to the tangent. tangent: unit vector of
    the motion at the start, by axis, the same axes. angle_rad: above 0, at most a full turn.
    feed_mm_min: path feed.
    """

    block: Block
    target_mm: Mapping[str, float]
    centre_mm: Mapping[str, float]
    tangent: Mapping[str, float]
    angle_rad: float
    feed_mm_min: float


@dataclass(frozen=True)
class Dwell:
    """Nothing moves for a time (G4, #TIME), counted from where the path before has ended."""

    block: Block
    duration_ns: int


@dataclass(frozen=True)
class ExactStop:
    """Nothing goes on before every axis is in its exact-stop window (G60, G360)."""

    block: Block


@dataclass(frozen=True)
class ProgramStop:
    """Nothing goes on before the operator starts again: M0, or M1 (optional)."""

    block: Block
    optional: bool


@dataclass(frozen=True)
class TechnologyFunction:
    """An M, H, S or T function is sent to the PLC side; letter and number as programmed."""

    block: Block
    letter: str
    number: int

    @property
    def word(self) -> str:
        """Letter and number, as M50."""
        return f"{self.letter}{self.number}"


@dataclass(frozen=True)
class MeasuringRun:
    """A straight move that the probe signal ends (G100, G310).

    target_mm: every axis that changes. programmed_axes: the axes named in the block.
    measuring_axes: the axes that must be released and must signal: the moved ones without a
    transformation, all three main axes as well under #CS, every axis of a kinematic under #TRAFO.
    feed_mm_min: path feed, None for rapid (G310 with G0) and for the speed of the axis (type 2).
    goes_on: the signal does not end the motion (G106). error_no_signal: ERR_NO_SIGNAL of #MEAS,
    None = P-CHAN-00176. simulated_offset_mm: SIMU_OFFSET of #MEAS, along the path.
    Source: FCT-C4 section 4.
    """

    block: Block
    target_mm: Mapping[str, float]
    programmed_axes: tuple[str, ...]
    measuring_axes: tuple[str, ...]
    feed_mm_min: float | None
    measuring_type: int
    goes_on: bool = False
    error_no_signal: bool | None = None
    simulated_offset_mm: float = 0.0


@dataclass(frozen=True)
class ProbeSettings:
    """Which signal an axis measures with from its next run on (#MEAS); None = as it was.

    edge: POS or NEG. probe_input: of the drive. probe: 0 or 1 for INPUT=PROBE0 or PROBE1, which
    mean an input of the parameter list. source: SIGNAL, as P-AXIS-00516.
    """

    block: Block
    axis: str
    edge: str | None = None
    probe_input: int | None = None
    probe: int | None = None
    source: str | None = None


@dataclass(frozen=True)
class DefaultProbes:
    """Every axis measures with what its parameter list says (#MEAS DEFAULT)."""

    block: Block


@dataclass(frozen=True)
class PrepareProbe:
    """The probes of these axes are to be made ready ahead of their run (#MEAS PREPARE)."""

    block: Block
    axes: tuple[str, ...]


@dataclass(frozen=True)
class Message:
    """A text for the operator (#MSG); synchronous: put out when the machining has got here.

    values: the numbers in the text, before they were formatted, in their order. receiver: whom the
    program names for it (`HMI`, `PLC`, `INFO PLC`), empty for the diagnosis of the CNC.
    """

    block: Block
    text: str
    synchronous: bool
    values: tuple[float, ...] = field(default=(), compare=False)
    receiver: str = ""

    @property
    def shown(self) -> str:
        """The text after the name of its receiver."""
        return f"{self.receiver}: {self.text}" if self.receiver else self.text


@dataclass(frozen=True)
class Warn:
    """An alarm of class 1: it is reported when the machining gets here, and the program goes on."""

    block: Block
    alarm: Alarm


@dataclass(frozen=True)
class ExternalWrite:
    """A value for a variable of the PLC side, given out when the machining has got here.

    name: after `V.E.`, as the PLC side spells it.
    """

    block: Block
    name: str
    value: float


@dataclass(frozen=True)
class Wait:
    """The interpreter goes on only after everything before this has been executed.

    for_cycle: and only in the next cycle, so that a loop that asks the PLC side takes time.
    """

    block: Block
    for_cycle: bool = False


@dataclass(frozen=True)
class EndOfProgram:
    """Nothing follows."""

    block: Block


@dataclass(frozen=True)
class IndependentMove:
    """One axis moves by itself, beside the path (INDP_SYN, INDP_ASYN).

    target_mm: in axis coordinates. Its speed is one of feed_mm_min (FEED), time_s (TIME, for
    the whole motion) and speed_share (FEED_MAX_WEIGHT, of P-AXIS-00212); all None in rapid
    traverse (G00). acceleration_share: ACC_WEIGHT or RAPID_ACC_WEIGHT. measuring_type: of a
    measurement run (G100), else None; error_no_signal: of that run, None = P-CHAN-00176.
    slope: its acceleration profile (SLOPE_TYPE), None = P-CHAN-00071.
    """

    block: Block
    axis: str
    target_mm: float
    feed_mm_min: float | None = None
    time_s: float | None = None
    speed_share: float | None = None
    acceleration_share: float = 1.0
    measuring_type: int | None = None
    error_no_signal: bool | None = None
    slope: str | None = None


@dataclass(frozen=True)
class WaitIndependent:
    """Nothing goes on before these axes are at their targets (INDP_SYN, #WAIT INDP)."""

    block: Block
    axes: tuple[str, ...]


@dataclass(frozen=True)
class AxisPair:
    """A slave and the master it follows; limits_mm: of a gantry, None without watch."""

    slave: str
    master: str
    limits_mm: tuple[float, float] | None = None


@dataclass(frozen=True)
class AxisLinkOn:
    """The slaves of a coupling group follow their masters from here on (#ENABLE AX LINK)."""

    block: Block
    group: int
    pairs: tuple[AxisPair, ...]


@dataclass(frozen=True)
class AxisLinkOff:
    """They follow no longer (#DISABLE AX LINK)."""

    block: Block
    group: int


@dataclass(frozen=True)
class Homing:
    """Axes look for their reference, group after group, all of a group together (G74)."""

    block: Block
    groups: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class AxisExchange:
    """Axes have left the channel (#PUT AX) or are back (#CALL AX)."""

    block: Block
    given: tuple[str, ...]
    called: tuple[str, ...]


@dataclass(frozen=True)
class AdoptActual:
    """The set positions of axes at rest become their actual ones (#CHANNEL INIT [ACTPOS])."""

    block: Block
    axes: tuple[str, ...]


@dataclass(frozen=True)
class DistanceCommand:
    """One word for the distance control of an axis, `Z[DIST_CTRL ..]`, or of the channel.

    axis: None = the control of the channel, `#DIST CTRL`.
    action: on (surface), on_const, off, freeze, check, ref; None where only values are given.
    wait: nothing goes on before the control is completely on or off. no_move: with off, the axis
    stays where it is and the program counts from there. dry_run: with on and on_const, nothing is
    put out. set_pos_mm: of the surface, axis coordinates; set_dist_mm. parameters: by their names
    in `DistanceControl.program`, what was not programmed is not there. sensor_source: VARIABLE or
    SECOND_ENCODER. sensor_variable: after `V.E.` as the PLC side spells it, else as programmed.
    values: VAL1 to VAL5. All act in this order: sensor, values, parameters, action. Of the channel
    alone: mode (ACS, ECS, MCS) and direction, the axis of ACS, None = as before; normal and
    origin_mm: Z axis and origin of the active #CS in the coordinates of the machine.
    """

    block: Block
    axis: str | None
    action: str | None = None
    wait: bool = False
    no_move: bool = False
    dry_run: bool = False
    set_pos_mm: float | None = None
    set_dist_mm: float | None = None
    parameters: Mapping[str, float | str] = field(default_factory=dict)
    sensor_source: str | None = None
    sensor_variable: str | None = None
    values: tuple[float | None, ...] = (None,) * 5
    mode: str | None = None
    direction: str | None = None
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    origin_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)


AxisOrder = (
    IndependentMove
    | WaitIndependent
    | AxisLinkOn
    | AxisLinkOff
    | Homing
    | AxisExchange
    | AdoptActual
    | DistanceCommand
)
Pause = Dwell | ExactStop | ProgramStop
Measuring = MeasuringRun | ProbeSettings | DefaultProbes | PrepareProbe
Command = (
    LinearMove
    | ArcMove
    | KinematicChoice
    | SlopeChoice
    | DynamicWeights
    | Measuring
    | Message
    | DriveCommand
    | AxisOrder
    | Pause
    | TechnologyFunction
    | Warn
    | ExternalWrite
    | Wait
    | EndOfProgram
)

# What the machine is busy with for a while: a loop that holds one of these is not endless at once
TAKES_TIME = (
    LinearMove,
    ArcMove,
    MeasuringRun,
    DriveRead,
    DriveWait,
    IndependentMove,
    Homing,
)


def takes_time(command: Command) -> bool:
    """Return whether at least one cycle passes with a command, whatever the machine does."""
    if isinstance(command, Dwell):
        return command.duration_ns > 0
    if isinstance(command, ProgramStop):
        return not command.optional
    return isinstance(command, TAKES_TIME)
