"""Random programs on random axes without drives: what goes into the set point buffer.

Text of programs is decoded and carried out by the path of a channel and its independent axes, cycle
by cycle, under random overrides and feedholds; the guard of the path judges every set position.
`python -m tests.channel.random_programs 10000` runs so many and prints those that pass a limit.
"""

import math
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from random import Random
from types import SimpleNamespace
from typing import Any

from tests.override_courses import between, course

from axisrig.kernel.channel.axes.independent import IndependentAxes
from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import AxisSettings, ChannelSettings, CycleTiming
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.coordinates import OffsetTables
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.time.clock import MS

LED_CYCLES, CYCLES_MAX = 400, 1200
INCREMENTS_PER_MM = 2**20 / 10
STRAIGHT, HEAD = ("X", "Y", "Z", "U"), ("X", "Y", "Z", "C", "A", "U")
STEPS = (
    *("a_grenz_stufe_1", "a_grenz_stufe_2", "a_stufe_1", "a_stufe_2", "a_feedh"),
    *("d_grenz_stufe_1", "d_grenz_stufe_2", "d_stufe_1", "d_stufe_2"),
)
TIMES = ("tr_grenz", "tr_beschl_zu", "tr_beschl_ab", "tr_brems_zu", "tr_brems_ab", "tr_feedh")


class IdealLink:
    """A drive that is where it is sent."""

    def __init__(self, name: str, at_mm: float) -> None:
        self.name, self.set_mm, self.lag_mm = name, at_mm, 0.0
        self.settings = SimpleNamespace(increments_per_mm=INCREMENTS_PER_MM)

    @property
    def actual_mm(self) -> float:
        return self.set_mm

    def can_reach(self, position_mm: float) -> bool:
        return abs(position_mm) < 1e5

    def send(self, position_mm: float) -> None:
        self.set_mm = position_mm


def axis_list(rng: Random) -> ParameterSet:
    """Give a list with limits of its own: um/s, mm/s2, us."""
    found = ParameterSet("axis")
    fastest = int(between(rng, 30e3, 600e3))
    a = {f"lslope_profil.{name}": int(between(rng, 200, 5000)) for name in STEPS}
    limited = {
        f"slope_profil.{name}": int(between(rng, 200, 5000))
        for name in ("a_grenz", "a_beschl", "a_brems", "a_feedh")
    }
    times = {
        f"slope_profil.{name}": rng.choice([2000, 10_000, 50_000, rng.randint(1000, 90_000)])
        for name in TIMES
    }
    values = a | limited | times
    values["dynamik.vb_max"] = fastest
    values["vb_eilgang"] = int(fastest * rng.choice([1.0, rng.uniform(0.5, 1.0)]))
    values["lslope_profil.vb_grenz_stufe_1_2"] = rng.randint(5000, 200_000)
    values["lslope_profil.vb_stufe_1_2"] = rng.randint(5000, 200_000)
    if rng.random() < 0.5:
        values["dynamik.a_emergency"] = int(between(rng, 200, 5000))
    if rng.random() < 0.3:
        values["dynamik.a_max"] = int(between(rng, 1000, 6000))
    for name, value in values.items():
        found.set(f"getriebe[0].{name}", str(value), "random")
    return found


def channel_list(rng: Random) -> ParameterSet:
    found = ParameterSet("channel")
    values = {
        "use_drive_curr_limit": rng.randint(0, 1),
        "max_vb_override": rng.choice([1000, 1000, 1500, 2000]),
        "prog_start.slope.profile": rng.randint(0, 2),
        "prog_start.slope.mode_ramp_time": rng.randint(0, 1),
        "prog_start.slope.acceleration": rng.randint(0, 2),
        "prog_start.slope.ramp_time": rng.randint(0, 4),
    }
    for name, value in values.items():
        found.set(name, str(value), "random")
    return found


class Writer:
    """Writes the blocks of a program; at: where its coordinates are."""

    def __init__(self, rng: Random, *, has_head: bool) -> None:
        self._rng, self._has_head = rng, has_head
        self.at = {"X": 0.0, "Y": 0.0}
        self._a_deg = 0.0

    def text(self) -> str:
        lines = []
        if self._has_head:
            steps = "[9, 98]" if self._rng.random() < 0.7 else "[9]"
            hd = 0, *sorted(self._rng.sample(range(10, 80), 2)), 91
            lines += [f"V.G.KIN_STEP[1].ID[98].PARAM[{n}] = {v}0000" for n, v in enumerate(hd)]
            lines += ["V.G.WZ_AKT.L = 80", f"#TRAFO {steps}", "G1 F3000 X0 Y0 Z0 C0 A0"]
        kinds: list[Callable[[], str]] = [self._straight, self._arc, self._arc, self._choice]
        lines += [self._rng.choice(kinds)() for _ in range(self._rng.randint(2, 5))]
        return "\n".join([*lines, "M30"])

    def _feed(self) -> str:
        return f"F{between(self._rng, 1000.0, 40_000.0):.0f}"

    def _turn(self) -> str:
        if not self._has_head or self._rng.random() < 0.3:
            return ""
        self._a_deg = self._rng.choice([0.0, self._rng.uniform(-85.0, 85.0)])
        return f" A{self._a_deg:.3f} C{self._rng.uniform(-90.0, 90.0):.3f}"

    def _straight(self) -> str:
        rng, way = self._rng, between(self._rng, 0.01, 20.0)
        word = rng.choice(["G0", "G1", "G1"])
        for axis in rng.sample(["X", "Y"], rng.randint(1, 2)):
            self.at[axis] = round(self.at[axis] + rng.uniform(-way, way), 4)
        z = f" Z{rng.uniform(-way, way):.4f}" if rng.random() < 0.5 else ""
        x, y = self.at["X"], self.at["Y"]
        return f"{word} {self._feed()} X{x} Y{y}{z}{self._turn()}"

    def _arc(self) -> str:
        """An arc in G17 about a centre I J, maybe with a height."""
        rng = self._rng
        radius, from_rad = between(rng, 0.1, 15.0), rng.uniform(0.0, math.tau)
        angle, sign = rng.uniform(0.1, math.tau - 0.1), rng.choice([1, -1])
        i, j = -radius * math.cos(from_rad), -radius * math.sin(from_rad)
        end_rad = from_rad + sign * angle
        self.at["X"] += i + radius * math.cos(end_rad)
        self.at["Y"] += j + radius * math.sin(end_rad)
        z = f" Z{rng.uniform(-20.0, 20.0):.4f}" if rng.random() < 0.4 else ""
        word, x, y = "G3" if sign > 0 else "G2", self.at["X"], self.at["Y"]
        place = f"X{x:.9f} Y{y:.9f}{z}{self._turn()} I{i:.9f} J{j:.9f}"
        return f"G17 {word} {self._feed()} {place}"

    def _choice(self) -> str:
        rng = self._rng
        kind = rng.choice(["STEP", "TRAPEZ", "SIN2"])
        beside = f"U[INDP_ASYN G90 POS={rng.uniform(-10, 10):.3f} FEED={rng.randint(600, 20000)}"
        choices = [
            f"#SLOPE [TYPE={kind}]",
            f"G131 = {rng.randint(20, 200)}",
            f"G133 = {rng.randint(20, 300)}",
            f"{beside} SLOPE_TYPE={kind}]",
            f"{beside} SLOPE_TYPE={kind}]",
        ]
        return rng.choice(choices)


class Machine:
    """A path and independent axes that carry out what an interpreter gives."""

    def __init__(self, rng: Random) -> None:
        self._rng, has_head = rng, rng.random() < 0.3
        self.names = HEAD if has_head else STRAIGHT
        self.text = Writer(rng, has_head=has_head).text()
        timing = CycleTiming(rng.choice([1, 1, 2, 4]) * MS, buffer_cycles=rng.choice([0, 0, 3]))
        channel = channel_list(rng)
        axes = [AxisSettings.read(name, axis_list(rng), channel) for name in self.names]
        start = (0.0, 0.0, 80.0, *[0.0] * (len(axes) - 3))
        links = {n: IdealLink(n, mm) for n, mm in zip(self.names, start, strict=True)}
        settings = ChannelSettings.read(channel, start_after_ns=None, optional_stop=False)
        self.clock = SimpleNamespace(now_ns=0)
        ports: Any = list(links.values())
        clock: Any = self.clock
        self.path = Path(clock, timing, axes, ports, Offsets({}), settings)
        self.path.take_over(start)
        nobody: Any = None
        self.independent = IndependentAxes(
            clock,
            timing,
            self.path,
            nobody,
            dict(zip(self.names, ports, strict=True)),
            self._beside,
        )
        self._period_ns, self.cycles = timing.period_ns, 0
        self._shares, self._most = course(rng, LED_CYCLES), settings.override_max_permille
        self._slowed = rng.choice([None, None, *self.names])
        self._stops_at = rng.randint(1, 400) if rng.random() < 0.1 else CYCLES_MAX
        self.passed: Alarm | None = None
        self.refused: int | None = None

    def _share(self) -> float:
        return self._shares[self.cycles] if self.cycles < len(self._shares) else 1.0

    def _beside(self, axis: str) -> int:
        return min(round(1000 * self._share()), self._most)

    def cycle(self) -> bool:
        """Do one cycle; return whether anything is to be done still."""
        self.clock.now_ns += self._period_ns
        share, path = self._share(), self.path
        if share:
            slowed = (
                {} if self._slowed is None else {self._slowed: max(round(700 * share), 1) % 1000}
            )
            path.override(max(round(1000 * share), 1), {a: p for a, p in slowed.items() if p})
        path.feedhold(is_on=share == 0.0)
        if self.cycles == self._stops_at:
            path.brake()
            self.independent.stop()
        self.independent.advance()
        self.passed = path.advance()
        self.cycles += 1
        return self.passed is None and self.cycles < CYCLES_MAX

    def run(self) -> "Machine":
        try:
            for command in commands_of(self.text, self.names, self.path):
                self._carry_out(command)
                while self.path.is_moving and self.cycle():
                    pass
                if self.passed is not None or self.cycles >= min(CYCLES_MAX, self._stops_at):
                    return self
            while self.independent.is_moving and self.cycle():
                pass
        except Alarm as alarm:
            self.refused = alarm.id
        return self

    def _carry_out(self, command: canon.Command) -> None:
        if not isinstance(command, canon.IndependentMove):
            begin(self.path, command)
            return
        while self.independent.are_moving((command.axis,)) and self.cycle():
            pass
        if self.cycles < CYCLES_MAX:
            self.independent.begin(command)


@dataclass
class Standing:
    """What an interpreter asks of a machine."""

    path: Path

    def position_acs_mm(self, axis: str) -> float:
        return self.path.position_acs_mm(axis)

    def channel_distance(self) -> None:
        """There is no 3D distance control."""


def commands_of(text: str, names: Sequence[str], path: Path) -> Iterator[canon.Command]:
    """Decode a program whose axes are where a path is."""
    tables = OffsetTables(rotary=frozenset("CA"))
    machine: Any = Standing(path)
    program = parse_program(text, axes=names)
    yield from Interpreter(program, names, machine, external={}, tables=tables).commands()


def begin(path: Path, command: canon.Command) -> None:
    """Begin what moves a path, or what it chooses; everything else is nothing here."""
    if isinstance(command, canon.LinearMove):
        path.move(command.target_mm, None if command.rapid else command.feed_mm_min)
    elif isinstance(command, canon.ArcMove):
        where = command.target_mm, command.centre_mm, command.tangent, command.angle_rad
        path.move_on_arc(*where, command.feed_mm_min)
    elif isinstance(command, canon.KinematicChoice):
        path.transformation.choose(command)
    elif isinstance(command, canon.SlopeChoice):
        path.programmed.choose(command)
    elif isinstance(command, canon.DynamicWeights):
        path.programmed.weigh(command)


def run(seed: int) -> Machine:
    """Run the program of a seed."""
    return Machine(Random(seed)).run()


def main() -> None:
    """Run so many programs, from a first seed on; exit code 1 where one passes a limit."""
    count, first = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0
    found, refused, cycles = 0, Counter[int](), 0
    for seed in range(first, first + count):
        machine = run(seed)
        cycles += machine.cycles
        if machine.refused is not None:
            refused[machine.refused] += 1
        if machine.passed is not None:
            found += 1
            print(f"seed {seed}, cycle {machine.cycles}: {machine.passed}\n{machine.text}")
    print(f"{count} programs, {cycles} cycles, {found} pass a limit, refused: {dict(refused)}")
    sys.exit(found > 0)


if __name__ == "__main__":
    main()
