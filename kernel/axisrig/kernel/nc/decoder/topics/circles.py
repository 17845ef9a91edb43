"""Arcs: G2 and G3 with centre or radius. Geometry: `axisrig.kernel.nc.coordinates.circle`."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.coordinates import Arc, CircleWords
from axisrig.kernel.nc.coordinates.arc_parts import arc_parts
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Handler, Reader, Topic, silent
from axisrig.kernel.nc.syntax import Words

ARCS = ("G2", "G3")
CENTRE = "IJK"
# 2^31 steps of 0.1 um, and TF5200 programming manual 15556764811
CENTRE_MAX_MM = 214_748.3647
RADIUS_MAX_MM = 1e9


@dataclass
class Circle:
    """What stays from arc to arc.

    radius_mm: R, used by every arc whose block has no centre. centre_absolute: G161. corrected:
    G165. last: the last arc.
    """

    radius_mm: float | None = None
    centre_absolute: bool = False
    corrected: bool = True
    last: Arc | None = None


def arc(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """Decode the axis words of a block in which G2 or G3 is in use.

    Nothing moves without an axis word or a centre: `G2 R50` only says what comes.
    """
    values = context.axis_values(block, words)
    centre = _centre_words(context, block, words)
    if not values and not centre:
        return
    feed_mm_min = context.feed(block, context.modal.motion)
    coordinates, kept = context.coordinates, context.part(Circle)
    begin_mm = coordinates.base_mm
    made = coordinates.aim_arc(
        values, _circle_words(context, centre), absolute=context.modal.absolute
    )
    kept.last = made
    for part in arc_parts(made, begin_mm, coordinates.kinematic, coordinates.kinematic_axes):
        yield canon.ArcMove(
            block,
            part.target_mm,
            part.centre_mm,
            part.tangent,
            part.angle_rad,
            feed_mm_min,
        )


def refuse_centre(context: Context, block: Block, words: Words, function: str) -> None:
    """Raise Alarm 900153 for I, J or K in a block of a G function that makes no arc."""
    letter = next((name for name, _ in words.addresses if name in CENTRE), None)
    if letter is not None:
        raise context.alarm(900153, block, word=letter, where=f"with {function}")


def _centre_words(context: Context, block: Block, words: Words) -> Mapping[str, float]:
    """Give I, J, K of a block in mm; raises an alarm for those that do not go together."""
    centre: dict[str, float] = {}
    for letter, value in words.addresses:
        if letter not in CENTRE:
            continue
        if letter not in context.coordinates.centre_letters():
            where = f"in plane {context.coordinates.plane.g}"
            raise context.alarm(900153, block, word=letter, where=where)
        at_mm = context.value(block, value) * context.unit_mm
        if abs(at_mm) > CENTRE_MAX_MM:
            raise context.alarm(
                20020, block, word=letter, value_mm=f"{at_mm:g}", limit_mm=CENTRE_MAX_MM
            )
        centre[letter] = at_mm
    if centre and words.address("R") is not None:
        raise context.alarm(21024, block)
    return centre


def _circle_words(context: Context, centre: Mapping[str, float]) -> CircleWords:
    kept, clockwise = context.part(Circle), context.modal.motion == "G2"
    if not centre:
        return CircleWords(clockwise, radius_mm=kept.radius_mm)
    first, second = context.coordinates.centre_letters()
    return CircleWords(
        clockwise,
        centre=(centre.get(first, 0.0), centre.get(second, 0.0)),
        centre_absolute=kept.centre_absolute,
        corrected=kept.corrected,
        limits=context.tables.circle,
    )


def _choose(motion: str) -> Handler:
    def choose(context: Context, block: Block, words: Words) -> None:
        context.modal.motion = motion

    return silent(choose)


def _radius(context: Context, block: Block, words: Words) -> None:
    value = words.address("R")
    assert value is not None
    radius_mm = context.value(block, value) * context.unit_mm
    if abs(radius_mm) > RADIUS_MAX_MM:
        raise context.alarm(20054, block, value_mm=f"{radius_mm:g}", limit_mm=f"{RADIUS_MAX_MM:g}")
    context.part(Circle).radius_mm = radius_mm


def _set(**changes: bool) -> Handler:
    def change(context: Context, block: Block, words: Words) -> None:
        for name, value in changes.items():
            setattr(context.part(Circle), name, value)

    return silent(change)


def _last_radius(context: Context, block: Block, rest: str) -> float:
    last = context.part(Circle).last
    return 0.0 if last is None else last.plane.radius_mm / context.unit_mm


def _last_centre(letter: str) -> Reader:
    """V.G.I, J, K: from the start to the centre, as it was corrected."""

    def reader(context: Context, block: Block, rest: str) -> float:
        last = context.part(Circle).last
        letters = context.coordinates.centre_letters()
        if last is None or letter not in letters:
            return 0.0
        at = letters.index(letter)
        return (last.plane.centre[at] - last.plane.start[at]) / context.unit_mm

    return reader


TOPIC = Topic(
    read_addresses=("I", "J", "K", "R"),
    addresses={"R": silent(_radius)},
    settings={
        **{g: _choose(g) for g in ARCS},
        "G161": _set(centre_absolute=True),
        "G162": _set(centre_absolute=False),
        "G164": _set(corrected=False),
        "G165": _set(corrected=True),
    },
    readers={
        "V.G.R": _last_radius,
        **{f"V.G.{letter}": _last_centre(letter) for letter in CENTRE},
    },
)
