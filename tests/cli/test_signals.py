"""SIGTERM and Ctrl-C end a command wherever they come."""

import os
import signal
import sys
import time
from collections.abc import Iterator

import pytest

from axisrig.bench.cli.start import end_on_signals

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    """Handlers of the process that runs the tests stay."""
    numbers = (signal.SIGTERM, signal.SIGINT, signal.SIGALRM)
    before = {number: signal.getsignal(number) for number in numbers}
    hook = sys.unraisablehook
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    sys.unraisablehook = hook
    for number, handler in before.items():
        signal.signal(number, handler)


class _Finalised:
    """Its finaliser is where a signal comes; depth: so many times in finalisers of each other."""

    def __init__(self, number: int, depth: int) -> None:
        self.number, self.depth = number, depth

    def __del__(self) -> None:
        if self.depth:
            _Finalised(self.number, self.depth - 1)
            time.sleep(0.1)
        else:
            os.kill(os.getpid(), self.number)


@pytest.mark.parametrize("depth", [0, 1])
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_in_a_finaliser_is_not_dropped(number: int, depth: int) -> None:
    end_on_signals()
    began_s = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        _wait(number, depth)
    assert time.monotonic() - began_s < 5.0


def _wait(number: int, depth: int) -> None:
    _Finalised(number, depth)
    time.sleep(10.0)


def test_other_exceptions_of_finalisers_are_said_as_ever(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    said: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda dropped: said.append(dropped.exc_type))
    end_on_signals()
    hook = sys.unraisablehook
    end_on_signals()
    assert sys.unraisablehook is hook

    class Broken:
        def __del__(self) -> None:
            raise ValueError

    Broken()
    assert said == [ValueError]
