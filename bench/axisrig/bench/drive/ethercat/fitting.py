"""Whether the SyncManagers are as a drive needs them. Source: docs/ethercat.md."""

from typing import Final

from axisrig.bench.drive.ethercat.description import Description
from axisrig.bench.drive.ethercat.process_data import Exchanged
from axisrig.bench.drive.ethercat.sync_managers import (
    INPUTS,
    MAILBOX_IN,
    MAILBOX_OUT,
    OUTPUTS,
    SyncManagers,
)

_MODE_BITS: Final = 0x0F


class Fitting:
    """Compares what a master has set with the description and the assigned PDOs of a drive."""

    def __init__(self, description: Description, managers: SyncManagers, data: Exchanged) -> None:
        self._description, self._managers, self._data = description, managers, data

    def has_mailbox(self) -> bool:
        """Whether both mailboxes are as the EEPROM says."""
        return self._is_mailbox(MAILBOX_OUT) and self._is_mailbox(MAILBOX_IN)

    def wrong(self) -> str | None:
        """Return the AL status code where outputs or inputs do not fit what is assigned."""
        if not self._carries(OUTPUTS, self._data.outputs.codec.size):
            return "INVALID_OUTPUTS"
        if not self._carries(INPUTS, self._data.inputs.codec.size):
            return "INVALID_INPUTS"
        return None

    def _is_mailbox(self, number: int) -> bool:
        wanted, manager = self._description.managers[number], self._managers[number]
        return manager.start == wanted.start and self._has(number, wanted.length)

    def _carries(self, number: int, size: int) -> bool:
        """Whether a SyncManager is as what it carries needs it; it may be anywhere."""
        return self._has(number, size) if size else not self._managers[number].is_enabled

    def _has(self, number: int, length: int) -> bool:
        wanted, manager = self._description.managers[number], self._managers[number]
        return (
            manager.is_enabled
            and manager.length == length
            and manager.control & _MODE_BITS == wanted.control & _MODE_BITS
        )
