"""Random fault scenarios: what is done to a machine of `machines.csv`, drawn from a seed.

A scenario is a list of assignments as a plan or `--set` has them, so that each can be run by hand:
`axisrig nc PROGRAM --rig RIG --set ...`. What is drawn, and how often, is a table of its own
(`kinds.csv`, a column of weights for each group of machines): a further kind of fault, key or
moment changes no scenario of an old seed where its weight is 0.
"""

import csv
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import TypeVar

from axisrig.bench.rig.reading.faults import fault_keys
from axisrig.bench.tools.scenarios.drawing import draw_inputs
from axisrig.bench.tools.scenarios.machines import EVERY, ONE_AXIS, machines, places_of, rig_of

_TELEGRAMS = {
    "TPDO1": 5, "TPDO2": 5, "RPDO1": 5, "TPDO3": 1, "SDO": 2, "SYNC": 3, "EMCY": 1, "NMT": 1,
}  # fmt: skip
_FAULTS_WEIGHTS = {0: 1, 1: 50, 2: 35, 3: 14}
_MOMENTS = ("start", "motion", "standing", "armed", "edge", "latched", "seen")
_COMMANDS = ("reset", "reset_communication", "stop", "pre_operational")
_STATES = ("SAFEOP", "PREOP", "INIT")
_CODES = ("WATCHDOG", "SYNC_ERROR", "PLL_ERROR", "NO_VALID_INPUTS", "RESTARTED")

Drawn = TypeVar("Drawn")


@dataclass(frozen=True)
class Kind:
    """A row of `kinds.csv`: a kind of fault, how often it is drawn, its targets and keys.

    weights: by column. hides: invariants that cannot be decided with it, as nothing in control or
    drive could know. jumps: telegrams (`every`: all targets) with which it changes what set
    position a drive takes, or when.
    """

    name: str
    weights: Mapping[str, int]
    targets: tuple[str, ...]
    keys: tuple[str, ...]
    hides: tuple[str, ...]
    jumps: tuple[str, ...]

    def lets_jump(self, target: str) -> bool:
        """Return whether an axis that follows its demand exactly may jump after it."""
        telegram = target.rpartition(".")[2].rstrip("0123456789")
        return EVERY in self.jumps or telegram in self.jumps


@cache
def drawn_kinds() -> dict[str, Kind]:
    """Read the table, in its order."""
    text = resources.files(__package__).joinpath("kinds.csv").read_text(encoding="utf-8")
    words = ("kind", "targets", "keys", "hides", "jumps")
    return {
        row["kind"]: Kind(
            row["kind"],
            {column: int(weight) for column, weight in row.items() if column not in words},
            *(tuple(row[column].split()) for column in words[1:]),
        )
        for row in csv.DictReader(text.splitlines())
    }


@cache
def _pool(machine: str) -> tuple[Kind, ...]:
    """Return the kinds that a machine has places for, each as often as it weighs."""
    column = machines()[machine].weights
    found = [kind for kind in drawn_kinds().values() if kind.weights[column]]
    return tuple(
        kind for kind in found if places_of(machine, kind.name) for _ in range(kind.weights[column])
    )


@dataclass(frozen=True)
class Scenario:
    """One run: its number, the seed of its case, its inputs as `COLUMN=VALUE`, drive and machine.

    profile: of the drives; empty: as the rig has it.
    """

    number: int
    seed: int
    assignments: tuple[str, ...]
    profile: str = "generic"
    machine: str = ONE_AXIS

    @property
    def faults(self) -> tuple[str, ...]:
        """The assignments that are faults."""
        return tuple(text for text in self.assignments if text.startswith("fault:"))

    @property
    def hidden(self) -> frozenset[str]:
        """Invariants that cannot be decided with these faults."""
        kinds = [text.partition("=")[0].partition(":")[2] for text in self.faults]
        known = drawn_kinds()
        return frozenset(
            name for kind in kinds for name in (known[kind].hides if kind in known else ())
        )


def make_scenario(seed: int, number: int, machine: str = ONE_AXIS) -> Scenario:
    """Draw scenario `number` of the campaign `seed` of a machine.

    Raises UserError where the files of the machine are not there.
    """
    row = machines()[machine]
    own = "" if machine == ONE_AXIS else f" {machine}"
    numbers = random.Random(f"{seed} {number}{own}")
    inputs = draw_inputs(row.inputs, numbers)
    count = numbers.choices(list(_FAULTS_WEIGHTS), list(_FAULTS_WEIGHTS.values()))[0]
    cells: dict[str, list[str]] = {}
    pool = _pool(machine)
    for _ in range(count):
        kind = numbers.choice(pool)
        fault = _fault(kind, machine, numbers)
        faults = cells.setdefault(kind.name, [])
        # Probing inputs are exchanged or not: a second time says nothing
        if kind.keys or fault not in faults:
            faults.append(fault)
    inputs += [f"fault:{kind}={'; '.join(faults)}" for kind, faults in cells.items()]
    seed_of_run = numbers.randrange(2**32)
    profile = numbers.choice(row.profiles) if row.profiles else ""
    return Scenario(number, seed_of_run, tuple(inputs), profile, machine)


def _fault(form: Kind, machine: str, numbers: random.Random) -> str:
    words = [_place(form, machine, numbers)]
    for key in form.keys:
        share, draw = _KEYS[key]
        if numbers.random() < share:
            words.append(f"{key}={draw(numbers)}")
    text = " ".join(words)
    # The program starts once; a second time would be a fault that never comes
    return text if "at=start" not in text else text.replace("nth=2", "nth=1")


def _place(form: Kind, machine: str, numbers: random.Random) -> str:
    places = places_of(machine, form.name)
    if form.targets == ("telegram",):
        known = {
            name: weight
            for name, weight in _TELEGRAMS.items()
            if any(place.endswith(f".{name}") for place in places)
        }
        telegram = numbers.choices(list(known), list(known.values()))[0]
        return _one([place for place in places if place.endswith(f".{telegram}")], numbers)
    target = numbers.choice(form.targets)
    if len(form.targets) == 1:
        return _one(places, numbers)
    rig, _ = rig_of(machine)
    of_target = rig.axis if target == "axis" else rig.segment
    return _one([place for place in places if place in of_target], numbers)


def _one(found: Sequence[Drawn], numbers: random.Random) -> Drawn:
    """Draw one of several; nothing is drawn where there is no choice."""
    return found[0] if len(found) == 1 else numbers.choice(found)


Draw = Callable[[random.Random], object]


def _time(low_us: float, high_us: float) -> Callable[[random.Random], str]:
    """Draw a time between the limits, every decade as likely as another."""

    def draw(numbers: random.Random) -> str:
        us = low_us * (high_us / low_us) ** numbers.random()
        return f"{us:.0f}us" if us < 1000 else f"{us / 1000:.3f}ms"

    return draw


def _size(low: float, high: float) -> Callable[[random.Random], str]:
    """Draw a size of either sign between the limits, every decade as likely as another."""

    def draw(numbers: random.Random) -> str:
        return f"{numbers.choice((-1, 1)) * low * (high / low) ** numbers.random():.0f}"

    return draw


def _moment(numbers: random.Random) -> str:
    if numbers.random() < 0.2:
        return f"{numbers.uniform(0, 250):.3f}ms"
    name = numbers.choice(_MOMENTS)
    return name if numbers.random() < 0.5 else f"{name}+{_time(10, 50_000)(numbers)}"


def _words(key: str) -> Sequence[str]:
    return fault_keys()[key].allowed.split()


_KEYS: dict[str, tuple[float, Draw]] = {
    "at": (0.9, _moment),
    "for": (0.5, _time(100, 100_000)),
    "nth": (0.5, lambda n: n.randint(1, 2)),
    "p": (0.5, lambda n: f"{10 ** n.uniform(-2, 0):.4f}"),
    "count": (0.5, lambda n: round(10 ** n.uniform(0, 1.7))),
    "skip": (0.2, lambda n: round(10 ** n.uniform(0, 2))),
    "by": (0.9, _time(10, 100_000)),
    "jitter": (0.5, _time(10, 20_000)),
    "after": (0.7, _time(10, 20_000)),
    "bit": (0.3, lambda n: n.randint(1, 110)),
    "byte": (0.6, lambda n: n.randint(1, 8)),
    "xor": (0.6, lambda n: n.randint(1, 255)),
    "id": (0.8, lambda n: n.choice([0x001, 0x07F, 0x081, 0x182, 0x300, 0x7FF])),
    "bytes": (0.5, lambda n: n.randint(0, 8)),
    "period": (0.8, _time(60, 5_000)),
    "data": (0.7, lambda n: n.choice(["last", "random", n.randbytes(n.randint(1, 8)).hex()])),
    "command": (0.7, lambda n: n.choice(_COMMANDS)),
    "pulses": (0.7, lambda n: n.randint(1, 6)),
    "increments": (0.7, lambda n: round(10 ** n.uniform(0, 4))),
    "um_s": (0.9, _size(10, 20_000)),
    "um": (0.9, _size(10, 12_000)),
    "ppm": (0.9, _size(10, 10_000)),
    "value": (1.0, lambda n: n.randint(0, 1)),
    "state": (0.5, lambda n: n.choice(_STATES)),
    "code": (0.5, lambda n: n.choice(_CODES)),
    "real_time": (0.9, lambda n: n.choice(_words("real_time"))),
    "level": (1.0, lambda n: n.randint(0, 1)),
    "error": (0.7, lambda n: n.choice((1, 2, 4, 5, 6))),
    "soe": (0.5, lambda n: n.choice(_words("soe"))),
}  # fmt: skip
