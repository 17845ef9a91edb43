"""Set and actual positions of an axis as the control keeps them, for drives of any family."""

from collections import deque
from typing import Final

from axisrig.kernel.drives.frozen_encoder import FrozenEncoder
from axisrig.kernel.drives.position_loop import LoopSettings, PositionLoop

POSITION_MAX: Final = 1 << 31  # a signed position of 32 bits, increments


class SetPoints:
    """What was sent to one axis, what came back, and how far they are apart.

    increments_per_mm: of the positions on the wire. lag_delay_cycles: P-AXIS-00191. jump_mm: the
    largest credible way from one actual position to the next.
    set_mm: sent last. is_still: the last two sent positions were the same. actual_increments: came
    last. jump_mm: a way that cannot be, None while there was none. has_jumped: so since
    the drive follows, so that no loop counts on where the axis is. leads_itself: the drive moves by
    itself (homing), so that there is no lag. may_jump: its position may jump to a new reference.
    loop: of an axis whose position loop the CNC closes; frozen watches the encoder of one that runs
    on with its last lag.
    """

    def __init__(
        self,
        increments_per_mm: float,
        lag_delay_cycles: int,
        jump_mm: float,
        loop: LoopSettings | None = None,
    ) -> None:
        self._per_mm = increments_per_mm
        self._lag_delay_cycles = lag_delay_cycles
        self._jump_increments = jump_mm * increments_per_mm
        self.set_mm = 0.0
        self.is_still = False
        self._set_history: deque[float] = deque(maxlen=lag_delay_cycles + 1)
        self._has_sent = False  # in this cycle
        self.actual_increments = 0
        self._actual_age: int | None = None  # cycles since the last actual position
        self.jump_mm: float | None = None
        self.has_jumped = False
        self.leads_itself = self.may_jump = False
        self.loop: PositionLoop | None = None
        self.frozen: FrozenEncoder | None = None
        if loop is not None:
            self.loop = PositionLoop(loop)
            self.frozen = FrozenEncoder(increments_per_mm, loop.period_s)

    def can_reach(self, position_mm: float) -> bool:
        """Whether a set position fits into 32 bits."""
        return abs(position_mm * self._per_mm) < POSITION_MAX

    @property
    def has_actual(self) -> bool:
        """Whether this cycle has delivered the actual position."""
        return self._actual_age == 0

    @property
    def actual_mm(self) -> float:
        """The actual position that came last."""
        return self.actual_increments / self._per_mm

    @property
    def lag_mm(self) -> float:
        """The CNC's position lag e(k) = s(k - d) - x(k), d = P-AXIS-00191.

        Before s(k) is sent, d = 0 has to do with s(k - 1). Where the CNC closes the position loop
        it is what the controller has computed last.
        Source: docs/ambiguities.md, "Two position lags".
        """
        if self.leads_itself:
            return 0.0
        if self.loop is not None:
            return self.loop.lag_mm
        history = self._set_history
        older = self._lag_delay_cycles - (not self._has_sent)
        place = len(history) - 1 - max(older, 0)
        return (history[max(place, 0)] if history else self.set_mm) - self.actual_mm

    def _take_actual(self, increments: int) -> None:
        moved, age = abs(increments - self.actual_increments), self._actual_age
        limit = self._jump_increments
        if moved > limit and not self.may_jump and age is not None and moved > limit * (age + 1):
            self.jump_mm, self.has_jumped = moved / self._per_mm, True
        self.actual_increments, self._actual_age = increments, 0

    def _note_sent(self, set_mm: float) -> None:
        self.set_mm = set_mm
        self._set_history.append(set_mm)
        self._has_sent = True
