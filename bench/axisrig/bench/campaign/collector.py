"""The garbage collector out of the way of runs, which allocate much and drop nothing."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_collector() -> Iterator[None]:
    """Keep the garbage collector out of a run.

    At the end it looks through what is new, and frees the machine: left to itself it would do so
    while that is in use still, and find it again among all that the process has.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.collect(0)
            gc.enable()
