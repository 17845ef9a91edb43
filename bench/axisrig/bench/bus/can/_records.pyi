from array import array
from collections.abc import Mapping
from typing import Any

def hash_records(block: list[Any], names: Mapping[str, bytes], /) -> bytes: ...
def blf_objects(
    block: list[Any], first: int, numbers: Mapping[str, int], head: bytes, /
) -> tuple[bytes, int]: ...
def add_load(
    passed: list[Any],
    busy_ns: array[int],
    worst_delay_ns: dict[int, int],
    window_ns: int,
    begin_ns: int,
    /,
) -> int: ...
