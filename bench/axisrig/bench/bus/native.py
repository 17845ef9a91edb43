"""What this room has in C (`_line.c`); None where this build has nothing compiled."""

from typing import Any

native: Any  # both ways through what asks for it are checked
try:
    from axisrig.bench.bus import _line

    native = _line
except ImportError:
    native = None
