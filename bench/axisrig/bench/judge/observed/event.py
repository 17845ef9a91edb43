"""What happened at one instant of a run, as a mark of its plots."""

from dataclasses import dataclass

WARNING = " (warning)"
"""Ends the label of an alarm that did not end the program."""
BESIDES = "besides: "
"""Begins what is said of an alarm that came up while the axes were already stopping."""


@dataclass(frozen=True)
class Event:
    """Something that happened at one instant of a run.

    kind: `contact`, `edge`, `latch`, `pdo`, `brake`, `standstill`, `alarm`, `fault`, `mark`; the
    report gives each its own colour. label: what the plot prints. axis: None for all axes.
    is_warning: an alarm that did not end the program.
    """

    time_ns: int
    kind: str
    label: str
    axis: str | None = None
    is_warning: bool = False
