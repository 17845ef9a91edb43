"""Which of the frames of a telegram a fault hits, whatever carries them."""

import random


class Window:
    """Whether a fault acts now; `begin` and `end` are called by the code that has the moment."""

    def __init__(self, is_open: bool = True) -> None:
        self.is_open = is_open

    def begin(self) -> None:
        """Let the fault act from now on."""
        self.is_open = True

    def end(self) -> None:
        """Let it act no more."""
        self.is_open = False


class Hits:
    """Decides of each frame that comes while a window is open whether it is hit.

    share: probability 0..1 per frame. skip: so many frames pass first. count: at most so many are
    hit, None = no limit. numbers: the random numbers of this fault alone.
    """

    def __init__(
        self,
        window: Window | None = None,
        numbers: random.Random | None = None,
        *,
        share: float = 1.0,
        skip: int = 0,
        count: int | None = None,
    ) -> None:
        self.window, self.numbers = window or Window(), numbers or random.Random(0)
        self._share, self._skip, self._count = share, skip, count

    def falls(self) -> bool:
        """Whether the frame that comes now is hit; counts it."""
        if not self.window.is_open or self._count == 0:
            return False
        # Drawn even when not needed: the choice hangs on a frame's place in the sequence only
        is_hit = self.numbers.random() < self._share
        if self._skip:
            self._skip -= 1
            return False
        if is_hit and self._count is not None:
            self._count -= 1
        return is_hit
