"""An axis whose FMU takes steps of one length only."""

from collections import deque
from collections.abc import Callable

from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.curves import hermite
from axisrig.kernel.cosim.plant.outputs import (
    DEMAND_POSITION,
    FORCE,
    MOTOR_POSITION,
    POSITION,
    VELOCITY,
)
from axisrig.kernel.time.clock import TimeNs


class GridAxis(PlantAxis):
    """An axis on the grid of its FMU, which goes ahead to the next point of it.

    Between two points the motion is a cubic Hermite polynomial through them, a force a straight
    line. A new demand acts from the next point on, as in a drive that works in such steps.
    """

    def __init__(
        self,
        roles: Roles,
        advance_to: Callable[[TimeNs], None],
        second_encoder: Callable[[], float] | None = None,
    ) -> None:
        super().__init__(roles, advance_to, None, second_encoder)
        self._points: deque[tuple[TimeNs, list[float]]] = deque(maxlen=3)
        self._saved_points: list[tuple[TimeNs, list[float]]] = []

    def start(self, start_ns: TimeNs) -> None:
        """Initialise the FMU."""
        super().start(start_ns)
        self._points.append((start_ns, self.motion))

    def step_to(self, end_ns: TimeNs) -> None:
        """Go to `end_ns`, with the FMU at the next point of its grid or at `end_ns` itself."""
        begin = self.motion
        grid_ns = self.slave.grid_ns
        assert grid_ns is not None
        while self.slave.time_ns < end_ns:
            self._demand.step(self.slave, self.slave.time_ns + grid_ns)
            self._points.append((self.slave.time_ns, self._read()))
        end = self._between(end_ns)
        self._remember(end_ns, end)
        self.tick = (begin[POSITION], begin[VELOCITY], end[POSITION], end[VELOCITY])

    def _between(self, time_ns: TimeNs) -> list[float]:
        (begin_ns, begin), (end_ns, end) = list(self._points)[-2:]
        if time_ns == end_ns:
            return [*end[:DEMAND_POSITION], self._demand_of(end, time_ns), *end[FORCE:]]
        time_s, step_s = (time_ns - begin_ns) * 1e-9, (end_ns - begin_ns) * 1e-9
        motion: list[float] = []
        for place in (POSITION, MOTOR_POSITION):
            ends = (begin[place], begin[place + 1], end[place], end[place + 1])
            motion += (hermite(time_s, step_s, ends), _rate(time_s, step_s, ends))
        share = time_s / step_s
        values = [
            (1 - share) * first + share * last for first, last in zip(begin, end, strict=True)
        ]
        return [*motion, self._demand_of(values, time_ns), *values[FORCE:]]

    def _demand_of(self, motion: list[float], time_ns: TimeNs) -> float:
        return (
            motion[DEMAND_POSITION]
            if self.roles.has("demand_position")
            else self._demand_at(time_ns)
        )

    def save(self) -> None:
        """Keep the present state for `restore`."""
        super().save()
        self._saved_points = list(self._points)

    def restore(self) -> None:
        """Go back to where `save` was called last."""
        super().restore()
        self._points.clear()
        self._points.extend(self._saved_points)


def _rate(time_s: float, step_s: float, ends: tuple[float, float, float, float]) -> float:
    """Evaluate the slope of the cubic Hermite polynomial that `hermite` evaluates."""
    x0, v0, x1, v1 = ends
    u = time_s / step_s
    w = 1.0 - u
    return 6.0 * u * w * (x1 - x0) / step_s + w * (w - 2.0 * u) * v0 + u * (u - 2.0 * w) * v1
