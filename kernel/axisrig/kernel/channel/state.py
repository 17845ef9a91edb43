"""States of a channel."""

from enum import Enum, auto


class ChannelState(Enum):
    """STARTING over SDO, POWERING until every drive is enabled, RUNNING, STOPPING after an alarm,
    ENDED.

    While the PLC side goes on after a program: READY for the next one, in ERROR when an alarm has
    ended it; RESETTING until the axes rest, which leads to READY.
    """

    STARTING = auto()
    POWERING = auto()
    RUNNING = auto()
    STOPPING = auto()
    READY = auto()
    ERROR = auto()
    RESETTING = auto()
    ENDED = auto()


CONTROLLED = (ChannelState.RUNNING, ChannelState.READY)
AT_REST = (ChannelState.READY, ChannelState.ERROR)
FAILED = (ChannelState.STOPPING, ChannelState.ERROR)
