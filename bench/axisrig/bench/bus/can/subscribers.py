"""Who takes the data frames of a port, by identifier."""

from collections.abc import Callable

Subscriber = Callable[[int, bytearray, float], None]
"""Called as subscriber(identifier, own copy of the data, timestamp in s)."""


class Subscribers:
    """The subscribers of one port, and which identifiers it has heard.

    by_id: identifier -> subscribers in their order; its owner changes it at any time. heard:
    identifiers in the order in which they came first; its owner empties it.
    """

    def __init__(self, by_id: dict[int, list[Subscriber]]) -> None:
        self.by_id = by_id
        self.heard: dict[int, None] = {}

    def give(self, can_id: int, data: bytes, timestamp_s: float) -> None:
        """Give a frame to whom it concerns."""
        subscribers = self.by_id.get(can_id)
        if subscribers:
            copy = bytearray(data)
            for subscriber in subscribers:
                subscriber(can_id, copy, timestamp_s)
        self.heard[can_id] = None
