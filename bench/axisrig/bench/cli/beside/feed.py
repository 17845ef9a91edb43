"""What a page or a terminal shows of a running campaign: asked for, and read, where it is shown."""

import json
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from threading import Event, Lock
from typing import Any

from axisrig.bench.machine.live.pipe import Inlet

PERIOD_S = 0.05
"""A state is asked for this often at most: 20 a second, however many look on."""
IDLE_S = 1.0
"""After so long without a look, what the pipe holds is old."""
_FACTOR_OVER_S = 2.0


@dataclass(frozen=True)
class Look:
    """What is to be shown.

    number: grows with each new state. state: as `bench.machine.live.states` makes it, None before
    the first; text: the same as it came, JSON. age_s: time since it came. factor: simulated time by
    wall time of the last seconds, None while it is not known. progress: of the campaign.
    """

    number: int
    state: Mapping[str, Any] | None
    text: str
    age_s: float
    factor: float | None
    progress: Mapping[str, object]

    def as_json(self) -> str:
        """Return it for a page, in one line."""
        about = {"age_s": self.age_s, "factor": self.factor, "progress": self.progress}
        return f'{{"state": {self.text or "null"}, {json.dumps(about)[1:]}'


class Feed:
    """Reads the pipe for all who look on; nothing is asked of the runs while nobody does.

    clock: gives seconds of wall time. progress: gives that of the campaign, as data.
    """

    def __init__(
        self,
        inlet: Inlet,
        clock: Callable[[], float],
        progress: Callable[[], Mapping[str, object]],
    ) -> None:
        self._inlet, self._clock, self._progress = inlet, clock, progress
        self._lock, self._end = Lock(), Event()
        self._asked_s = self._came_s = clock() - 2 * IDLE_S
        self._number, self._text = 0, ""
        self._state: Mapping[str, Any] | None = None
        self._track: deque[tuple[float, int]] = deque()

    def look(self) -> Look:
        """Return what is to be shown now, and ask for the next state where it is time for one."""
        with self._lock:
            now_s = self._clock()
            if now_s - self._asked_s >= PERIOD_S:
                self._take(now_s)
                self._asked_s = now_s
                self._inlet.ask()
            age_s = now_s - self._came_s
            look = (self._number, self._state, self._text, age_s, self._factor())
        return Look(*look, self._progress())

    def _take(self, now_s: float) -> None:
        text = self._inlet.take()
        if now_s - self._asked_s > IDLE_S:
            self._track.clear()
            return
        if text is None:
            return
        self._text = text.decode()
        state = json.loads(self._text)
        if self._state is None or self._state["run"] != state["run"]:
            self._track.clear()
        self._number, self._state, self._came_s = self._number + 1, state, now_s
        track = self._track
        if track and track[-1][1] > state["time_ns"]:
            track.clear()
        track.append((now_s, state["time_ns"]))
        while now_s - track[0][0] > _FACTOR_OVER_S:
            track.popleft()

    def _factor(self) -> float | None:
        if len(self._track) < 2:
            return None
        (first_s, first_ns), (last_s, last_ns) = self._track[0], self._track[-1]
        return (last_ns - first_ns) / 1e9 / (last_s - first_s)

    # Its end

    @property
    def has_ended(self) -> bool:
        """Whether there is nothing to come."""
        return self._end.is_set()

    def pause(self) -> bool:
        """Wait until a new state may be there; return whether the end has come."""
        return self._end.wait(PERIOD_S)

    def end(self) -> None:
        """Let all who look on go."""
        self._end.set()
