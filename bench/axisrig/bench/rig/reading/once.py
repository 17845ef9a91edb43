"""Parameter lists, read once for each content."""

from functools import lru_cache
from pathlib import Path

from axisrig.kernel.parameters import Kind, ParameterSet, read_list


def read_once(path: str | Path, kind: Kind, axis: str | None = None) -> ParameterSet:
    """Read a list, once per content: many rows of a plan have the same."""
    try:
        content = Path(path).read_bytes()
    except OSError:
        return read_list(path, kind, axis)
    return _parsed(path, kind, axis, content).copied()


@lru_cache(maxsize=64)
def _parsed(path: str | Path, kind: Kind, axis: str | None, _content: bytes) -> ParameterSet:
    return read_list(path, kind, axis)
