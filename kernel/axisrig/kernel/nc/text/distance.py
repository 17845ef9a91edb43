"""What DIST_CTRL and #DIST CTRL may say that their tables do not limit.

Some keywords exclude each other, some need another one.

Sources: FCT-M3 6; TF5200 distance control 15548060043 (ON, OFF, FREEZE, CHECK_POS and REF exclude
each other in one command), programming manual 208654987 (WAIT). `Z[DIST_CTRL]` alone is OFF
(FCT-M3 6), and WAIT of #DIST CTRL may be beside every action (FCT-M3 12.2).
"""

from collections.abc import Mapping, Sequence
from typing import Final

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.values import ExpressionBuilder

NAME: Final = "DIST_CTRL"
MODES: Final = ("SURFACE", "CONST_DIST")
ACTIONS: Final = ("ON", "DRYRUN", "OFF", "FREEZE", "CHECK_POS", "REF")
NEEDS: Final[Mapping[str, tuple[str, ...]]] = {
    "CONST_DIST": ("ON", "DRYRUN"),
    "SURFACE": ("ON", "DRYRUN"),
    "NO_MOVE": ("OFF",),
    "WAIT": ("ON", "DRYRUN", "OFF", "FREEZE"),
}
SPELLINGS: Final = (
    ("N_CYCLES", "DISTC_N_CYCLES"),
    ("ORDER", "DISTC_ORDER"),
    ("N_CYCLES", "FILTER_TIME"),
)


def check(
    builder: ExpressionBuilder,
    shown: str,
    written: Sequence[str],
    places: Mapping[str, int],
    offset: int,
    *,
    has_brackets: bool = True,
) -> None:
    """Raise UserError for keywords that exclude each other.

    shown: the command as messages name it. written: its keywords in order; places: where they are.
    has_brackets: `#DIST CTRL []` sets no parameter, which is one of its printed forms; a command
    without brackets and words is none.
    """

    def wrong(message: str, word: str, allowed: object) -> UserError:
        at = places.get(word, offset)
        return builder.source.error(message, at, value=word, allowed=allowed)

    actions = list(dict.fromkeys(word for word in written if word in ACTIONS))
    modes = [word for word in written if word in MODES]
    for both in (actions, modes):
        if len(both) > 1:
            message = f"{both[0]} and {both[1]} of {shown} exclude each other"
            raise wrong(message, both[1], "one of them")
    is_of_axis = "[" in shown
    needs = dict(NEEDS) if is_of_axis else {**NEEDS, "WAIT": ACTIONS}
    for word, needed in needs.items():
        if word in written and not set(needed) & set(actions):
            raise wrong(f"{word} of {shown} needs {' or '.join(needed)}", word, needed)
    for pair in SPELLINGS:
        if set(pair) <= set(written):
            raise wrong(f"{pair[0]} and {pair[1]} of {shown} are the same", pair[1], pair[0])
    if not written and not (is_of_axis or has_brackets):
        raise builder.source.error(f"{shown} says nothing", offset, allowed=ACTIONS)
