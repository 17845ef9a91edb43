"""M, H and T functions: what is sent to the PLC side."""

from collections.abc import Iterator

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.syntax import Words

# They have a meaning of their own and are not sent. TF5200 M and H functions 285942155
INTERNAL = ("M0", "M1", "M2", "M17", "M29", "M30")
# They need a spindle, and no rig has one. TF5200 diagnosis 255149963
SPINDLE = ("M3", "M4", "M5", "M19", *(f"M{number}" for number in range(40, 46)))
# P-CHAN-00041, P-CHAN-00027: m_synch[i] and h_synch[i] with i from 0 to 999
NUMBER_MAX = 999
SENT = "HT"


def announce(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """Send the functions of a block to the PLC side, before its motion (MVS_SVS).

    It acknowledges at once. Every M and H number counts as defined in P-CHAN-00041 and 00027.
    Raises Alarm 21548 for functions of a spindle; 20160 and 900172 for numbers that no list can
    define.
    """
    for function in words.m:
        if function in SPINDLE:
            raise context.alarm(21548, block, spindles=0, release=0, number=function[1:])
        if function not in INTERNAL:
            yield _sent(context, block, "M", int(function[1:]))
    for letter, value in words.addresses:
        if letter in SENT:
            # Rounded to a whole number. TF5200 programming manual 206761227
            yield _sent(context, block, letter, round(context.value(block, value)))


def _sent(context: Context, block: Block, letter: str, number: int) -> canon.Command:
    if letter != "T" and not 0 <= number <= NUMBER_MAX:
        alarm_id = 20160 if letter == "M" else 900172
        raise context.alarm(alarm_id, block, word=f"{letter}{number}", upper=NUMBER_MAX)
    return canon.TechnologyFunction(block, letter, number)
