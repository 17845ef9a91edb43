"""What this room has in C (`_line.c`, `_records.c`); None where this build has nothing compiled."""

from typing import Any

# Of any type, so that both ways through what asks for them are checked
native_line: Any
native_records: Any
try:
    from axisrig.bench.bus.can import _line, _records

    native_line, native_records = _line, _records
except ImportError:
    native_line = native_records = None
