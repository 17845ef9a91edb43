"""What DIST_CTRL may say that its table does not limit: keywords that exclude or need each other.

Sources: FCT-M3 6; TF5200 distance control 15548060043 (ON, OFF, FREEZE, CHECK_POS and REF exclude
each other in one command), programming manual 208654987 (WAIT).
"""

from collections.abc import Mapping, Sequence
from typing import Final

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.values import ExpressionBuilder

NAME: Final = "DIST_CTRL"
ACTIONS: Final = ("ON", "DRYRUN", "OFF", "FREEZE", "CHECK_POS", "REF")
NEEDS: Final[Mapping[str, tuple[str, ...]]] = {
    "CONST_DIST": ("ON", "DRYRUN"),
    "NO_MOVE": ("OFF",),
    "WAIT": ("ON", "DRYRUN", "OFF", "FREEZE"),
}
SPELLINGS: Final = (("N_CYCLES", "DISTC_N_CYCLES"), ("ORDER", "DISTC_ORDER"))


def check(
    builder: ExpressionBuilder,
    shown: str,
    written: Sequence[str],
    places: Mapping[str, int],
    offset: int,
) -> None:
    """Raise UserError for keywords that exclude each other.

    shown: the command as messages name it. written: its keywords in order; places: where they are.
    """

    def wrong(message: str, word: str, allowed: object) -> UserError:
        at = places.get(word, offset)
        return builder.source.error(message, at, value=word, allowed=allowed)

    actions = [word for word in written if word in ACTIONS]
    if len(set(actions)) > 1:
        message = f"{actions[0]} and {actions[1]} of {shown} exclude each other"
        raise wrong(message, actions[1], "one of them")
    for word, needed in NEEDS.items():
        if word in written and not set(needed) & set(actions):
            raise wrong(f"{word} of {shown} needs {' or '.join(needed)}", word, needed)
    for pair in SPELLINGS:
        if set(pair) <= set(written):
            raise wrong(f"{pair[0]} and {pair[1]} of {shown} are the same", pair[1], pair[0])
    if not written:
        raise builder.source.error(f"{shown}] says nothing", offset, allowed=ACTIONS)
