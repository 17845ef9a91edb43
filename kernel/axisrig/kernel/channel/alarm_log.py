"""The alarms of a channel: every alarm is registered here, whatever reacts to it."""

from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import Clock, TimeNs

OWNER = "axis "  # before the name where a value may also name the channel


class AlarmLog:
    """Keeps every alarm with its instant, in order.

    alarms: warnings and the one that has ended the program. further: what came up with it and while
    the axes stopped, which changes nothing.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.alarms: list[Alarm] = []
        self.alarm_ns: list[TimeNs] = []
        self.further: list[Alarm] = []
        self.further_ns: list[TimeNs] = []

    def register(self, alarm: Alarm) -> None:
        """Note an alarm with its instant."""
        self.alarms.append(alarm)
        self.alarm_ns.append(self._clock.now_ns)

    def register_further(self, alarm: Alarm) -> None:
        """Note what comes up beside the alarm that stops or after it: each ID once per axis."""
        known = [(a.id, faulty_axes(a)) for a in (*self.alarms, *self.further)]
        if (alarm.id, faulty_axes(alarm)) not in known:
            self.further.append(alarm)
            self.further_ns.append(self._clock.now_ns)


def faulty_axes(alarm: Alarm) -> tuple[str, ...]:
    """Return the axes that an alarm names, be it as owners of what has failed."""
    owner = str(alarm.values.get("owner", ""))
    if owner.startswith(OWNER):
        return (owner.removeprefix(OWNER),)
    return tuple(str(alarm.values.get("axis", "")).split())
