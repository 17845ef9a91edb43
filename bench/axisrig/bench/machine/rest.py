"""When a simulated machine has come to rest after an alarm: how long its run goes on."""

from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import MS, Clock, TimeNs

REST_M_S = 0.1e-3
"""Below it an axis counts as standing; the load of a stiff axis creeps slower behind friction."""
REST_NS = 20 * MS
"""How long every axis must be that slow."""
REST_NS_MAX = 500 * MS
"""An axis without a drive may coast or fall; a run does not wait longer for it."""


class Rest:
    """Tells, asked in each cycle from the end of the program on, whether the run may end.

    True when every motor has been slower than REST_M_S for REST_NS, or REST_NS_MAX after the first
    question.
    """

    def __init__(self, clock: Clock, plant: Plant) -> None:
        self._clock, self._plant = clock, plant
        self._since_ns: TimeNs | None = None
        self._slow_since_ns: TimeNs | None = None

    def __call__(self) -> bool:
        """Look at the motors as they are now."""
        now_ns = self._clock.now_ns
        if self._since_ns is None:
            self._since_ns = now_ns
        if any(abs(axis.motion[3]) > REST_M_S for axis in self._plant.axes.values()):
            self._slow_since_ns = None
        elif self._slow_since_ns is None:
            self._slow_since_ns = now_ns
        is_slow = self._slow_since_ns is not None and now_ns - self._slow_since_ns >= REST_NS
        return is_slow or now_ns - self._since_ns >= REST_NS_MAX
