"""Fault confinement of one CAN controller: its two error counters and the state they give.

Source: ISO 11898-1, fault confinement (the same rules as Robert Bosch GmbH, CAN Specification 2.0
(1991), part A, section 8). docs/can.md has the rules as a table, with those that cannot occur here.
"""

from enum import StrEnum
from typing import Final

PASSIVE_FROM: Final = 128
"""From this count on a controller is error passive."""

BUS_OFF_FROM: Final = 256
"""From this transmit error count on a controller is bus-off."""

REC_AFTER_SUCCESS: Final = 127
"""Where a received frame sets a receive error count above 127; any of 119..127 is allowed."""

TRANSMIT_STEP, RECEIVE_STEP, PRIMARY_STEP = 8, 1, 8


class ErrorState(StrEnum):
    """What a controller may do on the bus."""

    ACTIVE = "error active"
    PASSIVE = "error passive"
    BUS_OFF = "bus-off"


class ErrorCounters:
    """tec, rec: transmit and receive error count; both 0 at the start."""

    __slots__ = ("_is_off", "rec", "tec")

    def __init__(self) -> None:
        self.tec = self.rec = 0
        self._is_off = False

    @property
    def state(self) -> ErrorState:
        """Error state; bus-off stays until `reset`."""
        if self._is_off:
            return ErrorState.BUS_OFF
        passive = max(self.tec, self.rec) >= PASSIVE_FROM
        return ErrorState.PASSIVE if passive else ErrorState.ACTIVE

    def transmit_failed(self, *, is_unacknowledged: bool = False) -> None:
        """Count an error flag sent as transmitter.

        is_unacknowledged: for want of an acknowledge bit only. That does not count any more once
        the controller is passive: alone on a bus nobody becomes bus-off.
        """
        if is_unacknowledged and self.state is ErrorState.PASSIVE:
            return
        self.tec += TRANSMIT_STEP
        self._is_off = self._is_off or self.tec >= BUS_OFF_FROM

    def receive_failed(self, *, is_primary: bool = False) -> None:
        """Count an error seen as receiver.

        is_primary: it saw the error before the others and finds a dominant bit after its flag.
        """
        self.rec += RECEIVE_STEP + (PRIMARY_STEP if is_primary else 0)

    def transmitted(self) -> None:
        """Count a frame that got through."""
        self.tec = max(self.tec - 1, 0)

    def received(self) -> None:
        """Count a frame received without an error."""
        self.rec = REC_AFTER_SUCCESS if self.rec > REC_AFTER_SUCCESS else max(self.rec - 1, 0)

    def reset(self) -> None:
        """Start over: after the recovery from bus-off, and after power on."""
        self.tec = self.rec = 0
        self._is_off = False
