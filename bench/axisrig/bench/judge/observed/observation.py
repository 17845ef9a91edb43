"""What a metric yields."""

from dataclasses import dataclass

from axisrig.bench.plan.checks import Value


@dataclass(frozen=True)
class Observation:
    """A metric's value; uncertainty in its unit; note: why there is none, or what it is made of.

    is_hidden: the value is outside of what the bench sees.
    """

    value: Value
    uncertainty: float = 0.0
    note: str = ""
    is_hidden: bool = False
