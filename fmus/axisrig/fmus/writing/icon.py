"""The icon of a class as a PNG picture: its filled shapes and lines, without text.

Source: Modelica language specification 3.6, section 18.6 (graphical objects); PNG specification,
third edition, sections 5 and 11. The pixels are stored, not compressed: the bytes do not depend on
the library that would do it.
"""

import re
import struct
import zlib
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from axisrig.fmus.reading.texts import Texts

SIZE = 64  # pixels of a side
_FINE = 4  # samples of a pixel along each side
_LINE = 2.0  # half the width of a line, of 200 units of the icon
_OBJECT = re.compile(r"\b(Rectangle|Ellipse|Polygon|Line)\s*\(((?:[^()]|\([^()]*\))*)\)")
_POINT = re.compile(r"\{\s*([-+.\deE]+)\s*,\s*([-+.\deE]+)\s*\}")
_COLOR = r"\b{name}\s*=\s*\{{\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*\}}"
# Of a class that draws nothing: a box
_PLAIN = (
    "Rectangle(extent = {{-90, 60}, {90, -60}}, lineColor = {0, 0, 0},"
    " fillColor = {235, 235, 235}, fillPattern = FillPattern.Solid)"
)

_Mask = NDArray[np.bool_]


def draw(texts: Texts, model: str) -> bytes:
    """The picture of a model, what its base classes draw below; a box when nothing is drawn."""
    drawn = " ".join(found.annotation("Icon") for found in reversed(texts.bases(model)))
    objects = _OBJECT.findall(drawn) or _OBJECT.findall(_PLAIN)
    count = SIZE * _FINE
    pixels = np.full((count, count, 4), (255, 255, 255, 0), dtype=float)
    at = (np.arange(count) + 0.5) * (200.0 / count) - 100.0
    x, y = np.meshgrid(at, -at)
    for kind, text in objects:
        shape = _corners(kind, text)
        if len(shape) < 2:
            continue
        if kind != "Line" and "FillPattern.Solid" in text:
            pixels[_inside(x, y, shape)] = (*_color(text, "fillColor", 255), 255)
        if "LinePattern.None" not in text:
            ring = shape if kind == "Line" else np.vstack([shape, shape[:1]])
            name = "color" if kind == "Line" else "lineColor"
            pixels[_along(x, y, ring)] = (*_color(text, name, 0), 255)
    means = pixels.reshape(SIZE, _FINE, SIZE, _FINE, 4).mean(axis=(1, 3))
    return _png(np.rint(means).astype(np.uint8))


def _corners(kind: str, text: str) -> NDArray[np.float64]:
    """The corners of a shape, shape (n, 2); an ellipse is a polygon of many."""
    points = np.array([[float(a), float(b)] for a, b in _POINT.findall(text)]).reshape(-1, 2)
    if kind in ("Line", "Polygon") or len(points) < 2:
        return points
    (x0, y0), (x1, y1) = points[:2]
    if kind == "Rectangle":
        return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    angle = np.arange(48) * (2 * np.pi / 48)
    middle, half = np.array([x0 + x1, y0 + y1]) / 2, np.array([x1 - x0, y1 - y0]) / 2
    return np.asarray(middle + half * np.column_stack([np.cos(angle), np.sin(angle)]))


def _inside(x: NDArray[np.float64], y: NDArray[np.float64], shape: NDArray[np.float64]) -> _Mask:
    """Where a ray to the right crosses the border an odd number of times."""
    found = np.zeros(x.shape, dtype=bool)
    for (x0, y0), (x1, y1) in zip(shape, np.roll(shape, -1, axis=0), strict=True):
        if y0 != y1:
            crosses = (y0 > y) != (y1 > y)
            found ^= crosses & (x < x0 + (x1 - x0) * (y - y0) / (y1 - y0))
    return found


def _along(x: NDArray[np.float64], y: NDArray[np.float64], line: NDArray[np.float64]) -> _Mask:
    """Where a line of some width is."""
    found = np.zeros(x.shape, dtype=bool)
    for (x0, y0), (x1, y1) in pairwise(line):
        length = (x1 - x0) ** 2 + (y1 - y0) ** 2
        part = ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / (length or 1.0)
        part = np.clip(part, 0.0, 1.0)
        away = (x - x0 - part * (x1 - x0)) ** 2 + (y - y0 - part * (y1 - y0)) ** 2
        found |= away <= _LINE**2
    return found


def _color(text: str, name: str, default: int) -> tuple[int, int, int]:
    found = re.search(_COLOR.format(name=name), text)
    return (int(found[1]), int(found[2]), int(found[3])) if found else (default, default, default)


def _png(pixels: NDArray[np.uint8]) -> bytes:
    """A picture of red, green, blue and cover, shape (height, width, 4)."""
    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    stored = b"\x78\x01\x01" + struct.pack("<HH", len(rows), 0xFFFF - len(rows)) + rows
    data = stored + struct.pack(">I", zlib.adler32(rows))
    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", data), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        for kind, body in chunks
    )
