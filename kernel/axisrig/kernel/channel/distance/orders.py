"""What was asked of the distance controls of a channel, for whoever records a run."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Order:
    """Values and parameters that were given to a control, or a command that it has carried out.

    axis: None = 3D control. by: NC program, PLC side, or OBJECT, a CNC object. action: name of a
    `DistanceCommand`, empty where only values are given. parameters: by their names in
    `DistanceControl.program`; of an object by its name in the list, in its unit.
    """

    axis: str | None
    by: str
    action: str = ""
    is_dry_run: bool = False
    set_pos_mm: float | None = None
    set_dist_mm: float | None = None
    parameters: Mapping[str, float | str] = field(default_factory=dict)


def given(
    axis: str | None,
    by: str,
    set_pos_mm: float | None,
    set_dist_mm: float | None,
    parameters: Mapping[str, float | str],
) -> list[Order]:
    """Return the order for values that a control has taken, none without any."""
    if set_pos_mm is None and set_dist_mm is None and not parameters:
        return []
    values = set_pos_mm, set_dist_mm, dict(parameters)
    return [Order(axis, by, "", False, *values)]
