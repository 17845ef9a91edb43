"""The interface to the PLC side: what the channel reports to it, and what it commands.

Once per cycle, before everything that moves, the PLC side has its turn; its commands act in that
cycle (`kernel.channel.control_units`), and what the program reports in a cycle it sees in the next
one. Sources: TF5200
external variables 1091998347; HLI, MC_Control units of a channel (path feedhold); MVS_SVS of
P-CHAN-00041 (functions that the PLC acknowledges).
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.feed import FULL
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.probing import PlcTask
from axisrig.kernel.plc.unit import AxisUnit, Refreshed, ToolState
from axisrig.kernel.time.clock import Clock, TimeNs


@dataclass(frozen=True)
class PlcAction:
    """Something that the PLC side has done, in words; place: where it is written."""

    words: str
    place: str


class PlcEvent(NamedTuple):
    """Something that passed between the program and the PLC side.

    starts_again: the operator's start after a programmed stop, not the stop itself.
    """

    time_ns: TimeNs
    command: canon.ProgramStop | canon.TechnologyFunction | canon.ExternalWrite | PlcAction
    starts_again: bool = False


@dataclass(frozen=True)
class PlcParticipant:
    """Who works on the PLC side of a channel: columns of a plan, a task.

    take_turn: its own work of a cycle. acknowledged_later: functions (M50) that it acknowledges by
    `PlcInterface.acknowledge`. outlives_program: it goes on when a program has ended, until
    `is_idle` says that it has nothing more to do; None: it never has. task: the task of a PLC that
    has a cycle of its own.
    """

    take_turn: Callable[[], None]
    acknowledged_later: frozenset[str] = frozenset()
    outlives_program: bool = False
    is_idle: Callable[[], bool] | None = None
    task: PlcTask | None = None


class PlcInterface:
    """One channel as the PLC side sees it.

    The PLC side reads the channel and the channel carries out what the PLC side commands: the two
    are connected by this interface only. Who is on the PLC side joins it once the channel is made.

    values: V.E. variables by the name after `V.E.`; a program reads them at the block that uses
    one, when everything before it is executed. events: everything that passed, in order.
    refreshed: variables that the PLC side promises to refresh, by the same name.
    inputs: write into `values` what the PLC side reads, before its turn.
    feedhold, override_permille: control units of the path; True or 0 stops it. axis: control units
    of every axis. acknowledged_later: functions (M50) that the PLC side acknowledges by
    `acknowledge`; every other one counts as acknowledged at once.
    reported: alarms of the PLC side that the channel raises, one in each cycle.
    wants_reset, program: commands to the channel, which takes them in the same cycle.
    outlives_program: somebody on the PLC side goes on when a program has ended. task: the task of
    the PLC that has a cycle of its own, None without one.
    tool: inclination and length of the tool while a kinematic is on. The channel writes it in every
    cycle before it calls `inputs`, from the actual positions of the SYNC of this cycle, so that
    the PLC side normalises the sensor value of the same SYNC by it.
    """

    def __init__(self, clock: Clock, axes: Iterable[str]) -> None:
        self._clock = clock
        self.axis: Mapping[str, AxisUnit] = {axis: AxisUnit() for axis in axes}
        self.values: dict[str, float] = {}
        self.refreshed: dict[str, Refreshed] = {}
        self.events: list[PlcEvent] = []
        self.inputs: list[Callable[[], None]] = []
        self._participants: list[PlcParticipant] = []
        self.feedhold = False
        self.override_permille = FULL
        self.acknowledged_later: frozenset[str] = frozenset()
        self.wants_reset = False
        self.program: Iterator[canon.Command] | None = None
        self.outlives_program = False
        self._awaits_acknowledgement = False
        self.reported: list[Alarm] = []
        self.task: PlcTask | None = None
        self.tool = ToolState()

    def join(self, participant: PlcParticipant) -> None:
        """Take somebody on the PLC side; turns are taken in the order of joining."""
        self._participants.append(participant)
        self.acknowledged_later |= participant.acknowledged_later
        self.outlives_program = self.outlives_program or participant.outlives_program
        if participant.task is not None:
            self.task = participant.task

    # What the channel does

    def take_turn(self) -> None:
        """Let the PLC side do its work of a cycle."""
        for participant in self._participants:
            participant.take_turn()

    def is_idle(self) -> bool:
        """Return whether nobody on the PLC side has anything left to do."""
        return all(p.is_idle is None or p.is_idle() for p in self._participants)

    def is_waiting(self) -> bool:
        """Return whether a function is still to be acknowledged: nothing begins before."""
        return self._awaits_acknowledgement

    def send(self, command: canon.TechnologyFunction) -> None:
        """Send a function to the PLC side."""
        self.events.append(PlcEvent(self._clock.now_ns, command))
        self._awaits_acknowledgement = command.word in self.acknowledged_later

    def write(self, command: canon.ExternalWrite) -> None:
        """Give out a value: the PLC side has it from now on."""
        self.values[command.name] = command.value
        self.events.append(PlcEvent(self._clock.now_ns, command))

    def show_tool(self, tilt_deg: float | None, length_mm: float | None) -> None:
        """Show the PLC side the tool, and a program where it has the variables."""
        self.tool.tilt_deg, self.tool.length_mm = tilt_deg, length_mm
        for name, value in zip(canon.SHOWN_OF_TOOL, (tilt_deg, length_mm), strict=True):
            if name in self.values:
                self.values[name] = value or 0.0

    # What the PLC side does in its turn, or when a drive has answered it

    def acknowledge(self) -> None:
        """Acknowledge the function that was sent last."""
        self._awaits_acknowledgement = False

    def note(self, words: str, place: str) -> None:
        """Keep what the PLC side has done, for log and marks."""
        self.events.append(PlcEvent(self._clock.now_ns, PlcAction(words, place)))

    def report(self, alarm: Alarm) -> None:
        """Let the channel raise an alarm in its next cycle."""
        self.reported.append(alarm)
