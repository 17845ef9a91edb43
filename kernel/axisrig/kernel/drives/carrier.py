"""What the control asks of that which carries the words of its drives."""

from axisrig.kernel.errors import Alarm


class Carrier:
    """One segment: it begins each cycle, and says what is wrong with it. name: of the segment."""

    name: str

    def begin_cycle(self) -> None:
        """Let the drives of this segment take their set values and deliver actual ones."""
        raise NotImplementedError

    @property
    def holds_back(self) -> bool:
        """Whether the begin of the last cycle still waits; False where that cannot be known."""
        raise NotImplementedError

    def late(self) -> Alarm:
        """Return the alarm of a cycle whose begin was held back."""
        raise NotImplementedError

    def check(self) -> Alarm | None:
        """Return what is wrong with the segment as a whole, None when nothing is."""
        raise NotImplementedError


class Presence:
    """What the control shows of itself on all segments, beside the cycles."""

    def begin(self) -> None:
        """Show it from now on."""
        raise NotImplementedError

    def end(self) -> None:
        """Show it no more."""
        raise NotImplementedError
