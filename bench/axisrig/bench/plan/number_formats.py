"""What a number format of an XLSX workbook makes of a number: a percentage, a date, or the number.

Source: ECMA-376-1 18.8.30 (numFmt: IDs that every program knows), 18.8.31 (sections, quotes,
brackets, signs that are shown as they are).
"""

import re
from collections.abc import Sequence
from typing import Final

_PERCENT: Final = frozenset({9, 10})
# 27 to 36 and 50 to 58 are dates in East Asian languages
_DATE: Final = frozenset({*range(14, 23), *range(27, 37), *range(45, 48), *range(50, 59)})
_CUSTOM_FROM: Final = 164
# Quoted text, a sign shown as it is, blanks as wide as a sign, colours, conditions, languages
_SHOWN: Final = re.compile(r'"[^"]*"|\\.|_.|\*.|\[(?!(?:h+|m+|s+)\])[^\]]*\]', re.IGNORECASE)


def shows(format_id: int, code: str | None) -> str:
    """Return "percent", "date", or "" for a number.

    format_id: `numFmtId` of the cell's style. code: its `formatCode`, where the workbook has one.
    """
    if code is None:
        if format_id < _CUSTOM_FROM:
            return "percent" if format_id in _PERCENT else "date" if format_id in _DATE else ""
        return ""
    bare = _SHOWN.sub("", code).split(";")[0].lower()
    if "general" in bare:
        return ""
    if "%" in bare:
        return "percent"
    return "date" if set(bare) & set("ymdhs") else ""


def styles_shown(formats: Sequence[tuple[int, str]], styles: Sequence[int]) -> list[str]:
    """Return what each style of cells shows (`shows`).

    formats: ID and code of each `numFmt`. styles: `numFmtId` of each `xf` of `cellXfs`.
    """
    codes = dict(formats)
    return [shows(style, codes.get(style)) for style in styles]
