"""A channel whose axis Z follows a surface; the surface is a function of time.

Z is a position loop of first order that is as good as ideal: at the end of a cycle it stands where
its demand ramp ends. The second encoder tells height - position, so that the sensor value is 0
where the tool touches the surface and falls when the tool lifts (FCT-M3 5).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import pytest

from axisrig.kernel.channel.distance.sensor import SensorSettings
from axisrig.kernel.channel.distance.settings import AxisDistanceSettings
from axisrig.kernel.distance import DistanceSettings, DistanceState
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.plc.interface import PlcParticipant
from axisrig.kernel.time.clock import MS, US

OFFSET_NS = 620 * US
IDEAL_KV = 1e9
START_MM = 10.0
PER_MM = 2**20 / 10
# 2^20 increments of the drive are 10 mm
SENSOR = SensorSettings(numerator=2**20, denominator=100_000)


@dataclass
class Seen:
    """What each cycle left behind, from the first one of the program on."""

    time_ns: list[int] = field(default_factory=list)
    offset_mm: list[float] = field(default_factory=list)
    sent_mm: list[float] = field(default_factory=list)
    interpolated_mm: list[float] = field(default_factory=list)
    actual_mm: list[float] = field(default_factory=list)
    sensor_mm: list[float | None] = field(default_factory=list)
    state: list[DistanceState] = field(default_factory=list)

    def cycle_at(self, time_ns: int) -> int:
        """The first cycle whose SYNC is behind an instant."""
        return next(k for k, at_ns in enumerate(self.time_ns) if at_ns - OFFSET_NS > time_ns)

    def states(self) -> list[DistanceState]:
        """The states, each once as long as it lasts."""
        return [s for k, s in enumerate(self.state) if not k or s is not self.state[k - 1]]


@dataclass
class DistanceBench:
    """A bench and what it saw; `at` runs something in the turn of the PLC side."""

    bench: Any
    seen: Seen
    axis: str

    @property
    def channel(self) -> Any:
        return self.bench.channel

    @property
    def control(self) -> Any:
        return self.channel.distance.control(self.axis)

    @property
    def alarm_ids(self) -> list[int]:
        return list(self.bench.alarm_ids)

    def run(self, *commands: canon.Command) -> "DistanceBench":
        self.bench.run([*commands, canon.EndOfProgram(Block(99, 990, "N990"))])
        return self

    def at(self, acts: Mapping[int, Callable[[], None]]) -> None:
        """Do things so many cycles behind the start of the program."""
        channel = self.channel

        def turn() -> None:
            cycle = (channel._clock.now_ns - channel.start_ns) // MS
            acts.get(cycle, lambda: None)()

        channel.plc.join(PlcParticipant(turn))


def command(action: str | None = None, axis: str = "Z", **words: Any) -> canon.DistanceCommand:
    block = Block(1, 10, "N10")
    wanted: dict[str, Any] = {
        "action": action, "wait": False, "no_move": False, "dry_run": False, "set_pos_mm": None,
        "set_dist_mm": None, "parameters": {}, "sensor_source": None, "sensor_variable": None,
        "values": (),
    } | words  # fmt: skip
    return canon.DistanceCommand(block=block, axis=axis, **wanted)


def dwell(ms: int) -> canon.Dwell:
    return canon.Dwell(Block(2, 20, "N20"), ms * MS)


@dataclass(frozen=True)
class DistanceWords:
    """The helpers above, for tests that cannot import them."""

    command: Callable[..., canon.DistanceCommand] = command
    dwell: Callable[[int], canon.Dwell] = dwell
    per_mm: float = PER_MM
    start_mm: float = START_MM


@pytest.fixture
def say() -> DistanceWords:
    return DistanceWords()


def settings(
    *, is_optimized: bool, checks_limits: bool = False, sensor: SensorSettings, **changes: Any
) -> AxisDistanceSettings:
    """Distance control without a filter and almost without limits, but for what a test changes."""
    wanted: dict[str, Any] = {
        "kp": 0.5, "v_max_mm_s": 1e4, "a_max_mm_s2": 1e9, "max_deviation_mm": 50.0,
        "max_change_mm_s": 1e9, "min_pos_mm": -1e3, "max_pos_mm": 1e3,
        "filter_type": "MOVING_AVERAGE", "n_cycles": 1,
    } | changes  # fmt: skip
    control = DistanceSettings().replaced(**wanted)
    return AxisDistanceSettings(control, sensor, is_optimized, checks_limits)


@pytest.fixture
def distance_bench(channel_bench: Callable[..., Any], words: Any) -> Callable[..., DistanceBench]:
    """Make a bench with Z; height_mm: of the surface by the time. more: further axes."""

    def make(
        height_mm: Callable[[int], float] = lambda _time_ns: 0.0,
        *,
        more: tuple[Any, ...] = (),
        spec: Mapping[str, Any] | None = None,
        is_optimized: bool = True,
        sensor: SensorSettings = SENSOR,
        options: Mapping[str, Any] | None = None,
        **changes: Any,
    ) -> DistanceBench:
        distance = settings(is_optimized=is_optimized, sensor=sensor, **changes)
        z_spec = {"start_mm": START_MM, "kv": IDEAL_KV, "distance": distance,
                  "height_mm": height_mm} | dict(spec or {})  # fmt: skip
        bench = channel_bench(*more, words.axis("Z", **z_spec), **(options or {}))
        seen, z = Seen(), bench.links[-1]

        def observe(channel: Any) -> None:
            if channel.start_ns is None or "Z" not in channel.distance.axes:
                return
            axis = channel.distance.axes["Z"]
            seen.time_ns.append(channel._clock.now_ns)
            seen.offset_mm.append(axis.control.offset_mm)
            seen.sent_mm.append(z.set_mm)
            seen.interpolated_mm.append(channel.path.position_acs_mm("Z"))
            seen.actual_mm.append(z.actual_mm)
            seen.sensor_mm.append(axis.sensor_mm)
            seen.state.append(axis.control.state)

        bench.channel.observers.append(observe)
        return DistanceBench(bench, seen, "Z")

    return make
