"""Where a program waits without moving: dwell time, programmed stop."""

from collections.abc import Callable

from axisrig.kernel.channel.path.execution import Execution
from axisrig.kernel.channel.path.settings import ChannelSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcAction, PlcEvent
from axisrig.kernel.time.clock import Clock, TimeNs


class Pauses:
    """Carries out dwell times and stops.

    is_in_position: exact stop of all axes. events: takes every stop with its new start.
    settings: of the channel; they say what the operator does.
    """

    def __init__(
        self,
        clock: Clock,
        period_ns: TimeNs,
        is_in_position: Callable[[], bool],
        events: list[PlcEvent],
        settings: ChannelSettings,
    ) -> None:
        self._clock, self._period_ns, self._events = clock, period_ns, events
        self._settings = settings
        self._is_in_position = is_in_position
        self._until_ns: TimeNs = 0

    def assign(self, execution: Execution) -> None:
        """Say which commands are carried out here."""
        execution.while_busy(lambda: self._clock.now_ns < self._until_ns)
        execution.register(canon.Dwell, self._dwell)
        execution.register(canon.ExactStop, _go_on, ready=self._is_in_position)
        execution.register(canon.ProgramStop, self._stop, ready=self._is_in_position)

    def _dwell(self, command: canon.Dwell) -> None:
        """Wait whole cycles, no less than the time: n = ceil(duration / cycle).

        The next block begins n cycles after the one in which the dwell time has begun.
        """
        cycles = -(-command.duration_ns // self._period_ns)
        self._until_ns = self._clock.now_ns + cycles * self._period_ns

    def _stop(self, command: canon.ProgramStop) -> None:
        """Wait for the operator's start, a cycle at least.

        Raises Alarm 900170 when nobody will start.
        """
        if command.optional and not self._settings.optional_stop:
            return
        start_after_ns = self._settings.start_after_ns
        if start_after_ns is None:
            raise Alarm(900170, word="M1" if command.optional else "M0")
        now_ns = self._clock.now_ns
        cycles = max(1, -(-start_after_ns // self._period_ns))
        self._until_ns = now_ns + cycles * self._period_ns
        self._events += (PlcEvent(now_ns, command), PlcEvent(self._until_ns, command, True))

    def reset(self) -> None:
        """Wait no more; the operator does not start again what a reset has ended."""
        now_ns = self._clock.now_ns
        self._until_ns = 0
        for at, event in enumerate(self._events):
            if event.starts_again and event.time_ns > now_ns:
                ended = PlcAction("stop of the program: ended by the reset", _place(event))
                self._events[at] = PlcEvent(now_ns, ended)


def _place(event: PlcEvent) -> str:
    assert isinstance(event.command, canon.ProgramStop)
    return event.command.block.place


def _go_on(_command: canon.ExactStop) -> None:
    """Nothing to do: the axes are there."""
