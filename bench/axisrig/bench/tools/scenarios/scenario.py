"""Random fault scenarios: what is done to the small machine of `probe.toml`, drawn from a seed.

A scenario is a list of assignments as a plan or `--set` has them, so that each can be run by hand:
`axisrig nc probe.nc --rig probe.toml --set ...`. What is drawn, and how often, is a table of its
own (`kinds.csv`): a further kind of fault, key or moment changes no scenario of an old seed.
"""

import csv
import random
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import resources

AXIS, BUS = "Z", "can1"
FEED_MIN, FEED_MAX = 300, 1800
FEED_APART_MIN = 120
"""mm/min; 1 um of input delay apart, more than a hundred increments: a value of the first run is
wrong for the second."""
_TELEGRAMS = {
    "TPDO1": 5, "TPDO2": 5, "RPDO1": 5, "TPDO3": 1, "SDO": 2, "SYNC": 3, "EMCY": 1, "NMT": 1,
}  # fmt: skip
_FAULTS_WEIGHTS = {0: 1, 1: 50, 2: 35, 3: 14}


PROFILES = (
    "generic", "generic", "generic", "late-status", "epos4-like", "yaskawa-like", "ep7211-like",
    "ax8000-like", "steppeonline-like",
)  # fmt: skip
"""Habits of drives; what they do to the latched position is taken out (`PROFILE_KEYS`)."""


_MOMENTS = ("start", "motion", "standing", "armed", "edge", "latched", "seen")
_COMMANDS = ("reset", "reset_communication", "stop", "pre_operational")


@dataclass(frozen=True)
class Kind:
    """A row of `kinds.csv`: a kind of fault, how often it is drawn, its targets and keys."""

    name: str
    weight: int
    targets: tuple[str, ...]
    keys: tuple[str, ...]


@cache
def drawn_kinds() -> tuple[Kind, ...]:
    """Read the table."""
    text = resources.files(__package__).joinpath("kinds.csv").read_text(encoding="utf-8")
    return tuple(
        Kind(
            row["kind"],
            int(row["weight"]),
            tuple(row["targets"].split()),
            tuple(row["keys"].split()),
        )
        for row in csv.DictReader(text.splitlines())
    )


@dataclass(frozen=True)
class Scenario:
    """One run: its number, the seed of its case, its inputs as `COLUMN=VALUE`, and the drive."""

    number: int
    seed: int
    assignments: tuple[str, ...]
    profile: str = "generic"

    @property
    def faults(self) -> tuple[str, ...]:
        """The assignments that are faults."""
        return tuple(text for text in self.assignments if text.startswith("fault:"))


def make_scenario(seed: int, number: int) -> Scenario:
    """Draw scenario `number` of the campaign `seed`."""
    numbers = random.Random(f"{seed} {number}")
    feed_1 = numbers.randint(FEED_MIN, FEED_MAX)
    far = [f for f in range(FEED_MIN, FEED_MAX + 1, 20) if abs(f - feed_1) >= FEED_APART_MIN]
    inputs = [
        f"plc:V.E.FEED1={feed_1}",
        f"plc:V.E.FEED2={numbers.choice(far)}",
        f"plc:V.E.RETRACT={numbers.uniform(0.1, 0.4):.3f}",
        f"plant:z.position_start_mm={numbers.uniform(0.2, 0.6):.4f}",
    ]
    if numbers.random() < 0.2:
        inputs += ["set:Z.kenngr.measure.edge=NEG", "plant:probe.inverted=1"]
    count = numbers.choices(list(_FAULTS_WEIGHTS), list(_FAULTS_WEIGHTS.values()))[0]
    cells: dict[str, list[str]] = {}
    kinds = [kind for kind in drawn_kinds() for _ in range(kind.weight)]
    for _ in range(count):
        kind = numbers.choice(kinds)
        cells.setdefault(kind.name, []).append(_fault(kind, numbers))
    inputs += [f"fault:{kind}={'; '.join(faults)}" for kind, faults in cells.items()]
    seed_of_run, profile = numbers.randrange(2**32), numbers.choice(PROFILES)
    return Scenario(number, seed_of_run, tuple(inputs), profile)


def _fault(form: Kind, numbers: random.Random) -> str:
    if form.targets == ("telegram",):
        telegram = numbers.choices(list(_TELEGRAMS), list(_TELEGRAMS.values()))[0]
        target = f"{BUS}.{telegram}" if telegram in ("SYNC", "NMT") else f"{AXIS}.{telegram}"
    else:
        target = {"bus": BUS, "axis": AXIS}[numbers.choice(form.targets)]
    words = [target]
    for key in form.keys:
        share, draw = _KEYS[key]
        if numbers.random() < share:
            words.append(f"{key}={draw(numbers)}")
    text = " ".join(words)
    # The program starts once; a second time would be a fault that never comes
    return text if "at=start" not in text else text.replace("nth=2", "nth=1")


Draw = Callable[[random.Random], object]


def _time(low_us: float, high_us: float) -> Callable[[random.Random], str]:
    """Draw a time between the limits, every decade as likely as another."""

    def draw(numbers: random.Random) -> str:
        us = low_us * (high_us / low_us) ** numbers.random()
        return f"{us:.0f}us" if us < 1000 else f"{us / 1000:.3f}ms"

    return draw


def _moment(numbers: random.Random) -> str:
    if numbers.random() < 0.2:
        return f"{numbers.uniform(0, 250):.3f}ms"
    name = numbers.choice(_MOMENTS)
    return name if numbers.random() < 0.5 else f"{name}+{_time(10, 50_000)(numbers)}"


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
}  # fmt: skip
