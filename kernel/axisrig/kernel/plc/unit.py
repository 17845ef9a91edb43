"""The control units of an axis at the PLC's side: feedhold and override, distance control.

Source: HLI, control commands of an axis; MC_CONTROL_DISTANCE_CONTROL (TF5200 distance control
290209035), whose element names are used here.
"""

from dataclasses import dataclass, field

from axisrig.kernel.distance import DistanceCommand, DistanceState, Source
from axisrig.kernel.plc.probing import ProbingUnit
from axisrig.kernel.time.clock import TimeNs


@dataclass
class UnitCommand:
    """What the PLC asks for; set positions in mm.

    transition: None only hands over set values. set_pos_mm, set_dist_mm: None leaves them.
    """

    transition: DistanceCommand | None = None
    set_pos_mm: float | None = None
    set_dist_mm: float | None = None


@dataclass
class UnitState:
    """What the kernel shows, in mm; None while no sensor value is known."""

    state: DistanceState = DistanceState.INACTIVE
    surface_mm: float | None = None
    distance_mm: float | None = None
    source: Source = Source.NC
    actual_offset_mm: float = 0.0


@dataclass
class DistanceUnit:
    """Control unit of the distance control of one axis.

    enable_w: the PLC may command. command_semaphor_rw: the PLC sets it with a command and may
    change the command only while it is False; the kernel takes the command in the same cycle and
    sets it False. Without enable_w commands wait.
    """

    enable_w: bool = False
    command_semaphor_rw: bool = False
    command_w: UnitCommand = field(default_factory=UnitCommand)
    state_r: UnitState = field(default_factory=UnitState)


@dataclass
class AxisUnit:
    """Control units of one axis.

    feedhold: True stops the axis and with it the path that moves it. override_permille: from 0 to
    1000, the feed as it is; 0 does what the feedhold does. Either freezes the offset of distance
    control (FCT-M3 2 and 5), between them the override scales its v_max. probing: for measuring.
    """

    feedhold: bool = False
    override_permille: int = 1000
    distance: DistanceUnit = field(default_factory=DistanceUnit)
    probing: ProbingUnit = field(default_factory=ProbingUnit)

    @property
    def holds(self) -> bool:
        """Whether the axis is to be held at rest."""
        return self.feedhold or self.override_permille == 0


@dataclass
class ToolState:
    """The tool as a kinematic has it at the actual positions of this cycle; None without one.

    tilt_deg: inclination to Z of the machine. length_mm: from the tool clamping point to the TCP,
    virtually extended or not. Source: FCT-M3 12.5.
    """

    tilt_deg: float | None = None
    length_mm: float | None = None


@dataclass
class Refreshed:
    """A variable that the PLC side promises to refresh.

    period_ns: after so long at the latest. age_cycles: NC cycles since it was.
    """

    period_ns: TimeNs
    age_cycles: int = 0
