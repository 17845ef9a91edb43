"""Instants of a cyclic segment: when drives sample, exchange and act, and are asked beside it."""

from typing import Any

import pytest

from axisrig.bench.bus.cyclic.segment import CyclicSegment, Instants
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler


class Noting:
    """A drive that notes the instants, in us, at which it is woken up."""

    inputs = b""

    def __init__(self, clock: Any) -> None:
        self._clock = clock
        self.noted: dict[str, list[float]] = {"sample": [], "exchange": [], "cycle": []}

    def _note(self, what: str) -> None:
        self.noted[what].append(self._clock.now_ns / US)

    def sample(self) -> None:
        self._note("sample")

    def exchange(self, outputs: bytes | None) -> bytes:
        self._note("exchange")
        return b""

    def cycle(self) -> None:
        self._note("cycle")


@pytest.mark.parametrize("input_us", [0, 125])
def test_each_instant_of_a_cycle_and_what_drives_do_without_further_ones(input_us: int) -> None:
    """T_I before the next begin, T_DX and T_O after this one; then a cycle of their own each 1 ms.

    The first of these is half a period after the instant at which T_O would have been.
    """
    clock = new_scheduler()
    node = Noting(clock)
    at = Instants(MS, input_ns=input_us * US, bus_ns=250 * US, output_ns=375 * US)
    segment = CyclicSegment(clock, {"X": node}, at, lambda _axis, _inputs: None)
    for number in range(3):
        clock.run_until(number * MS)
        segment.begin({"X": b""})
    clock.run_until(6 * MS)
    begins = (0, 1000, 2000)
    assert node.noted["sample"] == [
        begin + (1000 - input_us if input_us else 0) for begin in begins
    ]
    assert node.noted["exchange"] == [begin + 250 for begin in begins]
    late = [3000 + 375 + 500, 4000 + 375 + 500, 5000 + 375 + 500]
    assert node.noted["cycle"] == [*(begin + 375 for begin in begins), *late]
    assert segment.exchanges == 3


def test_a_request_beside_the_cycle_is_answered_half_way() -> None:
    clock, asked, done = new_scheduler(), list[int](), list[tuple[int, bytes]]()
    segment = CyclicSegment(clock, {}, Instants(MS, request_ns=600 * US), lambda *_: None)

    def answer(request: bytes) -> bytes:
        asked.append(clock.now_ns)
        return request[::-1]

    clock.run_until(100 * US)
    before = segment.hexdigest()
    segment.ask(answer, b"ab", lambda found: done.append((clock.now_ns, found)))
    clock.run_until(MS)
    assert (asked, done) == ([400 * US], [(700 * US, b"ba")])
    assert segment.hexdigest() != before
