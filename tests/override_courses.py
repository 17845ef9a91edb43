"""Random courses of an override: steps, ramps, every cycle, to and fro, holds, or all."""

import math
from random import Random

STYLES = ("steps", "ramps", "every cycle", "to and fro", "holds")


def between(rng: Random, low: float, high: float) -> float:
    """Give a number of a range, every power of ten as often."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def course(rng: Random, cycles: int) -> list[float]:
    """Give the override of every cycle, 1 = 100 %; 0 is a hold."""
    style, share, shares = rng.choice([*STYLES, "mixed"]), rng.uniform(0.05, 2.0), [1.0]
    while len(shares) < cycles:
        now = rng.choice(STYLES) if style == "mixed" else style
        other, count = (
            rng.choice([0.01, 0.5, 0.95, 1.0, rng.uniform(0.05, 2.0)]),
            rng.randint(1, 80),
        )
        if now == "steps":
            shares += [other] * count
            share = other
        elif now == "ramps":
            shares += [share + (other - share) * k / count for k in range(1, count + 1)]
            share = other
        elif now == "every cycle":
            shares += [min(max(share * rng.uniform(0.8, 1.2), 0.01), 2.0) for _ in range(count)]
        elif now == "to and fro":
            each = rng.choice([1, 1, 2, 7])
            shares += [other if k // each % 2 else share for k in range(count)]
        else:
            shares += [0.0] * rng.choice([1, 2, 3, 10, 40]) + [share] * rng.choice([1, 2, 3, 20])
    return shares
