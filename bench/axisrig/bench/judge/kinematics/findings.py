"""The tool of a run with a kinematic, for the report: what the oracle of kinematics needs.

Positions are in the trace; here is which kinematic was on when, of what it was made, which plant
sees the tool, where 3D distance control acted, and its diagnosis data.
"""

import math
from collections.abc import Sequence
from itertools import pairwise

from axisrig.bench.judge.kinematics.tool_findings import KinematicStretch, ToolFindings, ToolGuide
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.kinematics.lists import Kinematics, Lists, Written
from axisrig.bench.record.distance import ChannelDistanceRecord
from axisrig.bench.record.kinematics import KinematicRecord
from axisrig.kernel.time.clock import TimeNs

EXTENSION = 98
"""Type of the kinematic that extends the tool virtually."""
_OF_KINEMATICS = ("kin_step[", "trafo[", "kinematik[")
_ANGLES = (2, 3, 4)
INACTIVE = "INACTIVE"


def no_events(_observed: Observed) -> list[Event]:
    """Return no marks: what the program commands is with its distance control."""
    return []


def tool_findings(observed: Observed) -> list[ToolFindings]:
    """Return what the report shows of the tool; empty for a run that had no kinematic on."""
    facts = observed.facts
    if not facts.kinematics:
        return []
    written = {
        name: value for name, value in facts.channel.items() if name.startswith(_OF_KINEMATICS)
    }
    control = facts.distance_3d
    return [
        ToolFindings(
            axes=list(facts.axes),
            rotary=[axis.is_rotary for axis in facts.axes.values()],
            sensor=_sensor(observed),
            written=written,
            kinematics=[_stretch(observed, on, written) for on in facts.kinematics],
            guides=[] if control is None else _guides(control),
            diagnosis=() if control is None else control.diagnosis,
        )
    ]


def _stretch(observed: Observed, on: KinematicRecord, written: Written) -> KinematicStretch:
    last_ns = int(observed.times_ns[-1]) + 1 if len(observed) else on.begin_ns
    return KinematicStretch(on, last_ns if on.end_ns is None else on.end_ns, _limits(written, on))


def _guides(control: ChannelDistanceRecord) -> list[ToolGuide]:
    """Return where the offset acted."""
    changes = _spans([change.time_ns for change in control.changes])
    on = [
        span
        for span, change in zip(changes, control.changes, strict=True)
        if change.state != INACTIVE
    ]
    spans = _spans([guide.time_ns for guide in control.guides])
    return [
        ToolGuide(guide, any(begin < last and first < end for first, last in on))
        for (begin, end), guide in zip(spans, control.guides, strict=True)
    ]


def _spans(begins_ns: Sequence[TimeNs]) -> list[tuple[float, float]]:
    """Return begin and end of what holds until the next one; the last one has no end."""
    return list(pairwise([*begins_ns, math.inf])) if begins_ns else []


def _limits(written: Written, on: KinematicRecord) -> dict[str, float]:
    """Return HD2, HD3 and HD4 of kinematic 98 in degrees, those that act."""
    if len(on.ids) < 2:
        return {}
    found: Kinematics = Lists(written, dict(on.program)).of(1, on.ids[1])
    if found.type != EXTENSION:
        return {}
    limits = {f"HD{number}": found.hd(number) for number in _ANGLES}
    if limits["HD2"] >= 90.0:  # never extended
        return {"HD4": limits["HD4"]}
    return {name: value for name, value in limits.items() if name == "HD2" or value > 0.0}


def _sensor(observed: Observed) -> str | None:
    """Return the plant that sees the inclined tool: that of the control's variable, else any."""
    facts = observed.facts
    control = facts.distance_3d
    chosen = facts.plc_sensors.get("" if control is None else control.variable)
    names = [name.partition(".")[0] for name in observed.series.names if name.endswith(".tcp_x_mm")]
    if chosen is not None and chosen.sensor in names:
        return chosen.sensor
    return next(iter(names), None)
