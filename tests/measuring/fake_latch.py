"""A latch whose bits are set by hand, and a measurement run that is led cycle by cycle."""

from dataclasses import dataclass, field

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.measuring.run import (
    MeasuringRun,
    Order,
    RunState,
)

MS = 1_000_000


@dataclass
class FakeLatch:
    """A latch whose status bits are set by hand; it notes every order it gets."""

    name: str = "Z"
    is_clear: bool = True
    is_armed: bool = False
    has_latched: bool = False
    latched_mm: float | None = None
    latched_speed_mm: float = 0.0
    is_actuated: bool | None = None
    is_prepared: bool = True
    confirms: bool = True
    arrival: Arrival = field(default_factory=Arrival)
    doubt_mm: float | None = None
    orders: list[str] = field(default_factory=list)

    def arm(self) -> None:
        self.orders.append("arm")

    def disarm(self) -> None:
        self.orders.append("disarm")

    def is_confirmed(self) -> bool:
        return self.confirms

    def latch(self, value_mm: float | None) -> None:
        self.has_latched, self.latched_mm = True, value_mm


class Stage:
    """A run with its latches and the cycles it has seen; cycle k and its SYNC are at k ms."""

    def __init__(self, *ports: FakeLatch, error_no_signal: bool = False) -> None:
        self.ports = ports
        self.orders: list[Order] = []
        self.run = MeasuringRun(ports, "block N20", 0, error_no_signal)
        self.rest_ns: int | None = None

    @property
    def now_ns(self) -> int:
        return (len(self.orders) + 1) * MS

    def cycle(self, standing: bool = False, resting: bool | None = None) -> RunState:
        """Standing axes rest, unless `resting` is False: they creep inside their windows."""
        is_resting = standing if resting is None else resting
        has_moved = self.run.state in (RunState.MOVING, RunState.COLLECTING)
        if is_resting and self.rest_ns is None and has_moved:
            self.rest_ns = self.now_ns
        self.orders.append(self.run.evaluate(self.now_ns, standing, self.rest_ns))
        return self.run.state

    def cycles(self, count: int, standing: bool = False, resting: bool | None = None) -> None:
        for _ in range(count):
            self.cycle(standing, resting)

    def move(self) -> "Stage":
        """Go through the handshake with drives that answer at once."""
        self.cycle(standing=True)
        for port in self.ports:
            port.is_armed = True
        self.cycle(standing=True)
        assert self.run.state is RunState.MOVING
        return self


def next_alarm(stage: Stage, cycles: int, standing: bool = False) -> tuple[Alarm, int]:
    """The alarm that comes up within `cycles`, and in which of them."""
    for number in range(1, cycles + 1):
        try:
            stage.cycle(standing)
        except Alarm as alarm:
            return alarm, number
    raise AssertionError(f"no alarm within {cycles} cycles")
