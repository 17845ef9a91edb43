"""Signals as compact text: integers of a stated resolution, differences, byte planes, gzip.

One signal of n samples becomes `planes * n` bytes:

1. integers = round(value * 10**digits), so the resolution is that of the signal table (1 nm for
   positions) and nothing below it is shown,
2. differences to the sample before, the first one to `start`,
3. zig-zag: 0, -1, 1, -2, 2 ... become 0, 1, 2, 3, 4 ...,
4. byte 0 of every sample, then byte 1 of every sample, and so on: `planes` of them.

The signals of a run follow each other and are packed with gzip and base64 together. A sample
without a value (NaN) repeats the one before; `gaps` names them.
"""

import base64
import gzip
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class Encoded:
    """What a reader needs besides the bytes of one signal.

    start: integer before the first difference. planes: bytes per sample. digits: decimal places.
    gaps: first sample and count of each stretch without a value.
    """

    start: int
    planes: int
    digits: int
    gaps: list[tuple[int, int]]


def encode_signal(
    values: npt.NDArray[np.float64] | npt.NDArray[np.int64], digits: int
) -> tuple[Encoded, bytes]:
    """Encode one signal, shape (n,), n > 0. Raises OverflowError beyond +-2**62 steps."""
    with np.errstate(over="ignore"):  # refused below
        scaled = values if digits == 0 and values.dtype.kind == "i" else values * 10.0**digits
    missing = np.isnan(scaled) if scaled.dtype.kind == "f" else np.zeros(len(scaled), dtype=bool)
    if np.abs(scaled[~missing]).max(initial=0) >= 2**62:
        raise OverflowError(f"values too large for {digits} decimal places")
    gaps = _gaps(missing) if missing.any() else []
    integers = np.rint(np.where(missing, 0, scaled) if gaps else scaled).astype(np.int64)
    if gaps:
        # A gap takes the last value before it: the difference is 0 and costs next to nothing.
        last = np.maximum.accumulate(np.where(missing, 0, np.arange(len(integers))))
        integers = integers[last]
    start = int(integers[0])
    steps = np.zeros_like(integers)
    np.subtract(integers[1:], integers[:-1], out=steps[1:])
    zigzag = ((steps << 1) ^ (steps >> 63)).astype(np.uint64)
    planes = max(1, (int(zigzag.max()).bit_length() + 7) // 8)
    octets = zigzag.astype("<u8").view(np.uint8).reshape(-1, 8)[:, :planes]
    return Encoded(start, planes, digits, gaps), octets.T.tobytes()


def _gaps(missing: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(missing, prepend=False, append=False))
    return [(int(a), int(b - a)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def pack(parts: Sequence[bytes]) -> str:
    """Pack the signals of a run into one base64 text; equal parts give equal text."""
    return base64.b64encode(gzip.compress(b"".join(parts), compresslevel=6, mtime=0)).decode()
