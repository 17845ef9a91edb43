"""Writes by SDO that a drive, or its state, does not allow."""

from collections.abc import Collection
from typing import Final

from axisrig.bench.drive.axis.motion import Motion
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.states import BY_LIMIT, OPTIONS, POWERED
from axisrig.kernel.profiles.cia402.ds402 import State

INVALID_VALUE: Final = 0x06090030
NOT_NOW: Final = 0x08000022
"""Abort codes of CiA 301."""

_MODE: Final = 0x6060
_HALT: Final = 1 << 8  # of the controlword
_SCALING: Final = (0x608F, 0x6091, 0x6092, 0x60E6, 0x60EB)
_OPTION_CODES: Final = frozenset(index for index, _ in OPTIONS)


def refusal(
    index: int,
    value: int,
    modes: Collection[int],
    profile: DriveProfile,
    motion: Motion,
    state: State,
    image: ProcessImage,
) -> int | None:
    """Return the abort code of a write that is not allowed, None for one that is.

    modes: that the drive has. image: with the controlword.
    """
    if index == _MODE and value not in modes:
        return INVALID_VALUE
    is_halted = bool(image.controlword & _HALT)
    if index == _MODE and is_halted and profile.mode_change == "not_halted":
        return NOT_NOW
    if value not in profile.option_values.get(index, (value,)):
        return INVALID_VALUE
    if index in _OPTION_CODES and not motion.controls_velocity:
        option = OPTIONS.get((index, value))
        if option is not None and option.reaction in BY_LIMIT:
            return INVALID_VALUE
    if index in _SCALING and state in POWERED:
        return NOT_NOW
    return None
