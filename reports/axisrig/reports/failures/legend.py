"""What the signs of a drawing are, beside it: only of those that are in it."""

import re

from markupsafe import Markup

_DOT = '<circle cx="7" cy="6" r="3.2"/>'
_CROSS = '<path d="M3,2l8,8m0,-8l-8,8"/>'
_BOX = '<rect x="0" y="2" width="14" height="8"/>'
_DASH = '<path d="M0,6h14"/>'
_UP = '<path d="M7,0v12"/>'
_KEYS = (
    ("dot sw-pass", _DOT, "passed", "g"),
    ("dot sw-marginal", _DOT, "marginal", "g"),
    ("dot sw-inconclusive", _CROSS, "inconclusive", "g"),
    ("dot sw-fail", _CROSS, "failed", "g"),
    ("dot sw-aborted", _CROSS, "aborted", "g"),
    ("dot sw-error", _CROSS, "error", "g"),
    ("sw-u", _UP, "uncertainty", ""),
    ("sw-limit", _DASH, "limit", ""),
    ("bar-in", _BOX, "allowed", ""),
    ("bar-marginal", _BOX, "marginal", ""),
    ("bar-inconclusive", _BOX, "inconclusive", ""),
    ("bar-value", '<rect x="6" y="0" width="3" height="12"/>', "value", ""),
    ("pic-signal", _DASH, "signal", ""),
    ("pic-limit", _DASH, "limit", ""),
    *((f"pic-mark k-{kind}", _UP, kind, "") for kind in ("contact", "edge", "latch")),
    *((f"pic-mark k-{kind}", _UP, kind, "") for kind in ("alarm", "fault")),
)
"""Class of the style sheet, how its sign is drawn, its word, whether the class is of a group."""


def legend(drawn: str) -> Markup:
    """Return a line that says what the signs in drawings mean, empty where there are none."""
    parts, words = [], set()
    for kind, sign, word, of in _KEYS:
        if word in words or not re.search(rf'class="{kind}[" ]', drawn):
            continue
        words.add(word)
        shown = f'<g class="{kind}">{sign}</g>' if of else sign.replace(" ", f' class="{kind}" ', 1)
        parts.append(
            f'<span><svg class="key-sign" viewBox="0 0 14 12" width="14" height="12"'
            f' aria-hidden="true">{shown}</svg> {word}</span>'
        )
    return Markup(f'<p class="legend">{"".join(parts)}</p>' if parts else "")
