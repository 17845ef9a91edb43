"""The plants at the end of a cycle: stepped to its SYNC, and at rest after an alarm."""

from typing import Final

from axisrig.kernel.cosim.plant.outputs import MOTOR_VELOCITY
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import MS, Clock, TimeNs

REST_M_S: Final = 0.1e-3
"""Below it an axis counts as at rest; the load of a stiff axis creeps slower through friction."""
REST_NS: Final = 20 * MS
"""How long every axis must be that slow."""
REST_NS_MAX: Final = 500 * MS
"""An axis without a drive may coast or fall; a run does not wait longer for it."""


class PlantMechanics:
    """The plants of a run as its channel sees them (`kernel.channel.surroundings`).

    waits: whether the run goes on after an alarm until the axes are at rest. They do when every
    motor has been slower than REST_M_S for REST_NS, or REST_NS_MAX after the first question.
    after_end_ns: for how long the run goes on after any end, at least.
    """

    def __init__(
        self, clock: Clock, plant: Plant, *, waits: bool, after_end_ns: TimeNs = 0
    ) -> None:
        self._clock, self._plant, self._waits = clock, plant, waits
        self.goes_on, self._after_end_ns = after_end_ns > 0, after_end_ns
        self._since_ns: TimeNs | None = None
        self._slow_since_ns: TimeNs | None = None

    def advance_to(self, sync_ns: TimeNs) -> None:
        """Step the plants to the SYNC, unless a drive has done so.

        Where no drive has received the SYNC, the instant of its request takes its place: the plants
        go on all the same.
        """
        if self._plant.axes:
            self._plant.advance_to(sync_ns)

    def has_come_to_rest(self) -> bool:
        """Look at the motors as they are now, and at the time that the run is to go on."""
        now_ns = self._clock.now_ns
        if self._since_ns is None:
            self._since_ns = now_ns
        is_over = now_ns - self._since_ns >= self._after_end_ns
        if not self._waits:
            return is_over
        if any(abs(axis.motion[MOTOR_VELOCITY]) > REST_M_S for axis in self._plant.axes.values()):
            self._slow_since_ns = None
        elif self._slow_since_ns is None:
            self._slow_since_ns = now_ns
        is_slow = self._slow_since_ns is not None and now_ns - self._slow_since_ns >= REST_NS
        return is_over and (is_slow or now_ns - self._since_ns >= REST_NS_MAX)
