"""What the channel does about an alarm."""

from collections.abc import Callable, Sequence

from kernel.channel.execution import Execution
from kernel.channel.measurement import Measurement
from kernel.channel.path import Path
from kernel.clock import Clock, TimeNs
from kernel.drives.link import AxisLink
from kernel.errors import Alarm

NOT_FOLLOWING = 900029  # braking the set position would not stop this axis


class Reactions:
    """Registers alarms and reacts: above class 1 the program ends and the axes stop."""

    def __init__(
        self,
        clock: Clock,
        path: Path,
        measurement: Measurement,
        execution: Execution,
        links: Sequence[AxisLink],
    ) -> None:
        self._clock, self._path, self._links = clock, path, tuple(links)
        self._measurement, self._execution = measurement, execution
        self.alarms: list[Alarm] = []
        self.alarm_ns: list[TimeNs] = []
        self.stops: list[Callable[[], None]] = []  # of what moves beside the path

    def register(self, alarm: Alarm) -> None:
        """Note an alarm with its instant."""
        self.alarms.append(alarm)
        self.alarm_ns.append(self._clock.now_ns)

    def come_up(self, alarm: Alarm) -> bool:
        """Register an alarm of the running program and react; return whether the program ends."""
        if alarm.place is None and self._execution.block is not None:
            alarm.place = str(self._execution.block)
        self.register(alarm)
        if not alarm.ends_program:
            return False
        self._measurement.abort()
        for link in self._links:
            link.hold_back()
            if alarm.id == NOT_FOLLOWING and alarm.values["axis"] == link.name:
                link.quick_stop()
        self._path.brake()
        for stop in self.stops:
            stop()
        return True
