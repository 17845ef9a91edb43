"""Resolution of the motor encoder as an axis list gives it, in one of the two ways of the control.

By path (P-AXIS-00234 / 00233), or by turn: with P-AXIS-00092 increments in a turn of the motor,
gearbox P-AXIS-00511 / 00512 (turns of the motor / of its output) and feed constant P-AXIS-00362 /
00363 (path in a turn of the output) a millimetre has 00092 * (00511 / 00512) / (00362 / 00363)
increments (TF5200 axis parameters 131271307, examples in 427233931).
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from axisrig.kernel.parameters import ParameterSet, written
from axisrig.kernel.parameters.units import UNITS_PER_MM

COUNTS, PATHS = "getriebe[0].wegaufz", "getriebe[0].wegaufn"
PER_TURN: Final = "getriebe[0].incr_per_rev"
FEED, TURNS = "getriebe[0].feed_const_num", "getriebe[0].feed_const_denom"
GEAR_IN, GEAR_OUT = "getriebe[0].gear_fact_num", "getriebe[0].gear_fact_denom"
BY_PATH: Final = (COUNTS, PATHS)
BY_TURN: Final = (FEED, TURNS, PER_TURN, GEAR_IN, GEAR_OUT)
SCALING: Final = BY_PATH + BY_TURN


@dataclass(frozen=True)
class EncoderResolution:
    """Increments in a path of the load. numbers: of the parameters that give it."""

    increments: int
    path_mm: Fraction
    numbers: str

    @property
    def per_mm(self) -> Fraction:
        """Increments in a millimetre (a degree of a rotary axis)."""
        return self.increments / self.path_mm


def listed_resolution(parameters: ParameterSet) -> EncoderResolution | None:
    """Return what an axis list gives, None where it gives none.

    Raises UserError for both ways at once: the control needs one pair at 1 (TF5200 axis parameters
    117770763), which of them it would take is not printed.
    """
    by_turn = _is_used(parameters, (FEED, TURNS))
    if _is_used(parameters, BY_PATH):
        if by_turn:
            key = FEED if parameters.integer(FEED) != 1 else TURNS
            place = parameters.origin(key) or parameters.origin(COUNTS)
            assert place is not None
            raise place.error(
                "the list gives the resolution of the encoder twice: by path (P-AXIS-00234, 00233)"
                " and by feed constant (P-AXIS-00362, 00363)",
                value=f"{key} = {written(parameters.integer(key))}",
                allowed="one of both pairs at 1",
            )
        path = Fraction(parameters.integer(PATHS), UNITS_PER_MM)
        return EncoderResolution(parameters.integer(COUNTS), path, "P-AXIS-00234, P-AXIS-00233")
    if not by_turn or not parameters.integer(PER_TURN):
        return None
    feed, turns, per_turn, gear_in, gear_out = (parameters.integer(key) for key in BY_TURN)
    path = Fraction(feed, turns * UNITS_PER_MM) * Fraction(gear_out, gear_in)
    numbers = "P-AXIS-00092, 00362, 00363, 00511, 00512"
    return EncoderResolution(per_turn, path, numbers)


def counted_keys(parameters: ParameterSet) -> tuple[str, ...]:
    """Return the keys whose values the resolution that a list gives is made of."""
    if listed_resolution(parameters) is None:
        return ()
    return BY_TURN if _is_used(parameters, (FEED, TURNS)) else BY_PATH


def _is_used(parameters: ParameterSet, pair: tuple[str, ...]) -> bool:
    return any(parameters.integer(key) != 1 for key in pair)
