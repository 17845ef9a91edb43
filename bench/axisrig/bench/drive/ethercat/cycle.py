"""What gives a drive on EtherCAT its clock: SYNC0, the outputs, or its own cycle (free run).

Source: docs/ethercat.md.
"""

from collections.abc import Callable
from enum import IntEnum
from functools import partial
from typing import ClassVar, Final

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore, Owner
from axisrig.bench.drive.ethercat.objects import INPUT_SYNC, OUTPUT_SYNC
from axisrig.bench.drive.ethercat.sync_unit import SyncUnit
from axisrig.kernel.time.clock import Clock, Phase, TimeNs

_TYPE, _CYCLE, _LEAST, _MISSED, _ERROR = 1, 2, 5, 11, 32
_COUNT_MAX: Final = 0xFFFF
_INPUT_WITH_OUTPUTS: Final = 34


class Timing(IntEnum):
    """What gives the clock, as 1C32:01 numbers it."""

    FREE_RUN = 0
    OUTPUTS = 1
    SYNC0 = 2


class CycleClock(Owner):
    """Calls `cycle` as the timing says. period_ns(): 60C2. least_ns: of SYNC0 that the drive takes.

    timing: of SAFEOP and OP. missed: SYNC0 without outputs, in all; missing: in a row. lost(): so
    many in a row that the drive gives up, `limit` of them, 0 = never.
    """

    objects: ClassVar[tuple[int, ...]] = (OUTPUT_SYNC, INPUT_SYNC)

    def __init__(
        self,
        clock: Clock,
        store: ObjectStore,
        sync: SyncUnit,
        period_ns: Callable[[], TimeNs],
        least_ns: TimeNs,
        cycle: Callable[[], None],
        may_change: Callable[[], bool],
    ) -> None:
        self._clock, self._store, self._sync = clock, store, sync
        self._period_ns, self._least_ns, self._cycle = period_ns, least_ns, cycle
        self._may_change = may_change
        self.timing = Timing.OUTPUTS
        self.missed = self.missing = 0
        self._has_outputs = False
        self._train = 0
        self.is_running = False

    def start(self) -> str | None:
        """Begin as SYNC0 and 1C32:01 say; return the AL status code that refuses."""
        self.stop()
        wanted = Timing(self._store.value(OUTPUT_SYNC, _TYPE))
        has_sync0 = self._sync.has_sync0
        if has_sync0 and not self._sync.cycle0:
            return "INVALID_DC"
        if wanted is Timing.SYNC0 and not has_sync0:
            return "INVALID_DC"
        self.timing = Timing.SYNC0 if has_sync0 else wanted
        self.missed = self.missing = 0
        self.is_running = True
        if self.timing is Timing.FREE_RUN:
            self._next(self._train)
        return None

    def stop(self) -> None:
        """Give no clock."""
        self.is_running = False
        self._has_outputs = False
        self._train += 1

    def disagrees(self) -> str | None:
        """Return the AL status code where SYNC0 is not the cycle of the drive."""
        if self.timing is not Timing.SYNC0:
            return None
        if self._sync.cycle0 < self._least_ns:
            return "INVALID_SYNC0_CYCLE"
        return None if self._sync.cycle0 == self._period_ns() else "INVALID_SYNC_CYCLE"

    @property
    def has_begun(self) -> bool:
        """Whether what gives the clock has come."""
        return self.timing is not Timing.SYNC0 or self._sync.pulses > 0

    @property
    def cycle_ns(self) -> TimeNs:
        """Time from one cycle to the next."""
        if self.timing is Timing.SYNC0:
            return self._sync.cycle0
        return max(self._period_ns(), self._least_ns)

    @property
    def has_clock(self) -> bool:
        """Whether SYNC0 is active, where it is the clock."""
        return self.timing is not Timing.SYNC0 or self._sync.has_sync0

    def outputs_came(self) -> None:
        """Take note of outputs, at the end of their frame."""
        self._has_outputs = True
        if self.is_running and self.timing is Timing.OUTPUTS:
            self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, self._with_outputs)

    def sync0(self) -> None:
        """Take a SYNC0."""
        if self.is_running and self.timing is Timing.SYNC0:
            if self._has_outputs:
                self.missing = 0
            else:
                self.missing += 1
                self.missed = min(self.missed + 1, _COUNT_MAX)
            self._has_outputs = False
            self._cycle()

    def _with_outputs(self) -> None:
        if self.is_running and self.timing is Timing.OUTPUTS:
            self._cycle()

    def _next(self, train: int) -> None:
        at_ns = self._clock.now_ns + self.cycle_ns
        self._clock.call_at(at_ns, Phase.APPLICATION, partial(self._run, train))

    def _run(self, train: int) -> None:
        if train == self._train:
            self._next(train)
            self._cycle()

    # The objects

    def read(self, index: int, sub: int) -> int | None:
        """Say what runs now."""
        if sub == _TYPE and self.is_running:
            is_input = index == INPUT_SYNC and self.timing is Timing.OUTPUTS
            return _INPUT_WITH_OUTPUTS if is_input else int(self.timing)
        if sub == _CYCLE:
            return self.cycle_ns
        if sub == _LEAST:
            return self._least_ns
        if sub == _MISSED:
            return self.missed
        return int(self.missing > 0) if sub == _ERROR else None

    def check(self, index: int, sub: int, value: int) -> None:
        """The timing changes in PREOP only; a write of what is there changes nothing."""
        present = self.read(index, sub)
        is_same = value in (self._store.value(index, sub), present)
        if not is_same and not self._may_change():
            abort(AbortCode.DEVICE_STATE)
