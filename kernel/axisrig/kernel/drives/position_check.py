"""The actual position read over a second way before a drive follows set positions.

A drive that goes into operation takes the set position of that cycle, and the control makes it of
the actual position of the telegrams. What changes a telegram from the first one on looks like a
place where the axis stands, and the axis would jump by the difference. A drive reports its position
beside the cycle too (SDO, service channel): a position that both report is the drive's own.
"""

from collections.abc import Callable
from typing import Final

from axisrig.kernel.errors import Alarm

Answered = Callable[[int | str], None]
"""Takes the position, increments, or in words why the drive reports none."""
Ask = Callable[[Answered], bool]
"""Asks the drive beside the cycle where it stands; False: there is no room for that now."""
ATTEMPTS_MAX: Final = 10
"""Questions until the position counts as wrong: noise of an encoder may need more than one."""


class PositionCheck:
    """Asks one drive where it stands, and compares its answer with the telegrams around it.

    way: what it is asked for, and how. An axis without power may move: the answer has to lie within
    the telegrams from the last one before the question to the first one after the answer, widened
    by their own span and one increment. is_proved: it does.
    """

    def __init__(self, ask: Ask, way: str) -> None:
        self._ask_drive, self._way = ask, way
        self.is_proved = False
        self._question = 0
        self._is_asked = self._waits = False
        self._answer: int | None = None
        self._refusal: str | None = None
        self._attempts = 0
        self._lowest = self._highest = 0

    def void(self) -> None:
        """Forget what has been proved: the drive may stand elsewhere."""
        self._question += 1  # answers to earlier questions do not count
        self.is_proved = self._is_asked = self._waits = False
        self._answer = self._refusal = None
        self._attempts = 0

    def step(self, axis: str, increments: int, per_mm: float) -> None:
        """Take the telegram of a cycle; to be called in every cycle until it is proved.

        Raises Alarm 900084 where both ways report different positions, 900085 where the second one
        reports none.
        """
        if self._waits:
            self._enter()
        if not self._is_asked:
            self._ask(increments)
            return
        self._lowest = min(self._lowest, increments)
        self._highest = max(self._highest, increments)
        if self._refusal is not None:
            self._retry(Alarm(900085, axis=axis, way=self._way, answer=self._refusal))
        elif self._answer is not None:
            margin = self._highest - self._lowest + 1
            if self._lowest - margin <= self._answer <= self._highest + margin:
                self.is_proved = True
                return
            self._retry(
                Alarm(
                    900084,
                    axis=axis,
                    way=self._way,
                    telegram_mm=f"{increments / per_mm:.4f}",
                    asked_mm=f"{self._answer / per_mm:.4f}",
                )
            )

    def _retry(self, alarm: Alarm) -> None:
        """Ask once more with the next telegram; raise the alarm after the last attempt."""
        self._is_asked = False
        self._answer = self._refusal = None
        if self._attempts == ATTEMPTS_MAX:
            self._attempts = 0
            raise alarm

    def _ask(self, increments: int) -> None:
        self._attempts += 1
        self._is_asked = self._waits = True
        self._lowest = self._highest = increments
        self._enter()

    def _enter(self) -> None:
        """Send the question, where there is room for it now."""
        question = self._question

        def take(found: int | str) -> None:
            if question != self._question:
                return
            if isinstance(found, int):
                self._answer = found
            else:
                self._refusal = found

        self._waits = not self._ask_drive(take)
