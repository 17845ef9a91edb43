"""What this room has in C (`_line.c`); None where this build has nothing compiled."""

try:
    from axisrig.bench.bus import _line as native
except ImportError:
    native = None  # type: ignore[assignment]

__all__ = ["native"]
