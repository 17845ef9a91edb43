"""What the judge finds of one run to a fixed stop, as the report reads it; times in ns."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from axisrig.bench.judge.fixed_stop.values import Value

PLANT, KERNEL = "plant", "kernel"


@dataclass(frozen=True)
class Mark:
    """One row of the timeline: an instant that was measured beside that of the closed form.

    source: who gives the measured instant, PLANT or KERNEL. oracle_ns, low_ns, high_ns: of the
    closed form with its band, None without one. is_inside: measured in the band.
    """

    key: str
    label: str
    axis: str | None
    measured_ns: int | None
    source: str
    oracle_ns: int | None = None
    low_ns: int | None = None
    high_ns: int | None = None
    is_inside: bool | None = None
    note: str = ""

    @property
    def says_nothing(self) -> bool:
        """Whether it has neither an instant nor a word."""
        return self.measured_ns is None and self.oracle_ns is None and not self.note


@dataclass(frozen=True)
class StopLimits:
    """What acts on an axis; lengths of a rotary one in degrees.

    force_limit_n, of a rotary axis torque_limit_nm: of the motor towards the stop, with the sign
    of its direction; None where the plant gives none.
    """

    lag_limit_mm: float | None
    window_mm: float | None
    min_time_ms: float
    arming_mm: float | None
    force_limit_n: float | None = None
    torque_limit_nm: float | None = None


@dataclass(frozen=True)
class Decision:
    """The axis whose criterion found the stop."""

    axis: str
    criterion: str


@dataclass(frozen=True)
class BrokenContact:
    """A contact that was lost. since_ns: of its return, None without one."""

    first_ns: int
    since_ns: int | None
    lost_ns: int


@dataclass(frozen=True)
class StopFindings:
    """One run to a fixed stop. axes: of its path. watched: with a criterion.

    rotary: axes that turn, and whether their forces are known as torques. broken_contacts: of the
    axes that lost theirs. prediction: of the closed form, empty without one.
    """

    number: int
    block: str
    axes: Sequence[str]
    watched: Sequence[str]
    main_axis: str | None
    is_found: bool
    decided_by: Decision | None
    limits: Mapping[str, StopLimits]
    rotary: Mapping[str, bool]
    begin_ns: int
    end_ns: int
    broken_contacts: Mapping[str, BrokenContact]
    marks: Sequence[Mark]
    values: Sequence[Value] = ()
    prediction: str = ""
    notes: Sequence[str] = ()
