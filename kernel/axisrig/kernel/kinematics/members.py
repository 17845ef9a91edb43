"""Kinematics 45, 91 and 210 from the parameters of lists and program, with their ranges."""

from collections.abc import Mapping
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics.coupled import OnLinearAxes
from axisrig.kernel.kinematics.data import Trafo
from axisrig.kernel.kinematics.kinematic import Vector
from axisrig.kernel.kinematics.robot import ArticulatedRobot
from axisrig.kernel.kinematics.rotation import (
    IDENTITY,
    Rotation,
    from_angles,
    inverse,
    least_turn,
    product,
    turned,
)
from axisrig.kernel.kinematics.table import kinematic_types
from axisrig.kernel.kinematics.universal import LINEAR, ChainAxis, Universal, unit

Written = Mapping[tuple[int, ...], float]
HEAD, ROBOT, UNIVERSAL, EXTENSION, COUPLING = 9, 45, 91, 98, 210
PER_MM: Final = 10_000.0  # and per degree
AXES_MAX: Final = 6
PER_AXIS: Final = 7  # numbers of an axis in param[] of kinematic 91, after the first seven
LOCKS: Final = 16
GROUP_SIZE: Final = 2  # a robot and what it is on
PARALLEL: Final = 0.999  # cosine of two axes that are no two directions


class Parameters:
    """The numbers of one kinematic: what a program wrote, else what the lists have."""

    def __init__(self, step: int, trafo: Trafo, written: Written) -> None:
        self.step, self.trafo = step, trafo
        self._written = written

    def param(self, index: int) -> float:
        """Return `param[index]` in the units of lists."""
        written = self._written.get((self.step, self.trafo.id, index))
        return self.trafo.number("param[]", index) if written is None else float(written)

    def hd(self, number: int) -> float:
        """Return an offset in mm or degrees; number: from 1, as in HD1."""
        return self.param(number - 1) / PER_MM

    def of(self, trafo: Trafo) -> "Parameters":
        """Return the numbers of another kinematic of the same step."""
        return Parameters(self.step, trafo, self._written)

    def refuse(self, parameter: str, value: object, allowed: str) -> Alarm:
        """Build the alarm of a value that does not fit."""
        shown = f"{value:g}" if isinstance(value, float) else value
        return Alarm(900442, parameter=parameter, id=self.trafo.id, value=shown, allowed=allowed)

    def number(self, name: str, indices: tuple[int, ...], param: int) -> float:
        """Return what has a name of its own and a place in `param[]` too, in units of lists."""
        if (self.step, self.trafo.id, param) in self._written:
            return self.param(param)
        if (name, indices) in self.trafo.values:
            return self.trafo.number(name, *indices)
        return self.param(param)

    def vector(self, name: str, indices: tuple[int, ...], param: int) -> Vector:
        """Return three numbers of this kind."""
        x, y, z = (self.number(name, (*indices, k), param + k) for k in range(3))
        return (x, y, z)


def robot(parameters: Parameters, tool_mm: float, name: str) -> ArticulatedRobot:
    """Build kinematic 45. Raises Alarm for an arm without length."""
    hd = [parameters.hd(number) for number in range(1, 16)]
    if hd[7] <= 0.0:
        raise parameters.refuse("HD8", hd[7], "a length above 0 mm (upper arm)")
    if hd[8] == 0.0 == hd[11]:
        raise parameters.refuse("HD9", 0.0, "a length other than 0 mm where HD12 is 0 (forearm)")
    return ArticulatedRobot(hd, tool_mm, name, kinematic_types()[ROBOT].axes)


def universal(parameters: Parameters, tool_mm: float, name: str) -> Universal:
    """Build kinematic 91. Raises Alarm for what the chain does not allow."""
    axes = _chain_axes(parameters, LINEAR)
    for place, axis in enumerate(axes):
        if axis.is_rotary != (place >= LINEAR):
            allowed = "1 for the first three axes and 2 for the others"
            kind = 2 if axis.is_rotary else 1
            raise parameters.refuse(f"axis[{place}].type", kind, allowed)
    trafo = parameters.trafo
    if len(axes) > LINEAR and trafo.has("rtcp") and trafo.number("rtcp") == 0.0:
        allowed = "1: a program writes the rotary axes themselves"
        raise parameters.refuse("rtcp", 0, allowed)
    place_mm, direction = _zero(parameters)
    return Universal(axes, _order(parameters, len(axes)), place_mm, direction, tool_mm, name)


def _zero(parameters: Parameters) -> tuple[Vector, Vector]:
    """Return zero position in mm and zero orientation."""
    x, y, z = parameters.vector("zero_position[]", (), 3)
    direction = unit(parameters.vector("zero_orientation[]", (), 0))
    if direction is None:
        raise parameters.refuse("zero_orientation[]", "0 0 0", "a direction")
    return (x / PER_MM, y / PER_MM, z / PER_MM), direction


def _chain_axes(parameters: Parameters, fewest: int) -> list[ChainAxis]:
    count = parameters.number("number_of_axes", (), 6)
    if not (fewest <= count <= AXES_MAX and count == int(count)):
        raise parameters.refuse("number_of_axes", count, f"{fewest} to {AXES_MAX}")
    axes = []
    for place in range(int(count)):
        first = 7 + PER_AXIS * place
        kind = parameters.number("axis[].type", (place,), first)
        if kind not in (1.0, 2.0):
            allowed = "1 (linear) and 2 (rotary)"
            raise parameters.refuse(f"axis[{place}].type", kind, allowed)
        direction = unit(parameters.vector("axis[].orientation[]", (place,), first + 1))
        if direction is None:
            raise parameters.refuse(f"axis[{place}].orientation[]", "0 0 0", "a direction")
        x, y, z = parameters.vector("axis[].point[]", (place,), first + 4)
        point = (x / PER_MM, y / PER_MM, z / PER_MM)
        axes.append(ChainAxis(kind == 2.0, direction, point))
    return axes


def _order(parameters: Parameters, count: int) -> list[int]:
    """Return the places of the axes from the base on; none written: as they are."""
    trafo = parameters.trafo
    if not trafo.has("chain[]"):
        return list(range(count))
    order = [int(trafo.number("chain[]", k)) for k in range(count)]
    if sorted(order) != list(range(count)):
        shown = " ".join(map(str, order))
        raise parameters.refuse("chain[]", shown, f"each of 0 to {count - 1} once")
    return order


def coupled(
    parameters: Parameters, members: Mapping[int, Trafo], tool_mm: float, name: str
) -> OnLinearAxes:
    """Build kinematic 210. Raises Alarm for a chain that is no robot on linear axes."""
    base, top = _chain(parameters, members)
    robot_parameters = parameters.of(top)
    slide = parameters.of(base)
    axes = _chain_axes(slide, 1)
    if len(axes) >= LINEAR or any(axis.is_rotary for axis in axes):
        allowed = "1 or 2 linear axes below a robot"
        raise slide.refuse("number_of_axes", len(axes), allowed)
    directions = [axis.direction for axis in axes]
    if len(axes) == GROUP_SIZE and _is_parallel(*directions):
        raise slide.refuse("axis[1].orientation[]", "that of axis[0]", "another direction")
    zero_mm, direction = _zero(slide)
    # Each base says where the frame below ends, seen from the frame above: here the other way round
    foot_mm, foot = _base(slide)
    seat_mm, seat = _base(robot_parameters)
    head = product(foot, least_turn(direction))
    origin_mm = _plus(foot_mm, _plus(turned(foot, zero_mm), turned(head, seat_mm)))
    locked = _locked(parameters, len(axes))
    robot_first = _priority(parameters, base, top)
    return OnLinearAxes(
        robot(robot_parameters, tool_mm, name),
        [turned(foot, way) for way in directions],
        origin_mm,
        product(head, seat),
        [not robot_first and not lock for lock in locked],
        [not lock for lock in locked],
        name,
    )


def _chain(parameters: Parameters, members: Mapping[int, Trafo]) -> tuple[Trafo, Trafo]:
    """Return the kinematics of the group, the lowest first."""
    words = _words(parameters, "group[].chain[]")
    found = [_member(word, members) for word in words]
    known = [trafo for trafo in found if trafo is not None]
    if [trafo.type for trafo in known] == [UNIVERSAL, ROBOT] and len(found) == GROUP_SIZE:
        return known[0], known[1]
    allowed = "ID or name of a kinematic 91 and then of a kinematic 45, each with its parameters"
    raise parameters.refuse("group[0].chain[]", " ".join(words) or "empty", allowed)


def _words(parameters: Parameters, name: str) -> list[str]:
    words = [parameters.trafo.word(name, 0, k) for k in range(GROUP_SIZE + 1)]
    return [word for word in words if word]


def _member(word: str, members: Mapping[int, Trafo]) -> Trafo | None:
    by_name = (trafo for trafo in members.values() if trafo.name == word)
    return members.get(int(word)) if word.isdecimal() else next(by_name, None)


def _priority(parameters: Parameters, base: Trafo, top: Trafo) -> bool:
    """Whether the robot takes a motion of the TCP first; so it is where nothing is written."""
    words = _words(parameters, "group[].move_prio[]")
    if not words:
        return True
    found = [_member(word, {base.id: base, top.id: top}) for word in words]
    if any(trafo is None for trafo in found) or len({id(trafo) for trafo in found}) < len(found):
        allowed = "each kinematic of the chain once"
        raise parameters.refuse("group[0].move_prio[]", " ".join(words), allowed)
    return found[0] is top


def _locked(parameters: Parameters, count: int) -> list[bool]:
    """Return which linear axes are locked."""
    locked = [bool(parameters.trafo.number("lock_dof[]", k)) for k in range(LOCKS)]
    allowed = range(AXES_MAX, AXES_MAX + count)
    for place, is_locked in enumerate(locked):
        if is_locked and place not in allowed:
            which = " and ".join(f"lock_dof[{k}]" for k in allowed)
            raise parameters.refuse(f"lock_dof[{place}]", 1, f"0; {which} lock linear axes")
    return [locked[place] for place in allowed]


def _base(parameters: Parameters) -> tuple[Vector, Rotation]:
    """Return place in mm and frame of a kinematic, seen from the one below (P-CHAN-00446)."""
    x, y, z, a, b, c = (parameters.trafo.number("base[]", k) / PER_MM for k in range(6))
    frame = inverse(from_angles(a, b, c)) if (a, b, c) != (0.0, 0.0, 0.0) else IDENTITY
    return turned(frame, (-x, -y, -z)), frame


def _plus(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _is_parallel(a: Vector, b: Vector) -> bool:
    cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return abs(cosine) > PARALLEL
