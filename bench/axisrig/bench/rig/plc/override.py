"""Feed overrides of the PLC side: of the path, and of an axis, in steps of 0.1 % as the HLI has."""

from collections.abc import Mapping
from dataclasses import dataclass

from axisrig.bench.plan.assignment import number
from axisrig.bench.rig.plc.times import lasting
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import TimeNs

PERMILLE_PER_PCT = 10


@dataclass(frozen=True)
class OverrideCourse:
    """A feed override moves evenly over a time; 0 at once. axis: None is that of the path."""

    axis: str | None
    permille: int
    over_ns: TimeNs = 0


def read_override(
    axis: str | None, column: str, value: str, keys: Mapping[str, str], highest_pct: int
) -> OverrideCourse:
    """Read one action of an override. Raises UserError for a value that cannot be."""
    permille = number(column, value) * PERMILLE_PER_PCT
    if not 0 <= permille <= highest_pct * PERMILLE_PER_PCT or permille != round(permille):
        raise UserError(
            "override: percent in steps of 0.1", value=value, allowed=f"0 to {highest_pct}"
        )
    return OverrideCourse(axis, round(permille), lasting("over", keys))
