"""A latched position read over a second way: SDO beside the PDOs.

What changes a telegram after the CAN controller, sends its identifier too, or delivers it a run
late can pass every check of the cyclic telegrams. It does not change the answers of the SDO server
in the same way: a latch that both ways report is the drive's own.

On a segment that has no room for SDO in each cycle there may be room while none of its axes moves
(`StandstillRoom`): a telegram that comes a cycle late then reports the same as the one before.
"""

from collections.abc import Callable, Sequence
from typing import Final, Protocol

from axisrig.kernel.drives.cia402.objects import ObjectAccess, SdoError

PROBE_STATUS: Final = 0x60B9
_SIGN: Final = 1 << 31
_COUNTER_MASK: Final = 0xFFFF


class Resting(Protocol):
    """A drive as its segment sees it.

    is_still: its last two set positions were the same. is_disturbed: a telegram of the last SYNC
    is missing.
    """

    @property
    def is_still(self) -> bool: ...  # noqa: D102
    @property
    def is_disturbed(self) -> bool: ...  # noqa: D102


class StandstillRoom:
    """Room for one SDO transfer at a time on a segment, while none of its axes moves.

    links: of all drives of the segment. Request and answer may each keep a telegram from coming in
    its cycle; the next transfer waits for a cycle with all telegrams, so that never more than two
    in a row are missing.
    """

    def __init__(self, links: Sequence[Resting]) -> None:
        self._links = links
        self._is_taken = False

    @property
    def is_open(self) -> bool:
        """Whether every axis of the segment is at rest."""
        return all(link.is_still for link in self._links)

    def enter(self, *, waits_for_rest: bool = True) -> bool:
        """Take the room for one transfer, if it is free; without rest where no drive has power."""
        if self._is_taken or (waits_for_rest and not self.is_open):
            return False
        if any(link.is_disturbed for link in self._links):
            return False
        self._is_taken = True
        return True

    def leave(self) -> None:
        """Give it back: the transfer is over."""
        self._is_taken = False


class LatchCheck:
    """Asks a drive for one edge of one probe: is it stored, where, and was it the only one?

    stored_bit: of 60B9. latch_object: 60BA to 60BD. counter_object: 60D5 to 60D8; a drive without
    it is believed without. All answers of one question count together. room: None where each cycle
    has room for SDO; else it is asked for, and a run during which another axis of the segment moves
    has no proof (`is_possible`).
    """

    def __init__(
        self,
        sdo: ObjectAccess,
        stored_bit: int,
        latch_object: int,
        counter_object: int,
        room: StandstillRoom | None = None,
    ) -> None:
        self._sdo, self._room = sdo, room
        self.is_possible = True
        self._waiting: Callable[[], None] | None = None
        self._stored_bit = stored_bit
        self._latch_object, self._counter_object = latch_object, counter_object
        self._has_counter = True
        self._count_before: int | None = None
        self._question = 0
        self._is_asked = False
        self._status = self._value = self._count = 0
        self._is_answered = False

    def begin(self) -> None:
        """A run begins: forget earlier reports, and read the counter while nothing moves."""
        self._question += 1  # answers to earlier questions do not count
        self._is_asked = self._is_answered = False
        self._waiting = None
        self.is_possible = self._room is None or self._room.is_open
        if not self.is_possible:
            return
        self._count_before = None
        if self._has_counter:
            self._read(self._counter_object, self._on_count_before)

    @property
    def is_ready(self) -> bool:
        """Whether the counter before the run is known, or the drive has none.

        To be asked in every cycle, as `agrees`: what waits for room asks then.
        """
        self._go_on()
        return not (self.is_possible and self._has_counter and self._count_before is None)

    def _go_on(self) -> None:
        """Send what waits for room, or give the proof up when an axis of the segment moves."""
        if self._room is None or self._waiting is None:
            return
        if not self._room.is_open:
            self.is_possible, self._waiting = False, None
        elif self._room.enter():
            waiting, self._waiting = self._waiting, None
            waiting()

    def agrees(self, increments: int) -> bool:
        """Whether the drive has reported this position by SDO; asks (again) when it has not."""
        self._go_on()
        if self._is_answered:
            self._is_answered = False
            value = self._value - 2 * _SIGN if self._value & _SIGN else self._value
            if self._status & self._stored_bit and value == increments and self._is_only_one():
                return True
        if not self._is_asked:
            self._is_asked = True
            self._read(PROBE_STATUS, self._on_status)
        return False

    def _is_only_one(self) -> bool:
        if not self._has_counter:
            return True
        return self._count_before is not None and (
            self._count - self._count_before & _COUNTER_MASK == 1
        )

    def _read(self, index: int, done: Callable[[int], None]) -> None:
        question, room = self._question, self._room

        def take(result: bytes | SdoError) -> None:
            if room is not None:
                room.leave()
            if question != self._question:
                return
            if isinstance(result, SdoError):
                self._refused(index, result)
            else:
                done(int.from_bytes(result, "little"))

        if room is None:
            self._sdo.read(index, 0, take)
        else:
            self._waiting = lambda: self._sdo.read(index, 0, take)

    def _refused(self, index: int, error: SdoError) -> None:
        # Silence is no proof that the drive has no counter
        if index == self._counter_object and error.code is not None:
            self._has_counter = False
            self._is_answered, self._is_asked = self._is_asked, False
        else:
            self._is_asked = False

    def _on_count_before(self, count: int) -> None:
        self._count_before = count

    def _on_status(self, status: int) -> None:
        self._status = status
        self._read(self._latch_object, self._on_value)

    def _on_value(self, value: int) -> None:
        self._value = value
        if self._has_counter:
            self._read(self._counter_object, self._on_count)
        else:
            self._is_asked, self._is_answered = False, True

    def _on_count(self, count: int) -> None:
        self._count = count
        self._is_asked, self._is_answered = False, True
