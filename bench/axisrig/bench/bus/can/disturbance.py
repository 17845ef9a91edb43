"""What may disturb a frame on the wire, and how long that takes."""

from collections.abc import Container
from typing import Final, NamedTuple

from axisrig.bench.bus.can.controller import Controller, Request
from axisrig.bench.bus.can.faults import FaultAction

FLAG_BITS, SUPERPOSED_FLAG_BITS, DELIMITER_BITS = 6, 12, 8
SUSPEND_BITS: Final = 8
"""How much longer than the intermission an error passive sender waits."""

AFTER_ACK_BITS: Final = 8
"""Acknowledge delimiter and end of frame."""


class Disturbance(NamedTuple):
    """What disturbs a frame on the wire.

    is_error: an error frame cuts it short. is_late: in its last bit, when the receivers have it.
    partners: further ports that send the same bits.
    seen_by: names of those who see its error before the others, None = all at once.
    is_unacknowledged: the error is the missing acknowledgement. is_cut: the sender lost its power.
    """

    action: FaultAction | None = None
    partners: tuple[tuple[Controller, Request], ...] = ()
    missed: Container[str] = ()
    seen_by: frozenset[str] | None = None
    is_error: bool = False
    is_late: bool = False
    is_unacknowledged: bool = False
    is_cut: bool = False
