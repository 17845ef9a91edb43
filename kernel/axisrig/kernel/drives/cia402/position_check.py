"""The actual position read over a second way before a drive follows set positions.

A drive that goes into operation takes the set position of that cycle, and the control makes it of
the actual position of the telegrams. What changes a telegram from the first one on looks like a
place where the axis stands, and the axis would jump by the difference. SDO reports the position
too, by other frames: a position that both report is the drive's own.
"""

from typing import Final

from axisrig.kernel.drives.cia402.latch_check import StandstillRoom
from axisrig.kernel.drives.cia402.objects import ObjectAccess, SdoError
from axisrig.kernel.errors import Alarm

POSITION_ACTUAL: Final = 0x6064
ATTEMPTS_MAX: Final = 10
"""Questions until the position counts as wrong: noise of an encoder may need more than one."""


class PositionCheck:
    """Asks one drive where it stands, and compares its answer with the telegrams around it.

    room: None where each cycle has room for SDO, else it is asked for. An axis without power may
    move: the answer has to lie within the telegrams from the last one before the question to the
    first one after the answer, widened by their own span and one increment. is_proved: it does.
    """

    def __init__(self, sdo: ObjectAccess, room: StandstillRoom | None = None) -> None:
        self._sdo, self._room = sdo, room
        self.is_proved = False
        self._question = 0
        self._is_asked = self._waits = False
        self._answer: int | None = None
        self._error: SdoError | None = None
        self._attempts = 0
        self._lowest = self._highest = 0

    def void(self) -> None:
        """Forget what has been proved: the drive may stand elsewhere."""
        self._question += 1  # answers to earlier questions do not count
        self.is_proved = self._is_asked = self._waits = False
        self._answer = self._error = None
        self._attempts = 0

    def step(self, axis: str, increments: int, per_mm: float) -> None:
        """Take the telegram of a cycle; to be called in every cycle until it is proved.

        Raises Alarm 900084 where both ways report different positions, 900085 where SDO reports
        none.
        """
        if self._waits:
            self._enter()
        if not self._is_asked:
            self._ask(increments)
            return
        self._lowest = min(self._lowest, increments)
        self._highest = max(self._highest, increments)
        if self._error is not None:
            self._retry(Alarm(900085, axis=axis, answer=str(self._error)))
        elif self._answer is not None:
            margin = self._highest - self._lowest + 1
            if self._lowest - margin <= self._answer <= self._highest + margin:
                self.is_proved = True
                return
            self._retry(
                Alarm(
                    900084,
                    axis=axis,
                    telegram_mm=f"{increments / per_mm:.4f}",
                    sdo_mm=f"{self._answer / per_mm:.4f}",
                )
            )

    def _retry(self, alarm: Alarm) -> None:
        """Ask once more with the next telegram; raise the alarm after the last attempt."""
        self._is_asked = False
        self._answer = self._error = None
        if self._attempts == ATTEMPTS_MAX:
            self._attempts = 0
            raise alarm

    def _ask(self, increments: int) -> None:
        self._attempts += 1
        self._is_asked = self._waits = True
        self._lowest = self._highest = increments
        self._enter()

    def _enter(self) -> None:
        """Send the question, where the segment has room for it now."""
        room, question = self._room, self._question
        if room is not None and not room.enter(waits_for_rest=False):
            return
        self._waits = False

        def take(result: bytes | SdoError) -> None:
            if room is not None:
                room.leave()
            if question != self._question:
                return
            if isinstance(result, SdoError):
                self._error = result
            else:
                self._answer = int.from_bytes(result, "little", signed=True)

        self._sdo.read(POSITION_ACTUAL, 0, take)
