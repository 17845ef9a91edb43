"""What a DCF writes into a drive against the list of its axis and the scaling of its rig.

The kernel writes the values of a DCF at start-up; so a reversed or scaled position is refused on
paper, and narrower limits are named. Source: CiA 402-2 (607E, 608F, 6091, 6092, 607D, 6065).
"""

from collections.abc import Iterator
from fractions import Fraction
from typing import Final

from canopen.objectdictionary import ObjectDictionary

from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.dcf import dcf_value, dcf_values
from axisrig.kernel.drives.canopen.dictionary import variable
from axisrig.kernel.errors import UserError

POLARITY, POSITION_BIT, WINDOW, LIMITS = 0x607E, 0x80, 0x6065, 0x607D
ENCODER, GEAR, FEED = 0x608F, 0x6091, 0x6092
SCALING: Final = ((ENCODER, 1), (ENCODER, 2), (GEAR, 1), (GEAR, 2), (FEED, 1), (FEED, 2))


def check_dcf(settings: Settings, name: str, od: ObjectDictionary) -> None:
    """Refuse a DCF that turns or scales the position otherwise than the rig; raises UserError."""
    polarity = dcf_value(od, POLARITY, 0)
    if polarity is not None and polarity & POSITION_BIT:
        raise UserError(
            "its DCF reverses the position (607E, bit 7), and the list does not",
            value=f"0x{polarity:X}",
            allowed="607E = 0",
            hint="take it out of the DCF, or turn the axis in the list and in its plant",
        )
    if not any(dcf_value(od, *place) is not None for place in SCALING):
        return
    values = [_value(od, *place) for place in SCALING]
    if None in values or 0 in values:
        return  # the start-up compares what the drive says
    increments, revolutions, motor, shaft, feed, feed_shaft = (value or 1 for value in values)
    units = Fraction(feed * shaft, feed_shaft * motor)  # position units per motor revolution
    profile = drive_of(settings, name).make()
    wanted = Fraction(profile.units_per_revolution)
    encoder = Fraction(increments, revolutions)
    if units != wanted or encoder != profile.encoder_increments:
        raise UserError(
            "its DCF scales the position otherwise than the rig (608F, 6091, 6092)",
            value=f"{encoder} increments and {units} position units per revolution",
            allowed=f"{profile.encoder_increments} and {wanted}",
            hint="change the DCF, or encoder_increments and position_factor of the drive",
        )


def dcf_warnings(settings: Settings, name: str, od: ObjectDictionary) -> Iterator[str]:
    """Name limits of a DCF that act before those of the list, and count what it writes."""
    count = sum(1 for _ in dcf_values(od))
    if not count:
        return
    per_mm = drive_of(settings, name).make().units_per_mm
    parameters = settings.axis[name]
    window = dcf_value(od, WINDOW, 0)
    lag_mm = drive_of(settings, name).lag_limit_mm
    if window is not None and lag_mm and window / per_mm < lag_mm:
        yield (
            f"its DCF has a following error window of {float(window / per_mm):.3f} mm (6065), the"
            f" rig allows a lag of {lag_mm:g} mm: the drive stops first"
        )
    for sub, key, sign in ((1, "kenngr.swe_neg", -1), (2, "kenngr.swe_pos", 1)):
        limit, wanted_mm = dcf_value(od, LIMITS, sub), parameters.mm(key)
        if limit is not None and sign * limit / per_mm < sign * Fraction(wanted_mm):
            yield (
                f"its DCF limits the position to {float(limit / per_mm):.3f} mm (607D:{sub}), the"
                f" list to {wanted_mm:g} mm ({key}): the drive stops first"
            )
    yield f"its DCF has {count} values that the kernel writes at start-up"


def _value(od: ObjectDictionary, index: int, sub: int) -> int | None:
    found = dcf_value(od, index, sub)
    if found is not None:
        return found
    item = variable(od, index, sub)
    return item.default if item is not None and isinstance(item.default, int) else None
