"""What the control asks of the latch of a drive that only takes a speed."""


class ProbeLatch:
    """One latch. echo_cycles: from an image to the one that was made after it.

    place: where the axis was in the first telegram with a value, increments. travel: its way in
    the cycle before. `_age`: telegrams since what is sent has changed; `_raw`: value of the one
    before, None without one.
    """

    def __init__(self, echo_cycles: int) -> None:
        self._echo, self._age = echo_cycles, 0
        self._raw: int | None = None
        self.place = self.travel = 0

    def _is_old(self) -> bool:
        """Count a telegram; return whether it was made before the last change."""
        self._age = min(self._age + 1, self._echo)
        return self._age < self._echo

    def _begin_anew(self) -> None:
        """What is sent changes."""
        self._age, self._raw = 0, None

    def arm(self) -> None:
        """Enable it with the next image; nothing happens before it has been seen clear."""
        raise NotImplementedError

    def disarm(self) -> None:
        """Switch it off with the next image, and drop what it has."""
        raise NotImplementedError

    @property
    def is_ordered(self) -> bool:
        """Whether it has been ordered on and not off again."""
        raise NotImplementedError

    @property
    def is_clear(self) -> bool:
        """Whether the drive shows neither an enabled latch nor a value."""
        raise NotImplementedError

    @property
    def is_armed(self) -> bool:
        """Whether it waits for an edge, or has its value."""
        raise NotImplementedError

    @property
    def has_latched(self) -> bool:
        """Whether a value is there."""
        raise NotImplementedError

    @property
    def value(self) -> int | None:
        """The value, as it is in the image; None until two telegrams have the same."""
        raise NotImplementedError
