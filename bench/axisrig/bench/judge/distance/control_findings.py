"""What the judge finds of one distance control, as the report reads it.

Lengths in mm, times in ns, speeds in mm/s; of an axis that turns degrees in place of mm.
"""

from collections.abc import Sequence
from dataclasses import dataclass

MM, DEGREE = "mm", "°"


@dataclass(frozen=True)
class DistanceLaw:
    """A law with its controller: what theory says of its loop.

    mode: of `oracles.distance.loop`. dead_cycles, age_cycles: of the loop. kp_limit: None without
    a limit of stability, or where it is not known; kp_limit_unknown: why not, else empty. growth:
    of the error in a cycle.
    """

    mode: str
    formula: str
    kp: float
    tn_s: float
    tv_s: float
    filter: str
    delay_cycles: float
    noise_gain: float
    dead_cycles: int
    age_cycles: int
    drive_lag_ms: float
    kp_limit: float | None
    growth: float
    kp_limit_unknown: str = ""


@dataclass(frozen=True)
class DistanceStretch:
    """What holds between two changes. by: NC or PLC. set_mm, set_end_mm: first and last set value.

    law: that it follows, None where it does not.
    """

    begin_ns: int
    end_ns: int
    state: str
    by: str
    is_dry_run: bool
    set_mm: float | None
    set_end_mm: float | None
    law: DistanceLaw | None


@dataclass(frozen=True)
class DeadCycles:
    """Dead cycles by the arithmetic of the rig and by the frames; note: why not by these."""

    predicted: int
    measured: int | None = None
    note: str = ""


@dataclass(frozen=True)
class EndError:
    """The true error at the end of a stretch beside its closed form, None without one."""

    begin_ns: int
    mode: str
    speed_mm_s: float
    measured_mm: float
    spread_mm: float
    expected_mm: float | None
    note: str = ""


@dataclass(frozen=True)
class UsedLimit:
    """A limit with the most that was used of it. acts: what it does."""

    key: str
    parameter: str
    value: float
    unit: str
    used: float | None
    acts: str


@dataclass(frozen=True)
class ControlFindings:
    """One axis with distance control, or the channel with its 3D control.

    unit: of its lengths. sensor: its plant, None without one. zero_mm: gap at which the sensor
    value is 0. late_cycles: after which an offset is sent. laws: each once.
    """

    axis: str
    unit: str
    sensor: str | None
    zero_mm: float
    period_ms: float
    late_cycles: int
    stretches: Sequence[DistanceStretch]
    laws: Sequence[DistanceLaw]
    dead: DeadCycles
    errors: Sequence[EndError] = ()
    limits: Sequence[UsedLimit] = ()
    notes: Sequence[str] = ()
