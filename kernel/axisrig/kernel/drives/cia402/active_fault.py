"""Asks a drive for the fault that it has had since before anybody listened.

Emergencies are sent once, when the fault comes up. What is active afterwards is reported by 603F
(error code, CiA 402) and by the newest entry of the error history
1003:1 (CiA 301); a drive may lack both.
"""

from functools import partial

from axisrig.kernel.drives.cia402.objects import ObjectAccess, SdoError, object_name
from axisrig.kernel.profiles.canopen.emergency import meaning_of

ERROR_CODE, HISTORY = (0x603F, 0), (0x1003, 1)


class ActiveFault:
    """One question to one drive; without a client nobody is asked."""

    def __init__(self, sdo: ObjectAccess | None) -> None:
        self._sdo = sdo
        self._open = 0
        self._codes: dict[tuple[int, int], int] = {}

    def ask(self) -> None:
        """Ask; never waits."""
        if self._sdo is None:
            return
        for place in (ERROR_CODE, HISTORY):
            self._open += 1
            self._sdo.read(*place, partial(self._take, place))

    def _take(self, place: tuple[int, int], answer: bytes | SdoError) -> None:
        self._open -= 1
        if not isinstance(answer, SdoError):
            # The low word of an entry of 1003 is the code, the rest is the manufacturer's
            self._codes[place] = int.from_bytes(answer[:2], "little")

    @property
    def is_open(self) -> bool:
        """Whether an answer is still to come."""
        return self._open > 0

    def __str__(self) -> str:
        reported: dict[int, list[str]] = {}
        for place, code in self._codes.items():
            if code:
                reported.setdefault(code, []).append(object_name(*place))
        found = [
            f"{' and '.join(places)} {'say' if len(places) > 1 else 'says'} 0x{code:04X},"
            f" {meaning_of(code)}"
            for code, places in reported.items()
        ]
        return f"none, but {' and '.join(found)}" if found else "none"
