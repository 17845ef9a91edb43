"""From the IDs that a program has chosen to a kinematic: `build`, and the axes it needs."""

from collections.abc import Sequence

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics.data import KinematicData, Trafo
from axisrig.kernel.kinematics.extension import ExtendedTool
from axisrig.kernel.kinematics.head import HeadCA
from axisrig.kernel.kinematics.kinematic import Kinematic
from axisrig.kernel.kinematics.members import (
    EXTENSION,
    HEAD,
    ROBOT,
    UNIVERSAL,
    Parameters,
    Written,
    coupled,
    robot,
    universal,
)
from axisrig.kernel.kinematics.table import KinematicType, kinematic_types


def build(ids: Sequence[int], data: KinematicData, written: Written, tool_mm: float) -> Kinematic:
    """Build the kinematic of one or two steps.

    ids: as `#TRAFO [9, 98]` chooses them. written: what V.G.KIN_STEP[].ID[].PARAM[] have, by their
    three indices, in 0.1 um and 0.0001 degrees. tool_mm: length of the tool (V.G.WZ_AKT.L).
    Raises Alarm: an unknown ID, a kinematic that is refused, a combination that does not exist, a
    parameter out of its range.
    """
    _check_steps(ids, data)
    first = _first(Parameters(0, _trafo(0, ids[0], data), written), data, tool_mm)
    if len(ids) == 1:
        return first
    return _extended(first, Parameters(1, _trafo(1, ids[1], data), written))


def check_known(ids: Sequence[int], data: KinematicData) -> None:
    """Raise Alarm for an ID that is unknown or whose kinematic is refused."""
    for step, number in enumerate(ids[: len(data.steps)]):
        _type(step, number, data)


def check_axes(kinematic: Kinematic, axes: Sequence[tuple[str, bool]]) -> None:
    """Compare the axes of a channel, name and whether rotary, with what a kinematic needs.

    Raises Alarm: too few, another kind, two of one name, or names of the kinematic at other places.
    """
    found = axes[: kinematic.count]
    names = [name for name, _ in found]
    fits = tuple(rotary for _, rotary in found) == kinematic.rotary
    fits &= len(set(names)) == len(names)
    wanted = kinematic.axes
    fits &= all(
        name == wanted[place] or name not in wanted
        for place, name in enumerate(names[: len(wanted)])
    )
    if fits:
        return
    kinds = [f"{_kind(rotary)}" for rotary in kinematic.rotary]
    needed = [f"{name} ({kind})" for name, kind in zip(wanted, kinds, strict=False)]
    needed += kinds[len(wanted) :]
    has = ", ".join(f"{name} ({_kind(rotary)})" for name, rotary in found) or "none"
    raise Alarm(292040, name=kinematic.name, needed=", ".join(needed), axes=has)


def _kind(rotary: bool) -> str:
    return "rotary" if rotary else "linear"


def _check_steps(ids: Sequence[int], data: KinematicData) -> None:
    chosen = "kinematic " + ", ".join(map(str, ids)) if ids else "no kinematic"
    if not 1 <= len(ids) <= len(data.steps):
        reason = f"{len(ids)} steps and there are 1 or 2"
        raise Alarm(900441, chosen=chosen.capitalize(), reason=reason)
    kinds = [_trafo(step, number, data).type for step, number in enumerate(ids)]
    if kinds[0] == EXTENSION:
        reason = "98 extends the tool of another kinematic and is the second step after it"
        raise Alarm(900441, chosen=chosen.capitalize(), reason=reason)
    if kinds[1:] and kinds[1] != EXTENSION:
        reason = f"only 98 is a second step and {ids[1]} is {_type(1, ids[1], data).name}"
        raise Alarm(900441, chosen=chosen.capitalize(), reason=reason)


def _trafo(step: int, number: int, data: KinematicData) -> Trafo:
    """Find the set of parameters; a kinematic without one has all of them 0."""
    return data.steps[step].get(number, Trafo(number, number))


def _type(step: int, number: int, data: KinematicData) -> KinematicType:
    """Return what a kinematic is. Raises Alarm if it is unknown or refused."""
    types = kinematic_types()
    found = types.get(_trafo(step, number, data).type)
    if found is None:
        known = ", ".join(str(key) for key, row in types.items() if row.acts)
        raise Alarm(292005, id=number, step=step, known=known)
    if not found.acts:
        raise Alarm(900440, id=number, what=found.name, reason=found.reason)
    return found


def _first(parameters: Parameters, data: KinematicData, tool_mm: float) -> Kinematic:
    trafo = parameters.trafo
    kind = _type(parameters.step, trafo.id, data)
    name = str(trafo.id)
    if kind.id == HEAD:
        return HeadCA([parameters.hd(n) for n in range(1, 10)], tool_mm, name, kind.axes)
    if kind.id == ROBOT:
        return robot(parameters, tool_mm, name)
    if kind.id == UNIVERSAL:
        return universal(parameters, tool_mm, name)
    return coupled(parameters, data.steps[parameters.step], tool_mm, name)


def _extended(first: Kinematic, parameters: Parameters) -> Kinematic:
    """Build kinematic 98. HD3 = 0 is missing: the height is kept up to HD4."""
    hd1_mm, start, end, largest = (parameters.hd(number) for number in range(1, 5))
    if not 0.0 <= start <= 180.0:
        raise parameters.refuse("HD2", start, "0 to 180 deg")
    if not 0.0 < largest <= 180.0:
        raise parameters.refuse("HD4", largest, "above 0 up to 180 deg")
    if start >= 90.0:  # never extended; HD3 is not used
        return ExtendedTool(first, hd1_mm, start, largest, largest)
    if end == 0.0:
        if largest >= 90.0:
            allowed = "below 90 deg where HD3 is 0 and the height is kept up to HD4"
            raise parameters.refuse("HD4", largest, allowed)
        end = largest
    elif not start <= end < 90.0:
        raise parameters.refuse("HD3", end, f"HD2 = {start:g} up to below 90 deg")
    return ExtendedTool(first, hd1_mm, start, end, largest)
