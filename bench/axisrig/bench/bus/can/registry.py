"""The open segments by name, so that `can.Bus(interface="axisrig", channel=name)` finds them."""

from axisrig.bench.bus.can.controller import Wire

_open_segments: dict[str, Wire] = {}


def register(segment: Wire) -> None:
    """Register `segment` by its name.

    Raises ValueError while another open segment has that name.
    """
    if segment.name in _open_segments:
        raise ValueError(f"segment {segment.name!r} is open already: close() it first")
    _open_segments[segment.name] = segment


def unregister(segment: Wire) -> None:
    """Remove `segment`; without effect when it is not registered."""
    if _open_segments.get(segment.name) is segment:
        del _open_segments[segment.name]


def find(name: str) -> Wire | None:
    """Return the open segment of that name."""
    return _open_segments.get(name)


def names() -> list[str]:
    """Return the names of the open segments, in the order of opening."""
    return list(_open_segments)
