"""One NC channel: executes a program on its axes, once per cycle, over the bus only.

`Channel.cycle` is the order of everything (docs/architecture.md, "One order"). The reaction to an
edge follows from it: the SYNC after the latch samples the status word, the cycle after that SYNC
brakes, its set position acts from the next SYNC on.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from enum import Enum, auto
from math import dist
from typing import Any

from kernel.channel.drive_functions import DriveFunctions
from kernel.channel.lookahead import Lookahead
from kernel.channel.monitor import Monitor, PowerUp
from kernel.channel.settings import AxisSettings, CycleTiming
from kernel.clock import Clock, Phase, TimeNs
from kernel.drives.link import AxisLink
from kernel.drives.startup import StartUp
from kernel.errors import Alarm
from kernel.measuring.run import MeasuringRun, Order, RunRecord, RunState
from kernel.motion.dynamics import Dynamics, Motion, path_dynamics
from kernel.motion.interpolator import Interpolator, Positions, SetpointBuffer
from kernel.motion.profile import plan
from kernel.nc import canon

SYNC_COB_ID = 0x80
NOT_FOLLOWING = 900029  # braking the set position would not stop this axis
SETTLED_CYCLES = 10


class ChannelState(Enum):
    """STARTING over SDO, POWERING until every drive is enabled, RUNNING, STOPPING after an alarm,
    ENDED.
    """

    STARTING = auto()
    POWERING = auto()
    RUNNING = auto()
    STOPPING = auto()
    ENDED = auto()


class Channel:
    """A channel with its axes and drive links, in the same order.

    networks: one canopen network per segment, for the SYNC. error_no_signal: P-CHAN-00176.
    monitor: the watch over drives and buses; without one drives are watched by their telegrams.
    functions: what #DRIVE acts on; to be set before a program that has it is loaded.
    has_come_to_rest: asked in every cycle after an alarm once the set positions stand; SYNC and
    cycles go on until it says so. end_ns: instant at which the program has ended.
    put_out: takes every message as soon as it is due. It is the `MachineView` of its own
    interpreter; the program is handed over by `load`.
    """

    def __init__(
        self,
        clock: Clock,
        timing: CycleTiming,
        axes: Sequence[AxisSettings],
        links: Sequence[AxisLink],
        networks: Sequence[Any],
        *,
        error_no_signal: bool,
        put_out: Callable[[canon.Message], None],
        monitor: Monitor | None = None,
    ) -> None:
        self._clock, self.timing = clock, timing
        self.axes, self.links, self._networks = tuple(axes), tuple(links), tuple(networks)
        self._index = {axis.name: index for index, axis in enumerate(axes)}
        self._error_no_signal = error_no_signal
        self._put_out = put_out
        self.interpolator = Interpolator([axis.name for axis in axes], timing.period_ns)
        self._buffer = SetpointBuffer(timing.buffer_cycles, self.interpolator.positions_mm)
        self._lookahead: Lookahead | None = None
        self.state = ChannelState.STARTING
        self._starting = 0
        self.alarms: list[Alarm] = []
        self.alarm_ns: list[TimeNs] = []
        self.records: list[RunRecord] = []
        self.drive_writes: list[tuple[TimeNs, canon.DriveWrite]] = []
        self.observers: list[Callable[[Channel], None]] = []
        self.start_ns: TimeNs | None = None
        self.end_ns: TimeNs | None = None
        self.has_come_to_rest: Callable[[], bool] = lambda: True
        self._run: MeasuringRun | None = None
        self._measuring: tuple[canon.MeasuringRun, Dynamics] | None = None
        self._block: canon.Block | None = None  # under execution
        self._measured: dict[str, float | None] = {}
        self._stop_dynamics: Dynamics | None = None
        self._monitor = monitor or Monitor(self.links, self._networks, clock)
        self.functions = DriveFunctions({})
        self._power_up = PowerUp(self.links, timing)
        self._settling_since_ns: TimeNs | None = None
        self._inside_since_ns: TimeNs | None = None
        self._next_sync_ns: TimeNs = 0
        self._sync_count = 0

    # Life of a program

    def load(self, commands: Iterator[canon.Command]) -> None:
        """Take the command stream of an interpreter."""
        self._lookahead = Lookahead(commands, self._put_out)

    def start_up(self, drives: Sequence[StartUp]) -> None:
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
            self._register(alarm)
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
        """Whether the program has ended, by its end or by an alarm."""
        return self.state is ChannelState.ENDED

    @property
    def sync_ns(self) -> TimeNs:
        """Instant at which the last SYNC was requested."""
        return self._next_sync_ns - self.timing.period_ns

    def _sync(self) -> None:
        if self.has_ended:
            self._monitor.end()
            return
        self._monitor.before_sync()
        for link in self.links:
            link.begin_cycle()
        data = self.next_sync_data()
        for network in self._networks:
            network.send_message(SYNC_COB_ID, data)
        self._clock.call_at(
            self._next_sync_ns + self.timing.offset_ns, Phase.APPLICATION, self.cycle
        )
        self._next_sync_ns += self.timing.period_ns
        self._clock.call_at(self._next_sync_ns, Phase.APPLICATION, self._sync)

    def next_sync_data(self) -> bytes:
        """Return what the next SYNC carries: nothing, or its counter."""
        overflow = self.timing.sync_counter
        if not overflow:
            return b""
        self._sync_count = self._sync_count % overflow + 1
        return bytes((self._sync_count,))

    def cycle(self) -> None:
        """Run one NC cycle. The order is the design's; each step uses this cycle's values."""
        was_stopping = self.state is ChannelState.STOPPING
        try:
            self._monitor.take()  # 1 what the bus delivered
            self._measure()  # 2 signals, with the positions of this cycle
            self._watch()  # 4 drives and exact stop (3, distance control, has its own issue)
            self._execute()  # 5 refill the queue, begin what comes next
        except Alarm as alarm:
            self._come_up(alarm)
        self._send(self.interpolator.advance())  # 5, 6 next set positions through the buffer
        for observer in self.observers:  # 7
            observer(self)
        if was_stopping and self._has_stopped():
            self.end_ns = self.end_ns or self._clock.now_ns
            if self.has_come_to_rest():
                self.state = ChannelState.ENDED

    # What the interpreter may ask (MachineView)

    def position_acs_mm(self, axis: str) -> float:
        """Return where the interpolation stands, axis coordinates."""
        return self.interpolator.positions_mm[self._index[axis]]

    def measured_acs_mm(self, axis: str) -> float | None:
        """Return the measured position of the axis' last run, None without a valid one."""
        return self._measured.get(axis)

    def measurement_ok(self, axis: str) -> bool:
        """Tell whether the axis' last run had a signal (V.A.MERF)."""
        return self._measured.get(axis) is not None

    def drive_value(self, axis: str, key: str) -> float:
        """Return what the last #DRIVE RD of this function brought."""
        return self.functions.value(axis, key)

    # Steps of the cycle

    def _measure(self) -> None:
        if self._run is None or self.state is not ChannelState.RUNNING:
            return
        assert self._measuring is not None
        order = self._run.evaluate(self._clock.now_ns, self._is_in_position())
        command, dynamics = self._measuring
        if order is Order.START:
            self._begin_path(command.target_acs_mm, command.feed_mm_min / 60.0, dynamics)
        elif order is Order.BRAKE:
            self.interpolator.brake(dynamics.stop_deceleration)
        if self._run.state is RunState.DONE:
            record = self._run.record
            self._measured.update({axis: record.latched_mm.get(axis) for axis in record.axes})
            self._run = self._measuring = None

    def _watch(self) -> None:
        if self.state is ChannelState.RUNNING:
            self._monitor.check_drives()
            self.functions.check()
        elif self.state is ChannelState.POWERING:
            actual = tuple(link.actual_mm for link in self.links)
            self.interpolator.hold(actual)
            self._buffer = SetpointBuffer(self.timing.buffer_cycles, actual)
            if self._power_up.step():
                self.state = ChannelState.RUNNING
                self.start_ns = self._clock.now_ns

    def _execute(self) -> None:
        assert self._lookahead is not None
        while self.state is ChannelState.RUNNING and not self._is_busy():
            self._lookahead.refill()
            command = self._lookahead.head
            if isinstance(command, canon.Wait):
                if not self._buffer.is_settled:
                    return
            elif isinstance(command, canon.EndOfProgram):
                if not self._is_in_position() or self.functions.is_busy:
                    return
                self.state = ChannelState.ENDED
                self.end_ns = self._clock.now_ns
            elif isinstance(command, canon.Message):
                self._put_out(command)
            elif isinstance(command, canon.MeasuringRun) and not self._is_in_position():
                return
            else:
                self._block = command.block
                self._begin(command)
            self._lookahead.pop()

    def _is_busy(self) -> bool:
        moves = self._run is not None or not self.interpolator.is_standing
        return moves or self.functions.is_waiting

    def _send(self, positions_mm: Positions) -> None:
        for link, position_mm in zip(self.links, self._buffer.shift(positions_mm), strict=True):
            link.send(position_mm)

    # Beginning things

    def _begin(self, command: canon.LinearMove | canon.MeasuringRun | canon.DriveCommand) -> None:
        if isinstance(command, canon.LinearMove):
            self._begin_move(command)
        elif isinstance(command, canon.MeasuringRun):
            self._begin_run(command)
        else:
            if isinstance(command, canon.DriveWrite):
                self.drive_writes.append((self._clock.now_ns, command))
            self.functions.begin(command)

    def _begin_move(self, command: canon.LinearMove) -> None:
        motion = Motion.RAPID if command.rapid else Motion.FEED
        dynamics = self._path(command.target_acs_mm, motion)
        if dynamics is None:
            return
        feed_mm_s = (
            dynamics.speed_max_mm_s if command.feed_mm_min is None else command.feed_mm_min / 60.0
        )
        self._begin_path(command.target_acs_mm, feed_mm_s, dynamics)

    def _begin_run(self, command: canon.MeasuringRun) -> None:
        place = str(command.block)
        for name in command.measuring_axes:
            if not self.axes[self._index[name]].may_measure:
                raise Alarm(50059, axis=name)
        dynamics = self._path(command.target_acs_mm, Motion.MEASURING)
        if dynamics is None:
            raise Alarm(900103, axes=" ".join(command.programmed_axes))
        ports = [self.links[self._index[name]] for name in command.measuring_axes]
        run = MeasuringRun(ports, place, self._clock.now_ns, self._error_no_signal)
        self._run, self._measuring = run, (command, dynamics)
        self.records.append(run.record)

    def _path(self, target_mm: Mapping[str, float], motion: Motion) -> Dynamics | None:
        """Return the dynamics of the straight path to the target, None when nothing moves."""
        deltas = [
            target_mm.get(axis.name, here) - here
            for axis, here in zip(self.axes, self.interpolator.positions_mm, strict=True)
        ]
        if not any(deltas):
            return None
        return path_dynamics([axis.dynamics[motion] for axis in self.axes], deltas)

    def _begin_path(
        self, target_mm: Mapping[str, float], feed_mm_s: float, dynamics: Dynamics
    ) -> None:
        here = dict(zip(self._index, self.interpolator.positions_mm, strict=True))
        target = {**here, **target_mm}
        if self._run is not None:
            target = self._behind_target(here, target)
        for link in self.links:
            if not link.can_reach(target[link.name]):
                raise Alarm(900012, axis=link.name, target_mm=f"{target[link.name]:.9g}")
        length_mm = dist(tuple(here.values()), tuple(target.values()))
        profile = plan(
            length_mm,
            min(feed_mm_s, dynamics.speed_max_mm_s),
            dynamics.acceleration,
            dynamics.deceleration,
        )
        self._stop_dynamics = dynamics
        self._settling_since_ns = self._inside_since_ns = None
        self.interpolator.start(here, target, profile)

    def _behind_target(
        self, here: Mapping[str, float], target: Mapping[str, float]
    ) -> dict[str, float]:
        """Lengthen a measuring path by the smallest allowed overtravel (P-AXIS-00467)."""
        length_mm = dist(tuple(here.values()), tuple(target.values()))
        extra_mm = min(
            axis.probing_offset_mm * length_mm / abs(target[axis.name] - here[axis.name])
            for axis in self.axes
            if target[axis.name] != here[axis.name]
        )
        scale = 1.0 + extra_mm / length_mm
        return {name: here[name] + (target[name] - here[name]) * scale for name in here}

    # Standing and stopping

    def _has_stopped(self) -> bool:
        """Whether the same set position is sent again and again."""
        return self.interpolator.is_standing and self._buffer.is_settled

    def _is_in_position(self) -> bool:
        """Whether the interpolation stands and every axis is in its exact-stop window.

        They stand when they have been there for SETTLED_CYCLES: an axis that friction has wound up
        runs through its window once. Raises Alarm 70082 when an axis does not get there within its
        settling time.
        """
        if not self._has_stopped():
            self._settling_since_ns = self._inside_since_ns = None
            return False
        now_ns = self._clock.now_ns
        if self._settling_since_ns is None:
            self._settling_since_ns = now_ns
        for axis, link in zip(self.axes, self.links, strict=True):
            lag_mm = link.lag_mm
            if abs(lag_mm) > axis.window_mm:
                waited_ns = now_ns - self._settling_since_ns
                if 0 < axis.settling_ns < waited_ns:
                    raise Alarm(
                        70082,
                        axis=axis.name,
                        lag_mm=f"{lag_mm:.4f}",
                        window_mm=f"{axis.window_mm:.4f}",
                        ms=waited_ns // 1_000_000,
                    )
                self._inside_since_ns = None
                return False
        if self._inside_since_ns is None:
            self._inside_since_ns = now_ns
        return now_ns - self._inside_since_ns >= SETTLED_CYCLES * self.timing.period_ns

    def _come_up(self, alarm: Alarm) -> None:
        """Register an alarm and react: above class 1 the program ends and the axes stop."""
        if self.state is ChannelState.STOPPING:
            return
        if alarm.place is None and self._block is not None:
            alarm.place = str(self._block)
        self._register(alarm)
        if not alarm.ends_program:
            return
        if self._run is not None:
            for name in self._run.record.axes:
                self.links[self._index[name]].disarm()
            self._run = None
        for link in self.links:
            link.hold_back()
            if alarm.id == NOT_FOLLOWING and alarm.values["axis"] == link.name:
                link.quick_stop()
        if not self.interpolator.is_standing and self._stop_dynamics is not None:
            self.interpolator.brake(self._stop_dynamics.stop_deceleration)
        self.state = ChannelState.STOPPING

    def stop(self, alarm: Alarm) -> None:
        """Stop from outside, between two cycles: brake and end, as for an alarm of its own."""
        if not self.has_ended:
            self._come_up(alarm)

    def warn(self, alarm: Alarm) -> None:
        """Note an alarm of class 1 that stood before the program began."""
        self._register(alarm)

    def _register(self, alarm: Alarm) -> None:
        self.alarms.append(alarm)
        self.alarm_ns.append(self._clock.now_ns)
