"""Real time for commands that have something outside; imports as in `axisrig.bench.cli.main`."""

import sys
import time
from contextlib import AbstractContextManager
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from axisrig.bench.machine.pacing import Hardware


def hardware() -> AbstractContextManager["Hardware"]:
    """Give real time to a run with a real bus."""
    from axisrig.bench.bus.paced import RealTime
    from axisrig.bench.campaign.hardware_runs import stoppable

    return stoppable(RealTime(time.monotonic_ns, time.sleep), to_stderr)


def to_stderr(text: str) -> None:
    """Put a line out for who reads the terminal."""
    print(text, file=sys.stderr, flush=True)


def time_of_day(ago_s: float) -> str:
    """Return the time of day so many seconds ago, in UTC and whole seconds."""
    return (datetime.now(UTC) - timedelta(seconds=ago_s)).isoformat(timespec="seconds")
