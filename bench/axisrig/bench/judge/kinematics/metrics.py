"""The metrics of programs in tool coordinates.

They are about the tool centre point: true positions of the axes, and latched ones, go through
chains of 4x4 matrices that take nothing from the kernel.
"""

import numpy as np

from axisrig.bench.judge.kinematics.truth import (
    away_mm,
    latched_centre_mm,
    places,
    stretches,
)
from axisrig.bench.judge.latch.metrics import INSTANT_NS
from axisrig.bench.judge.latch.truth import touch
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.tool import kinematic_at, tool_centre_mm
from axisrig.bench.judge.observed.topic import MetricFunction

KINEMATIC_METRICS: dict[str, MetricFunction] = {}
NEVER = "no kinematic was on (#TRAFO ON)"
NO_FEED = "no straight block with a feed was carried out while a kinematic was on"
NO_LINE = "no straight block was carried out while a kinematic was on"


def _of_tool(function: MetricFunction) -> MetricFunction:
    """Register a metric under the name of its function; without a kinematic it has no value."""

    def metric(observed: Observed, axis: str | None) -> Observation:
        if not observed.facts.kinematics:
            return Observation(None, note=NEVER)
        return function(observed, axis)

    KINEMATIC_METRICS[function.__name__] = metric
    return function


def _from_lines(observed: Observed, *, between: bool) -> Observation:
    found = [away_mm(observed, stretch, between=between) for stretch in stretches(observed)]
    if not found:
        return Observation(None, note=NO_LINE)
    return Observation(max(found) * 1e3)


@_of_tool
def tcp_from_line_um_max(observed: Observed, _axis: str | None) -> Observation:
    """Greatest distance of the tool centre point from the line of its block, at the SYNCs."""
    return _from_lines(observed, between=False)


@_of_tool
def tcp_between_um_max(observed: Observed, _axis: str | None) -> Observation:
    """The same between the SYNCs, for axes that go straight from one to the next."""
    return _from_lines(observed, between=True)


@_of_tool
def tcp_velocity_mm_s_max(observed: Observed, _axis: str | None) -> Observation:
    """Greatest speed of the tool centre point in a block with a feed, from SYNC to SYNC."""
    period_s, found = observed.facts.timing.period_ns / 1e9, []
    for stretch in stretches(observed):
        if not stretch.has_feed:
            continue
        rows = slice(stretch.begin + stretch.shift, stretch.end + stretch.shift + 1)
        axes = places(observed, stretch.on, "truth_mm", rows)
        ways = np.diff(tool_centre_mm(observed, stretch.on, axes), axis=0)
        found.append(float(np.max(np.linalg.norm(ways, axis=-1))) / period_s)
    return Observation(max(found)) if found else Observation(None, note=NO_FEED)


@_of_tool
def tcp_mm(observed: Observed, axis: str | None) -> Observation:
    """Coordinate of the tool centre point at the end of the program."""
    on = observed.facts.kinematics[-1]
    main = on.axes[:3]
    if axis not in main:
        return Observation(None, note=f"the tool centre point has {' '.join(main)}: name one")
    last = len(observed) - 1
    axes = places(observed, on, "truth_mm", slice(last, last + 1))
    return Observation(float(tool_centre_mm(observed, on, axes)[0][main.index(axis)]))


@_of_tool
def tcp_latch_error_um(observed: Observed, _axis: str | None) -> Observation:
    """Distance of the measured tool centre point from the true one at the contact."""
    seen = touch(observed, None)
    on = None if seen is None else kinematic_at(observed, seen.run.begin_ns)
    if seen is None or on is None:
        return Observation(None, note="no measurement run was made while a kinematic was on")
    if seen.contact is None:
        return Observation(None, note=f"the {seen.what} met nothing during the measurement run")
    latched = {axis: seen.run.latched_mm.get(axis) for axis in on.axes}
    missing = [axis for axis, value in latched.items() if value is None]
    if missing:
        return Observation(None, note=f"no measured value of axis {' '.join(missing)}")
    at_contact = {axis: seen.contact.position_mm[observed.axes[axis].plant] for axis in on.axes}
    found, truth = (
        latched_centre_mm(observed, on, values)
        for values in ({a: v for a, v in latched.items() if v is not None}, at_contact)
    )
    row = observed.index_at(seen.contact.time_ns)
    around = places(observed, on, "truth_mm", slice(max(row - 1, 0), row + 1))
    ways = np.diff(tool_centre_mm(observed, on, around), axis=0)
    speed_mm_s = float(np.max(np.linalg.norm(ways, axis=-1), initial=0.0)) * 1e9
    events_ns = INSTANT_NS + seen.edge_uncertainty_ns
    return Observation(
        float(np.linalg.norm(found - truth)) * 1e3,
        speed_mm_s / observed.facts.timing.period_ns * events_ns * 1e-6,
        f"location of the events {events_ns:g} ns",
    )
