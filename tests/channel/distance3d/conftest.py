"""3D distance control over ideal axes X Y Z C A, with a model of tool and surface of its own.

The model takes nothing from the kernel: with c and a in degrees the tool points from the TCP to the
clamping point along u = Rz(c) Rx(a) e_z; X Y Z are the pivot of the head, 100 mm + L from the TCP.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.kernel.channel import ChannelSettings
from axisrig.kernel.channel.distance.channel import ChannelDistance
from axisrig.kernel.channel.distance.settings import ChannelDistanceSettings
from axisrig.kernel.distance import (
    DistanceCommand,
    DistanceLaw,
    DistanceSettings,
    Source,
    StepLimiter,
)
from axisrig.kernel.distance.limiter import AxesAllow
from axisrig.kernel.kinematics import HeadCA, Kinematic
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.coordinates import OffsetTables
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.plc.interface import PlcParticipant
from axisrig.kernel.time.clock import MS

NAMES = ("X", "Y", "Z", "C", "A")
HEAD_MM, TOOL_MM = 100.0, 80.0
CLAMPED = DistanceLaw(limiter=StepLimiter.CLAMP)
FLAT = np.array((0.0, 0.0, 1.0))

Vector = Any
Path = Callable[[int], tuple[Sequence[float], float, float]]


def turned(c_deg: float, a_deg: float) -> Vector:
    """u by two rotation matrices."""
    c, a = math.radians(c_deg), math.radians(a_deg)
    about_z = np.array([[math.cos(c), -math.sin(c), 0], [math.sin(c), math.cos(c), 0], [0, 0, 1.0]])
    about_x = np.array([[1.0, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])
    return about_z @ about_x @ np.array((0.0, 0.0, 1.0))


def tcp_of(axes: Sequence[float]) -> Vector:
    return np.array(axes[:3]) - (HEAD_MM + TOOL_MM) * turned(*axes[3:])


def axes_of(tcp: Sequence[float], c_deg: float, a_deg: float) -> tuple[float, ...]:
    pivot = np.array(tcp) + (HEAD_MM + TOOL_MM) * turned(c_deg, a_deg)
    return (*(float(p) for p in pivot), c_deg, a_deg)


@dataclass
class Plane:
    """A plane through a point; height_mm: along its normal from there, by the cycle."""

    normal: Vector = field(default_factory=lambda: FLAT)
    height_mm: Callable[[int], float] = lambda _cycle: 0.0

    def distance_mm(self, axes: Sequence[float], cycle: int) -> float:
        """Orthogonal distance of the clamping point."""
        clamp = np.array(axes[:3]) - HEAD_MM * turned(*axes[3:])
        return float(self.normal @ clamp) - self.height_mm(cycle)


@dataclass
class ToolLoop:
    """A control, axes that are where they were sent one cycle ago, a tool over a plane.

    program: TCP and orientation by the cycle. What each cycle left: offsets_mm, sent.
    """

    control3d: ChannelDistance
    links: list[Any]
    values: dict[str, float]
    plane: Plane
    program: Path
    kinematic: Kinematic | None = None
    sign: int = 1
    cycle: int = 0
    offsets_mm: list[float] = field(default_factory=list)
    sent: list[tuple[float, ...]] = field(default_factory=list)
    tcp_mm: list[Vector] = field(default_factory=list)

    @property
    def control(self) -> Any:
        return self.control3d.control

    def base(self, cycle: int) -> tuple[float, ...]:
        return axes_of(*self.program(cycle))

    def plan(
        self, mode: str | None = None, direction: str | None = None, **more: Any
    ) -> "ToolLoop":
        normal = more.get("normal", (0.0, 0.0, 1.0))
        self.control3d.plan(mode, direction, normal, more.get("origin", (0.0, 0.0, 0.0)))
        return self

    def on(
        self, *, set_pos: float | None = None, set_dist: float | None = None, dry_run: bool = False
    ) -> Any:
        """Switch on as the channel does; returns the warning."""
        if set_pos is not None:
            self.control.set_surface(set_pos)
        if set_dist is not None:
            self.control.set_distance(set_dist)
        wanted = DistanceCommand.ON if set_dist is None else DistanceCommand.ON_CONST_DIST
        warning = self.control3d.prepare(wanted)
        self.control.command(wanted, Source.NC, dry_run=dry_run)
        return warning

    def say(self, command: DistanceCommand, **words: bool) -> "ToolLoop":
        self.control.command(command, Source.NC, **words)
        return self

    def run(self, cycles: int) -> "ToolLoop":
        for _ in range(cycles):
            actual = tuple(link.actual_mm for link in self.links)
            distance_mm = self.plane.distance_mm(actual, self.cycle)
            self.values["SENSOR"] = self.sign * distance_mm * 1e4
            self.control3d.look()
            self.control3d.take()
            try:
                self.control3d.step()
            finally:
                sent = self.control3d.superpose(self.base(self.cycle))
                self.cycle += 1
                for link, position_mm in zip(self.links, sent, strict=True):
                    link.set_mm = link.actual_mm = position_mm
                self.offsets_mm.append(self.control.offset_mm)
                self.sent.append(sent)
                self.tcp_mm.append(tcp_of(sent))
        return self


def wide(**changes: Any) -> DistanceSettings:
    """Settings of a channel without a filter, whose limits only a test reaches.

    They clamp: a slope would act on each step that is larger than the error, whatever a_max is.
    """
    wanted: dict[str, Any] = {
        "n_cycles": 0, "v_max_mm_s": 1e6, "a_max_mm_s2": 1e9, "max_deviation_mm": 1e3,
        "max_change_mm_s": 1e6, "min_pos_mm": -500.0, "max_pos_mm": 500.0, "is_newer": True,
        "sensor_sign": -1, "a_axis_mm_s2": 0.0,
        "law": CLAMPED,
    } | changes  # fmt: skip
    return DistanceSettings().replaced(**wanted)


@dataclass(frozen=True)
class ToolWords:
    """The helpers above, for tests that cannot import them."""

    turned: Callable[[float, float], Vector] = turned
    tcp_of: Callable[[Sequence[float]], Vector] = tcp_of
    axes_of: Callable[..., tuple[float, ...]] = axes_of
    plane: type[Plane] = Plane
    wide: Callable[..., DistanceSettings] = wide
    head_mm: float = HEAD_MM
    tool_mm: float = TOOL_MM
    names: tuple[str, ...] = NAMES


@pytest.fixture
def tool() -> ToolWords:
    return ToolWords()


@pytest.fixture
def make_tool_loop() -> Callable[..., ToolLoop]:
    """Make a loop; changes: of `wide`."""

    def make(
        program: Path = lambda _cycle: ((0.0, 0.0, 0.0), 0.0, 0.0),
        plane: Plane | None = None,
        *,
        kinematic: Kinematic | str | None = "head",
        limits: Sequence[AxesAllow] | None = None,
        is_optimized: bool = True,
        checks_limits: bool = False,
        ref_offset_mm: float = 0.0,
        sign: int = 1,
        refreshed: Mapping[str, Any] | None = None,
        **changes: Any,
    ) -> ToolLoop:
        head = HeadCA((HEAD_MM,), TOOL_MM) if kinematic == "head" else kinematic
        assert not isinstance(head, str)
        values: dict[str, float] = {"SENSOR": 0.0}
        start = axes_of(*program(0))
        of_drive = SimpleNamespace(increments_per_mm=1e6)
        links: list[Any] = [
            SimpleNamespace(name=n, actual_mm=p, set_mm=p, settings=of_drive)
            for n, p in zip(NAMES, start, strict=True)
        ]
        settings = ChannelDistanceSettings(
            wide(**changes), ref_offset_mm, is_optimized, checks_limits
        )
        loop: ToolLoop
        control3d = ChannelDistance(
            settings,
            limits or [AxesAllow()] * len(NAMES),
            links,
            lambda: loop.kinematic,
            values,
            refreshed or {},
            MS,
        )
        loop = ToolLoop(control3d, links, values, plane or Plane(), program, head, sign)
        control3d.choose("VARIABLE", "SENSOR")
        return loop

    return make


@dataclass
class Head:
    """A channel with the axes X Y Z C A over a plane; `acts` run in turns of the PLC side.

    What each cycle of the program left: offset_mm, sent by axis, state.
    """

    bench: Any
    offset_mm: list[float] = field(default_factory=list)
    sent: dict[str, list[float]] = field(default_factory=dict)
    interpolated: dict[str, list[float]] = field(default_factory=dict)
    state: list[Any] = field(default_factory=list)

    @property
    def channel(self) -> Any:
        return self.bench.channel

    @property
    def control3d(self) -> Any:
        return self.channel.distance.channel

    @property
    def alarm_ids(self) -> list[int]:
        return list(self.bench.alarm_ids)

    def at(self, acts: Mapping[int, Callable[[], None]]) -> None:
        """Do things so many cycles after the start of the program."""
        channel = self.channel

        def turn() -> None:
            cycle = (channel._clock.now_ns - channel.start_ns) // MS
            acts.get(cycle, lambda: None)()

        channel.plc.join(PlcParticipant(turn))

    def run(self, text: str, *before: canon.Command) -> "Head":
        """Run a program to its end, `V.E.SENSOR` in it; before: commands that precede it."""
        channel = self.channel
        program = parse_program(f"%t\n{text}\nM30\n", file="test.nc", axes=NAMES)
        tables = OffsetTables(rotary=frozenset({"C", "A"}))
        interpreter = Interpreter(
            program, NAMES, channel, external=channel.plc.values, tables=tables
        )
        self.bench.run(chain(before, interpreter.commands()))
        return self

    def watch(self, channel: Any) -> None:
        if channel.start_ns is None:
            return
        control3d = channel.distance.channel
        self.offset_mm.append(control3d.control.offset_mm)
        self.state.append(control3d.control.state)
        for link in channel.links:
            self.sent.setdefault(link.name, []).append(link.set_mm)
            at_mm = channel.path.position_acs_mm(link.name)
            self.interpolated.setdefault(link.name, []).append(at_mm)


@pytest.fixture
def make_head(channel_bench: Callable[..., Any], words: Any) -> Callable[..., Head]:
    """Make a channel whose head is 180 mm long; height_mm: of the plane, by ms of the program.

    more: further axes, which no program names.
    """

    def make(
        height_mm: Callable[[float], float] = lambda _ms: 0.0,
        *,
        is_licensed: bool = True,
        is_optimized: bool = True,
        checks_limits: bool = False,
        spec: Mapping[str, Mapping[str, Any]] | None = None,
        options: Mapping[str, Any] | None = None,
        more: Sequence[Any] = (),
        **changes: Any,
    ) -> Head:
        wanted = {"kp": 0.5, "max_change_mm_s": 1e6} | changes
        settings = ChannelDistanceSettings(
            wide(**wanted), 0.0, is_optimized, checks_limits, is_licensed
        )
        starts = axes_of((0.0, 0.0, 0.0), 0.0, 0.0)
        quick = {"kv": 1e9, "a_mm_s2": 1e5, "speed_max_mm_s": 2e3}
        axes = [
            words.axis(n, **{"start_mm": at} | quick | dict((spec or {}).get(n, {})))
            for n, at in zip(NAMES, starts, strict=True)
        ]
        # Five drives do not fit on one segment of 1 Mbit/s
        of_bus = {"bitrate": 5_000_000} | dict(options or {})
        bench = channel_bench(*axes, *more, settings=ChannelSettings(distance=settings), **of_bus)
        channel, made = bench.channel, Head(bench)
        values = channel.plc.values
        values["SENSOR"] = 0.0

        def read() -> None:
            actual = [link.actual_mm for link in channel.links[: len(NAMES)]]
            ms = (channel._clock.now_ns - channel.start_ns) / MS
            plane = Plane(height_mm=lambda _k: height_mm(ms))
            values["SENSOR"] = plane.distance_mm(actual, 0) * 1e4

        channel.plc.inputs.append(read)
        channel.observers.append(made.watch)
        return made

    return make
