"""What the judge finds of the tool of a run with a kinematic, as the report reads it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from axisrig.bench.oracles.kinematics.lists import Written
from axisrig.bench.record.distance import Diagnosis
from axisrig.bench.record.kinematics import GuideChange, KinematicRecord


@dataclass(frozen=True)
class KinematicStretch:
    """One time in which a kinematic was on. end_ns: after the last row at the latest.

    limits: HD2, HD3 and HD4 of kinematic 98 in degrees, those that act.
    """

    record: KinematicRecord
    end_ns: int
    limits: Mapping[str, float]


@dataclass(frozen=True)
class ToolGuide:
    """Where the offset of 3D control acted. is_used: whether the control was on meanwhile."""

    change: GuideChange
    is_used: bool


@dataclass(frozen=True)
class ToolFindings:
    """The tool of a run. axes, rotary: all of the rig, and whether each turns.

    sensor: the plant that sees the inclined tool, None without one. written: entries of the
    channel list that make kinematics.
    """

    axes: Sequence[str]
    rotary: Sequence[bool]
    sensor: str | None
    written: Written
    kinematics: Sequence[KinematicStretch]
    guides: Sequence[ToolGuide]
    diagnosis: Sequence[Diagnosis]
