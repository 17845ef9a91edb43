"""The measurement run of the channel: begins it, leads its path, keeps what it brought."""

from collections.abc import Mapping

from kernel.channel.path import Path
from kernel.clock import Clock
from kernel.drives.link import AxisLink
from kernel.errors import Alarm
from kernel.measuring.run import MeasuringRun, Order, RunRecord, RunState
from kernel.motion.dynamics import Dynamics, Motion
from kernel.nc import canon

ONE_AXIS = 2  # measuring type


class Measurement:
    """Runs one measurement on the path at a time.

    links: by axis. error_no_signal: P-CHAN-00176. records: every run of the program, in order.
    """

    def __init__(
        self, clock: Clock, path: Path, links: Mapping[str, AxisLink], *, error_no_signal: bool
    ) -> None:
        self._clock, self._path, self._links = clock, path, links
        self._error_no_signal = error_no_signal
        self._run: MeasuringRun | None = None
        self._order: tuple[canon.MeasuringRun, Dynamics] | None = None
        self._measured: dict[str, float | None] = {}
        self.records: list[RunRecord] = []

    @property
    def is_active(self) -> bool:
        """Whether a run is under way."""
        return self._run is not None

    def measured_acs_mm(self, axis: str) -> float | None:
        """Return the measured position of the axis' last run, None without a valid one."""
        return self._measured.get(axis)

    def begin(self, command: canon.MeasuringRun) -> None:
        """Begin a run; raises Alarm 50059, 900103 and those of the run itself."""
        for name in command.measuring_axes:
            if not self._path.settings(name).may_measure:
                raise Alarm(50059, axis=name)
        dynamics = self._path.dynamics(command.target_acs_mm, Motion.MEASURING)
        if dynamics is None:
            raise Alarm(900103, axes=" ".join(command.programmed_axes))
        ports = [self._links[name] for name in command.measuring_axes]
        run = MeasuringRun(ports, str(command.block), self._clock.now_ns, self._error_no_signal)
        self._run, self._order = run, (command, dynamics)
        self.records.append(run.record)

    def begin_beside(self, command: canon.IndependentMove) -> MeasuringRun:
        """Make the run of an independent axis, which evaluates it and gives it back to `keep`.

        Type 2 always wants a signal (FCT-C4 section 3). Raises Alarm 50052.
        """
        wants_signal = self._error_no_signal or command.measuring_type == ONE_AXIS
        link, place = self._links[command.axis], str(command.block)
        run = MeasuringRun([link], place, self._clock.now_ns, wants_signal)
        self.records.append(run.record)
        return run

    def keep(self, record: RunRecord) -> None:
        """Keep what a run brought."""
        self._measured.update({axis: record.latched_mm.get(axis) for axis in record.axes})

    def step(self) -> None:
        """Evaluate the run with this cycle's values and lead the path by what it orders."""
        if self._run is None:
            return
        assert self._order is not None
        command, dynamics = self._order
        order = self._run.evaluate(self._clock.now_ns, self._path.is_in_position())
        if order is Order.START:
            feed_mm_s = command.feed_mm_min / 60.0
            self._path.begin(command.target_acs_mm, feed_mm_s, dynamics, is_measuring=True)
        elif order is Order.BRAKE:
            self._path.brake()
        if self._run.state is RunState.DONE:
            self.keep(self._run.record)
            self._run = self._order = None

    def abort(self) -> None:
        """End a run without a result: its probes are switched off."""
        if self._run is None:
            return
        for name in self._run.record.axes:
            self._links[name].disarm()
        self._run = self._order = None
