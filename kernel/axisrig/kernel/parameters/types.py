"""The data types of the manuals and how a list writes their values."""

import math
from collections.abc import Mapping

Value = bool | int | float | str

INTEGER_RANGES: Mapping[str, tuple[int, int]] = {
    "BOOL": (0, 1),
    "UNS08": (0, 2**8 - 1),
    "UNS16": (0, 2**16 - 1),
    "UNS32": (0, 2**32 - 1),
    "SGN08": (-(2**7), 2**7 - 1),
    "SGN16": (-(2**15), 2**15 - 1),
    "SGN32": (-(2**31), 2**31 - 1),
}
_TRUTH = {"TRUE": True, "FALSE": False}  # lists of external variables write them so
_DIGITS_MAX = 400  # more than any number of these types has; int() refuses more than 4300


def convert(text: str, type_name: str) -> Value:
    """Turn written text into a value of a manual's type; raise ValueError if it is not of it."""
    if type_name == "STRING":
        return text
    if "_" in text or len(text) > _DIGITS_MAX:  # Python would take _ as a separator of digits
        raise ValueError(text)
    if type_name == "REAL64":
        number = float(text)
        if not math.isfinite(number):
            raise ValueError(text)
        return number
    if type_name == "BOOL" and text.upper() in _TRUTH:
        return _TRUTH[text.upper()]
    whole = int(text, 16) if text.lower().startswith("0x") else int(text)
    if type_name == "BOOL" and whole in (0, 1):
        return bool(whole)
    return whole


def written(value: Value) -> str:
    """Write a value as the lists of the manuals do: BOOL as 0 or 1."""
    return str(int(value)) if isinstance(value, bool) else str(value)
