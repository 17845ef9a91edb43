"""A latched position read over a second way: SDO beside the PDOs.

What changes a telegram behind the CAN controller, sends its identifier too, or delivers it a run
late can pass every check of the cyclic telegrams. It does not change the answers of the SDO server
in the same way: a latch that both ways tell is the drive's own.
"""

from collections.abc import Callable

from kernel.drives.sdo import SdoClient, SdoError

PROBE_STATUS = 0x60B9
_SIGN = 1 << 31
_COUNTER_MASK = 0xFFFF


class LatchCheck:
    """Asks a drive for one edge of one probe: is it stored, where, and was it the only one?

    stored_bit: of 60B9. latch_object: 60BA to 60BD. counter_object: 60D5 to 60D8; a drive without
    it is believed without. All answers of one question count together.
    """

    def __init__(
        self, sdo: SdoClient, stored_bit: int, latch_object: int, counter_object: int
    ) -> None:
        self._sdo = sdo
        self._stored_bit = stored_bit
        self._latch_object, self._counter_object = latch_object, counter_object
        self._has_counter = True
        self._count_before: int | None = None
        self._question = 0
        self._is_asked = False
        self._status = self._value = self._count = 0
        self._is_answered = False

    def begin(self) -> None:
        """A run begins: forget what was told, and take note of the counter while nothing moves."""
        self._question += 1  # answers to earlier questions do not count
        self._is_asked = self._is_answered = False
        self._count_before = None
        if self._has_counter:
            self._read(self._counter_object, self._on_count_before)

    @property
    def is_ready(self) -> bool:
        """Whether the counter before the run is known, or the drive has none."""
        return not self._has_counter or self._count_before is not None

    def agrees(self, increments: int) -> bool:
        """Whether the drive has told this position by SDO; asks (again) when it has not."""
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
        question = self._question

        def take(result: bytes | SdoError) -> None:
            if question != self._question:
                return
            if isinstance(result, SdoError):
                self._refused(index, result)
            else:
                done(int.from_bytes(result, "little"))

        self._sdo.read(index, 0, take)

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
