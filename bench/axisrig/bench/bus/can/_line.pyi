from typing import Any

from axisrig.bench.bus.can.frame import Frame

class BusLine:
    def __init__(self, segment: Any, duration_ns: list[int], /) -> None: ...

def frame_bits(frame: Frame, /) -> int: ...
