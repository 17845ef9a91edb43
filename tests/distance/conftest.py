"""A distance control without an axis: the tool stands where the offset says."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import pytest

from axisrig.kernel.distance import (
    DistanceCommand,
    DistanceControl,
    DistanceLaw,
    DistanceSettings,
    DistanceState,
    Reading,
    Source,
    StepLimiter,
)
from axisrig.kernel.time.clock import MS

OWNER = "axis Z"
CLAMPED = DistanceLaw(limiter=StepLimiter.CLAMP)
STATE_WAYS: dict[DistanceState, tuple[DistanceCommand, ...]] = {
    DistanceState.INACTIVE: (),
    DistanceState.ACTIVE: (DistanceCommand.ON,),
    DistanceState.FREEZE: (DistanceCommand.ON, DistanceCommand.FREEZE),
    DistanceState.TURNING_OFF: (DistanceCommand.ON, DistanceCommand.OFF),
    DistanceState.ACTIVE_CONST_DIST: (DistanceCommand.ON_CONST_DIST,),
}


@dataclass
class Loop:
    """A control and a tool over a surface; all in mm.

    The tool is where program and offset said `dead_cycles` + 1 cycles ago; with none the error is
    measured as the offset of the cycle before has left it. height_mm: of the surface by the number
    of the cycle. increment_mm: of the sensor, 0 = none. lag: share of its way to there that the
    tool leaves open in each cycle.
    """

    control: DistanceControl
    height_mm: Callable[[int], float] = lambda _cycle: 0.0
    program_mm: float = 0.0
    dead_cycles: int = 0
    lag: float = 0.0
    increment_mm: float = 0.0
    cycle: int = 0
    is_held: bool = False
    override: float = 1.0
    actual_mm: float = 0.0
    sensors_mm: list[float] = field(default_factory=list)
    offsets_mm: list[float] = field(default_factory=list)
    errors_mm: list[float] = field(default_factory=list)
    steps_mm: list[float] = field(default_factory=list)

    def run(self, cycles: int) -> "Loop":
        control = self.control
        for _ in range(cycles):
            sent_mm = self.program_mm + control.offset_mm
            past = self.offsets_mm[: -self.dead_cycles] if self.dead_cycles else self.offsets_mm
            target_mm = self.program_mm + (past[-1] if past else 0.0)
            self.actual_mm += (target_mm - self.actual_mm) * (1 - self.lag)
            sensor_mm = self.height_mm(self.cycle) - self.actual_mm
            if self.increment_mm:
                sensor_mm = round(sensor_mm / self.increment_mm) * self.increment_mm
            self.cycle += 1
            try:
                reading = Reading(
                    sensor_mm, self.actual_mm, sent_mm, self.is_held, override=self.override
                )
                control.step(reading)
            finally:
                self.sensors_mm.append(sensor_mm)
                self.offsets_mm.append(control.offset_mm)
                self.errors_mm.append(control.error_mm)
                self.steps_mm.append(control.step_mm)
        return self

    def say(self, *commands: DistanceCommand, source: Source = Source.NC, **words: bool) -> "Loop":
        for command in commands:
            self.control.command(command, source, **words)
        return self

    def lead_to(self, state: DistanceState) -> "Loop":
        """Bring the control into a state, with both set values and an offset where it has one."""
        self.control.set_surface(-0.002)
        self.control.set_distance(0.002)
        if state is DistanceState.ERROR:
            self.say(DistanceCommand.ON).run(3)
            before, self.height_mm = self.height_mm, lambda _cycle: 100.0
            with pytest.raises(Exception, match="class 7"):
                self.run(1)
            self.height_mm = before
        else:
            for command in STATE_WAYS[state]:
                self.say(command).run(3 if command is not DistanceCommand.OFF else 0)
        assert self.control.state is state
        return self


def wide(**changes: Any) -> DistanceSettings:
    """Settings without a filter, whose limits nothing reaches but what a test changes.

    They clamp: a slope would act on each step that is larger than the error, whatever a_max is.
    """
    wanted: dict[str, Any] = {
        "n_cycles": 0, "v_max_mm_s": 1e6, "a_max_mm_s2": 1e9, "max_deviation_mm": 1e3,
        "max_change_mm_s": 1e6, "min_pos_mm": -50.0, "max_pos_mm": 50.0,
        "law": CLAMPED,
    } | changes  # fmt: skip
    return DistanceSettings().replaced(**wanted)


@pytest.fixture
def make_loop() -> Callable[..., Loop]:
    """Make a loop; changes: of `wide`."""

    def make(
        height_mm: Callable[[int], float] = lambda _cycle: 0.0,
        *,
        program_mm: float = 0.0,
        dead_cycles: int = 0,
        lag: float = 0.0,
        period_ns: int = MS,
        **changes: Any,
    ) -> Loop:
        control = DistanceControl(OWNER, wide(**changes), period_ns)
        return Loop(control, height_mm, program_mm, dead_cycles, lag, actual_mm=program_mm)

    return make
