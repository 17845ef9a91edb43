"""Who hears that an FMU is being built: that takes seconds in which nothing else is to be seen."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

_listeners: list[Callable[[str], None]] = []


@contextmanager
def heard(say: Callable[[str], None]) -> Iterator[None]:
    """Let `say` hear what is built while the block lasts, and an empty text after each build."""
    _listeners.append(say)
    try:
        yield
    finally:
        _listeners.remove(say)


@contextmanager
def building(model: str) -> Iterator[None]:
    """Report the build of a model while the block lasts."""
    for say in _listeners:
        say(f"building {model}")
    try:
        yield
    finally:
        for say in _listeners:
            say("")
