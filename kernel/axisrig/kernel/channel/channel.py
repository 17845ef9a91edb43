"""One NC channel: executes a program on its axes, once per cycle, over the bus only.

`Channel.cycle` is the order of everything, and so of the reaction to an edge (docs/architecture.md,
"One order"): the next SYNC samples it, the cycle after that brakes, from the next SYNC on it acts.
"""

from collections.abc import Callable, Iterator, Sequence

from axisrig.kernel.channel.alarm_log import AlarmLog, faulty_axes
from axisrig.kernel.channel.axes import Couplings, SingleAxes
from axisrig.kernel.channel.control_units import ControlUnits
from axisrig.kernel.channel.distance_controls import DistanceControls, make_controls
from axisrig.kernel.channel.path.execution import BlockEnd, Execution
from axisrig.kernel.channel.path.measurement import Measurement
from axisrig.kernel.channel.path.monitor import PowerUp
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import AxisSettings, ChannelSettings, CycleTiming
from axisrig.kernel.channel.path.soft_limits import SoftLimitWatch
from axisrig.kernel.channel.pauses import Pauses
from axisrig.kernel.channel.reactions import Reactions
from axisrig.kernel.channel.reset import Reset
from axisrig.kernel.channel.state import AT_REST, CONTROLLED, FAILED, ChannelState
from axisrig.kernel.channel.surroundings import Surroundings
from axisrig.kernel.channel.view import ChannelView
from axisrig.kernel.drives.interface import Drive, DriveStart
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.run import RunRecord
from axisrig.kernel.motion.interpolator import Interpolator
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.time.clock import Clock, Phase, TimeNs


class Channel(ChannelView):
    """A channel with its axes and drive links, in the same order.

    around: what it works with besides.
    observers: called with the channel at the end of every cycle; they change nothing.
    end_ns: instant at which the last program has ended, or what the PLC side did after it.
    program_ends_ns, resets_ns: when a program or a reset was over.
    It is the `MachineView` of its own interpreter; the program is handed over by `load`.

    Its parts are made in the order in which they need each other. Two pairs would be circles; a
    third that both take is between them: `AlarmLog` (a run warns, a reaction ends the run) and
    `Offsets` (a run asks for distance control, distance control for the run).
    """

    def __init__(
        self,
        clock: Clock,
        timing: CycleTiming,
        axes: Sequence[AxisSettings],
        links: Sequence[Drive],
        around: Surroundings,
        settings: ChannelSettings | None = None,
    ) -> None:
        self._clock, self.timing, self._mechanics = clock, timing, around.mechanics
        self.axes, self.links = tuple(axes), tuple(links)
        self._settings = settings or ChannelSettings()
        self.state = ChannelState.STARTING
        self._starting = 0
        self._make_parts(around)
        self._monitor = around.monitor
        self.functions = around.functions
        self._power_up = PowerUp(self.links, timing)
        self.drive_writes: list[tuple[TimeNs, canon.DriveWrite]] = []
        self.observers: list[Callable[[Channel], None]] = []
        self.start_ns: TimeNs | None = None
        self.end_ns: TimeNs | None = None
        self.program_ends_ns: list[TimeNs] = []
        self.resets_ns: list[TimeNs] = []
        ends = [
            self.execution.drop,
            self.path.brake,
            self.single.stop,
            self.measurement.reset,
            self.path.end_program,
            self.distance.reset,
            self.pauses.reset,
            self.functions.reset,
            self.plc.acknowledge,
        ]
        leaves, back = [self.distance.leave, self.single.end_program], self.single.lead_back
        self._reset = Reset(self.links, timing, self.path, self.reactions, ends, leaves, back)
        self._next_sync_ns = 0
        self._assign()

    def _make_parts(self, around: Surroundings) -> None:
        """Make what moves, measures and reacts."""
        clock, timing, settings = self._clock, self.timing, self._settings
        links = {link.name: link for link in self.links}
        self._log = AlarmLog(clock)
        self.execution = Execution(around.put_out)
        self.plc = plc = PlcInterface(clock, links)
        offsets = make_controls(
            self.axes,
            settings,
            links,
            plc,
            lambda: self.path.transformation.kinematic,
            timing.period_ns,
        )
        self.path = path = Path(clock, timing, self.axes, self.links, offsets, settings)
        couplings = Couplings(path, links)
        self.measurement = Measurement(
            clock,
            path,
            links,
            timing=timing,
            settings=settings,
            slaves_of=couplings.slaves_of,
            offsets=offsets,
            warn=self.warn,
            plc=plc,
        )
        self._units = units = ControlUnits(plc, path)
        self.single = SingleAxes(
            clock, timing, path, self.measurement, links, couplings, units.override_beside_permille
        )
        self.reactions = Reactions(
            self._log,
            path,
            self.measurement,
            self.execution,
            self.links,
            self.single.stop,
            each_axis_halts=settings.each_axis_halts,
        )
        self.distance = DistanceControls(path, self.single, self.axes, offsets, plc, self.warn)
        self._superpose = self.distance.superpose if offsets.is_used else None
        self.pauses = Pauses(clock, timing.period_ns, path.is_in_position, plc.events, settings)
        limits = {axis.name: axis.limits for axis in self.axes}
        self._limits = SoftLimitWatch(limits, links, offsets.uncounted_mm())

    def is_measuring(self, axis: str) -> bool:
        """Return whether a run of an axis is under way."""
        return self.single.measuring_state(axis) is not None

    def _may_choose(self) -> bool:
        """Whether no probe is armed, and no axis beside the path will arm one."""
        return self.measurement.may_choose() and not self.single.independent.is_measuring

    def _assign(self) -> None:
        """Say who carries out which command."""
        known, path, measurement = self.execution, self.path, self.measurement
        known.while_busy(self._is_busy)
        known.register(canon.LinearMove, self._move)
        known.register(canon.Warn, lambda command: self.warn(command.alarm))
        known.register(canon.ArcMove, self._move_on_arc)
        known.register(canon.KinematicChoice, path.transformation.choose)
        path.programmed.assign(known)
        self.pauses.assign(known)
        known.register(canon.MeasuringRun, measurement.begin, ready=path.is_in_position)
        known.register(canon.ProbeSettings, measurement.choose, ready=self._may_choose)
        known.register(canon.DefaultProbes, measurement.choose_default, ready=self._may_choose)
        known.register(canon.PrepareProbe, measurement.prepare)
        known.register(canon.DriveWrite, self._write_function)
        known.register(canon.DriveRead, self.functions.begin)
        known.register(canon.DriveWait, self.functions.begin)
        self.single.assign(known)
        self.distance.assign(known)
        known.while_busy(self.plc.is_waiting)
        known.register(canon.TechnologyFunction, self.plc.send)
        known.register(canon.ExternalWrite, self.plc.write)
        known.register(canon.Wait, self._go_on, ready=lambda: path.is_settled, is_block=False)
        known.register(canon.EndOfProgram, self._end, ready=self._may_end, is_block=False)

    # Life of a program

    def load(self, commands: Iterator[canon.Command]) -> None:
        """Take the command stream of an interpreter."""
        self.execution.load(commands)

    def start_up(self, drives: Sequence[DriveStart]) -> None:
        """Start all drives at the same time, then the cyclic exchange.

        Returns at once. When one of them does not start the program ends, with an alarm for each.
        """
        self._monitor.prepare()
        self._starting = len(drives)
        for drive in drives:
            drive.begin(self._on_started)

    def _on_started(self, alarm: Alarm | None) -> None:
        self._starting -= 1
        if alarm is not None:
            self._log.register(alarm)
        if self._starting:
            return
        if any(known.ends_program for known in self.alarms):
            self._monitor.end()
            self.state = ChannelState.ENDED
        else:
            self.start()

    def start(self) -> None:
        """Begin the cyclic exchange at the next whole period."""
        self.state = ChannelState.POWERING
        self._monitor.begin()
        self.functions.start()
        period = self.timing.period_ns
        self._next_sync_ns = -(-self._clock.now_ns // period) * period
        self._clock.call_at(self._next_sync_ns, Phase.APPLICATION, self._sync)

    @property
    def has_ended(self) -> bool:
        """Whether the program has ended, by its end or by an alarm, and the PLC side with it."""
        return self.state is ChannelState.ENDED

    @property
    def sync_ns(self) -> TimeNs:
        """Instant at which the last SYNC was requested."""
        return self._next_sync_ns - self.timing.period_ns

    def _sync(self) -> None:
        if self.has_ended:
            self._monitor.end()
            return
        self._monitor.begin_cycle()
        self._clock.call_at(
            self._next_sync_ns + self.timing.offset_ns, Phase.APPLICATION, self.cycle
        )
        self._next_sync_ns += self.timing.period_ns
        self._clock.call_at(self._next_sync_ns, Phase.APPLICATION, self._sync)

    def cycle(self) -> None:
        """Run one NC cycle. The order is the design's; each step uses this cycle's values."""
        was_stopping = self.state is ChannelState.STOPPING
        try:
            self._take()  # 1 what the bus delivered
            if self.start_ns is not None:
                self._units.step()  # 1b what the PLC side commands
                self._obey()
            self._control()
            if self.state is ChannelState.RUNNING:
                self.execution.step()  # 5 refill the queue, begin what comes next
        except Alarm as alarm:
            self._come_up(alarm)
            self._catch_up()
        if self.single.is_active:
            self.single.advance()
        if (passed := self.path.advance(self._superpose)) is not None:  # 5, 6 through the buffer
            self._come_up(passed)
            self.reactions.stop_alone(faulty_axes(passed))
            self.path.advance(self._superpose, is_judged=False)
        self._mechanics.advance_to(self.sync_ns)
        for observer in self.observers:  # 7, they change nothing
            observer(self)
        if was_stopping and self._has_stopped():
            self._stand_behind_alarm()
        elif self.state in AT_REST and (not self.plc.outlives_program or self.plc.is_idle()):
            self.end_ns = self.end_ns or self._clock.now_ns
            if self._mechanics.has_come_to_rest():
                self.state = ChannelState.ENDED

    def _take(self) -> None:
        """Take the telegrams; in ERROR nothing must keep the PLC side from a reset."""
        try:
            self._monitor.take()
        except Alarm as alarm:
            if self.state is not ChannelState.ERROR:
                raise
            self._come_up(alarm)

    def _control(self) -> None:
        """Do what follows from the values of this cycle: its steps 2 to 4."""
        if self.state in CONTROLLED:
            self.measurement.step()  # 2 signals, with the positions of this cycle
            if self.single.is_active:
                self.single.step()
            self.distance.step()  # 3 distance control
            self._monitor.check_drives()  # 4 drives and software limit switches
            self._limits.check()
            self.functions.check()
        elif self.state is ChannelState.POWERING:
            self._power()
        elif self.state in FAILED and self.start_ns is not None:
            self.distance.step(is_stopping=True)
            self._monitor.check_drives()
        elif self.state is ChannelState.RESETTING:
            self.distance.step(is_stopping=True)
            if not self._has_stopped():
                self._monitor.check_drives()
            elif self._reset.go_on():
                self.state = ChannelState.READY
                self.resets_ns.append(self._clock.now_ns)

    def _stand_behind_alarm(self) -> None:
        """Go into ERROR for a PLC side that may reset, else end."""
        self.execution.close(BlockEnd.STOPPED)
        self.reactions.give_back()
        self.distance.end_by_error()
        self.measurement.end_preparation()
        if self.plc.outlives_program:
            self.state = ChannelState.ERROR
            self.program_ends_ns.append(self._clock.now_ns)
            return
        self.end_ns = self.end_ns or self._clock.now_ns
        if self._mechanics.has_come_to_rest():
            self.state = ChannelState.ENDED

    def _catch_up(self) -> None:
        """Give distance control its step when an alarm of something else came before it."""
        if self.start_ns is None or self.distance.has_stepped:
            return
        try:
            self.distance.step(is_stopping=self.state in FAILED)
        except Alarm as alarm:
            self._come_up(alarm)

    def _has_stopped(self) -> bool:
        path = self.path
        return path.has_stopped and not self.single.is_moving and self.reactions.has_stopped

    def _power(self) -> None:
        self.path.take_over(tuple(link.place_mm for link in self.links))
        if self._power_up.step():
            self.state = ChannelState.RUNNING
            self.start_ns = self._clock.now_ns
            self._units.step()
            self.distance.step()

    # What observers and the command line read

    @property
    def interpolator(self) -> Interpolator:
        """The interpolator of the path."""
        return self.path.interpolator

    @property
    def records(self) -> list[RunRecord]:
        """Every measurement run of the program, in order."""
        return self.measurement.records

    @property
    def alarms(self) -> list[Alarm]:
        """What has come up, in order."""
        return self._log.alarms

    @property
    def alarm_ns(self) -> list[TimeNs]:
        """When it came up, in the same order."""
        return self._log.alarm_ns

    @property
    def further_alarms(self) -> list[Alarm]:
        """What came up besides, while the axes stopped."""
        return self._log.further

    # Carrying out commands

    def _move(self, command: canon.LinearMove) -> None:
        self.path.move(command.target_mm, None if command.rapid else command.feed_mm_min)

    def _move_on_arc(self, command: canon.ArcMove) -> None:
        self.path.move_on_arc(
            command.target_mm,
            command.centre_mm,
            command.tangent,
            command.angle_rad,
            command.feed_mm_min,
        )

    def _is_busy(self) -> bool:
        return self.measurement.is_active or self.path.is_moving or self.functions.is_waiting

    def _write_function(self, command: canon.DriveWrite) -> None:
        self.drive_writes.append((self._clock.now_ns, command))
        self.functions.begin(command)

    def _go_on(self, _command: canon.Wait) -> None:
        """Nothing to do: the interpreter may decode on."""

    def _may_end(self) -> bool:
        return (
            not self.single.is_moving
            and not self.distance.is_turning_off
            and self.path.is_in_position()
            and not self.functions.is_busy
        )

    def _end(self, command: canon.EndOfProgram) -> None:
        self.program_ends_ns.append(self._clock.now_ns)
        if self.plc.outlives_program:
            self.state = ChannelState.READY
        else:
            goes_on = self._mechanics.goes_on
            self.state = ChannelState.READY if goes_on else ChannelState.ENDED
            self.end_ns = self._clock.now_ns
        self.measurement.end_program()
        self.path.end_program()
        self.distance.end_program(command.block.place)
        self.single.end_program()

    # What the PLC side commands

    def _obey(self) -> None:
        """Begin a reset, or a program; a reset that comes while an alarm stops waits for its end.

        Raises Alarm 900290 (class 1) for a start that no channel in this state takes.
        """
        plc = self.plc
        if plc.wants_reset and self.state is not ChannelState.STOPPING:
            plc.wants_reset = False
            self.state = ChannelState.RESETTING
            self._reset.begin()
        program, plc.program = plc.program, None
        if program is None:
            return
        if self.state is ChannelState.READY:
            self.measurement.begin_program()
            self.load(program)
            self.state = ChannelState.RUNNING
        else:
            self.warn(Alarm(900290, state=self.state.name))

    # Stopping

    def _come_up(self, alarm: Alarm) -> None:
        """React to an alarm and to what came up with it; the first that ends the program counts."""
        further = self._monitor.further + self.distance.further
        self._monitor.further, self.distance.further = [], []
        for one in (alarm, *further):
            if self.state in FAILED:
                self._log.register_further(one)
            elif self.reactions.come_up(one):
                self.state = ChannelState.STOPPING
                self.distance.switch_off(faulty_axes(one))

    def stop(self, alarm: Alarm) -> None:
        """Stop from outside, between two cycles: brake and end, as for an alarm of its own."""
        if not self.has_ended:
            self._come_up(alarm)

    def warn(self, alarm: Alarm) -> None:
        """Note an alarm of class 1: the program goes on."""
        self._log.register(alarm)
