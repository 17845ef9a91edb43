"""Values that the PLC side leads evenly over a time: a new one in every NC cycle."""

from collections import Counter
from collections.abc import Callable, Hashable

from axisrig.kernel.time.clock import Clock, TimeNs

At = Callable[[TimeNs, Callable[[], None]], None]


class Courses:
    """Leads values; at: lets something be done in the first turn at or after an instant."""

    def __init__(self, clock: Clock, period_ns: TimeNs, at: At) -> None:
        self._clock, self._period_ns, self._at = clock, period_ns, at
        self._latest: Counter[Hashable] = Counter()

    def lead(
        self,
        key: Hashable,
        begin: float | None,
        to: float,
        over_ns: TimeNs,
        put: Callable[[float], None],
        done: Callable[[], None],
    ) -> None:
        """Lead a value from where it is; a later course of the same key ends this one.

        begin: None while there is no value, which is then there at once. done: called when it has
        arrived.
        """
        self._latest[key] += 1
        number, begin_ns = self._latest[key], self._clock.now_ns

        def go_on() -> None:
            if self._latest[key] != number:
                done()
                return
            passed_ns = self._clock.now_ns - begin_ns
            if begin is None or passed_ns >= over_ns:
                put(to)
                done()
            else:
                put(begin + (to - begin) * passed_ns / over_ns)
                self._at(self._clock.now_ns + self._period_ns, go_on)

        go_on()
