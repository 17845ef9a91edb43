"""Timing diagrams as plain SVG: lanes of participants over one axis of time.

What is drawn is given in ns; the same input gives the same bytes, and nothing depends on a clock or
on a library.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from xml.sax.saxutils import escape

WIDTH, LEFT, RIGHT = 980, 132, 964
FONT_PX, ROW_PX = 12.5, 16
CHARACTER_PX = 0.56 * FONT_PX
"""Width of a character, rather more than the mean one of the fonts below."""
INK, FAINT, LINE, CHAIN, VALUE = "#222222", "#8a8a8a", "#b9b9b9", "#1f5f99", "#b3261e"
STYLE = f"""\
text {{ font: {FONT_PX}px "DejaVu Sans", Verdana, Arial, sans-serif; fill: {INK};
  paint-order: stroke; stroke: #ffffff; stroke-width: 3px; stroke-linejoin: round; }}
.head {{ font-weight: bold; }} .faint {{ fill: {FAINT}; }}
.chain {{ fill: {CHAIN}; }} .value {{ fill: {VALUE}; }}
.line {{ stroke: {LINE}; fill: none; }} .tick {{ stroke: {FAINT}; fill: none; }}
.way {{ stroke: {CHAIN}; stroke-width: 1.6; fill: none; }}
.guide {{ stroke: {VALUE}; stroke-dasharray: 4 3; fill: none; }}
.curve {{ stroke: {INK}; stroke-width: 1.4; fill: none; }}
.set {{ stroke: {FAINT}; stroke-width: 1.4; fill: none; }}
.bar {{ fill: {CHAIN}; fill-opacity: 0.16; stroke: {CHAIN}; stroke-width: 0.8; }}"""


@dataclass(frozen=True)
class Event:
    """Something that happens at an instant. text: beside it, without the time, which is added.

    kind: chain for what the signal passes through, value for the instant whose position is the
    value, plain for the rest.
    """

    time_ns: int
    text: str
    kind: str = "plain"


@dataclass(frozen=True)
class Lane:
    """One participant. ticks_ns: its cycles; bars: from, to and text of what lasts."""

    name: str
    events: Sequence[Event] = ()
    ticks_ns: Sequence[int] = ()
    bars: Sequence[tuple[int, int, str]] = ()


@dataclass(frozen=True)
class Curve:
    """Positions over time, mm, drawn above the lanes. levels: name and place of straight lines.

    dot: instant and place of the measured value.
    """

    name: str
    times_ns: Sequence[int]
    truth_mm: Sequence[float]
    levels: Sequence[tuple[str, float, str]] = ()
    dot: tuple[int, float] | None = None
    set_mm: Sequence[float] = ()


@dataclass(frozen=True)
class Panel:
    """Lanes over one span of time. zero_ns: what times count from; unit: us or ms.

    spans: name, begin and end of the shares of the delay, drawn below the lanes.
    """

    title: str
    zero_ns: int
    begin_ns: int
    end_ns: int
    lanes: Sequence[Lane]
    curve: Curve | None = None
    spans: Sequence[tuple[str, int, int]] = ()
    unit: str = "us"
    chain: Sequence[tuple[str, int]] = field(default_factory=tuple)


UNITS = {"us": (1e3, 1), "ms": (1e6, 3)}


def shown(time_ns: int, unit: str) -> str:
    """Return a duration as the diagrams write it."""
    scale, digits = UNITS[unit]
    text = f"{time_ns / scale:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


class _Drawing:
    """Elements of one picture, words above lines, and how far down it has come."""

    def __init__(self) -> None:
        self.parts: list[str] = []
        self.words: list[str] = []
        self.y = 14.0

    def text(self, x: float, y: float, words: str, kind: str = "", anchor: str = "start") -> None:
        style = f' class="{kind}"' if kind else ""
        self.words.append(
            f'<text x="{x:.1f}" y="{y:.1f}"{style} text-anchor="{anchor}">{escape(words)}</text>'
        )

    def path(self, points: Sequence[tuple[float, float]], kind: str) -> None:
        where = " L".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.parts.append(f'<path class="{kind}" d="M{where}"/>')

    def dot(self, x: float, y: float, kind: str, radius: float = 3.2) -> None:
        self.parts.append(f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="{radius}"/>')


def width_px(words: str) -> float:
    """Return the room that words take."""
    return len(words) * CHARACTER_PX


class _Rows:
    """Finds a row for each label, so that none covers another one."""

    def __init__(self) -> None:
        self._taken: list[list[tuple[float, float]]] = []

    def place(self, begin: float, end: float) -> int:
        for number, row in enumerate(self._taken):
            if all(end < left or begin > right for left, right in row):
                row.append((begin, end))
                return number
        self._taken.append([(begin, end)])
        return len(self._taken) - 1

    def __len__(self) -> int:
        return len(self._taken)


@dataclass(frozen=True)
class _Label:
    x: float
    left: float
    row: int
    words: str
    kind: str


def _labels(events: Sequence[Event], panel: Panel, x_of: Callable[[int], float]) -> list[_Label]:
    """Labels right of their instants, left of them where the picture ends; the last lowest."""
    rows, found = _Rows(), []
    for event in sorted(events, key=lambda e: (-e.time_ns, e.text)):
        words = f"{event.text}, {shown(event.time_ns - panel.zero_ns, panel.unit)} {panel.unit}"
        x, room = x_of(event.time_ns), width_px(words)
        left = x + 6 if x + 6 + room <= RIGHT else x - 6 - room
        row = rows.place(min(left, x) - 4, max(left + room, x) + 8)
        found.append(_Label(x, left, row, words, event.kind))
    return found


def _draw_curve(drawing: _Drawing, panel: Panel, x_of: Callable[[int], float]) -> None:
    curve = panel.curve
    assert curve is not None
    height, top = 112.0, drawing.y
    places = [*curve.truth_mm, *curve.set_mm, *(place for _, place, _ in curve.levels)]
    low, high = min(places), max(places)
    margin = 0.06 * (high - low)

    def y_of(place: float) -> float:
        return top + height * (1 - (place - low + margin) / (high - low + 2 * margin))

    drawing.text(8, top + height, curve.name, "head")
    if curve.set_mm:
        points = zip(curve.times_ns, curve.set_mm, strict=True)
        drawing.path([(x_of(t), y_of(p)) for t, p in points], "set")
    points = zip(curve.times_ns, curve.truth_mm, strict=True)
    drawing.path([(x_of(t), y_of(p)) for t, p in points], "curve")
    for words, place, kind in curve.levels:
        drawing.path([(LEFT, y_of(place)), (RIGHT, y_of(place))], "guide" if kind else "line")
        drawing.text(LEFT - 6, y_of(place) + 4, words, kind or "faint", "end")
    if curve.dot is not None:
        drawing.dot(x_of(curve.dot[0]), y_of(curve.dot[1]), "value", 4)
    drawing.y += height + 10


def _draw_lane(
    drawing: _Drawing, lane: Lane, panel: Panel, x_of: Callable[[int], float]
) -> dict[int, float]:
    """Draw a lane; return the height of its line."""
    labels = _labels(lane.events, panel, x_of)
    lowest = max((label.row for label in labels), default=0)
    line = drawing.y + 13 + ROW_PX * (lowest + 1)
    drawing.path([(LEFT, line), (RIGHT, line)], "line")
    for tick_ns in lane.ticks_ns:
        if panel.begin_ns <= tick_ns <= panel.end_ns:
            drawing.path([(x_of(tick_ns), line - 4), (x_of(tick_ns), line + 4)], "tick")
    for begin_ns, end_ns, words in lane.bars:
        left, right = x_of(max(begin_ns, panel.begin_ns)), x_of(min(end_ns, panel.end_ns))
        drawing.parts.append(
            f'<rect class="bar" x="{left:.1f}" y="{line - 5:.1f}"'
            f' width="{right - left:.1f}" height="10"/>'
        )
        drawing.text((left + right) / 2, line + 17, words, "faint", "middle")
    drawing.text(8, line + 4, lane.name, "head")
    for label in labels:
        y = line - 9 - ROW_PX * label.row
        drawing.path([(label.x, line), (label.x, y - 3)], "tick")
        drawing.text(label.left, y, label.words, "" if label.kind == "plain" else label.kind)
        drawing.dot(label.x, line, label.kind)
    drawing.y = line + (20 if lane.bars else 8)
    return {event.time_ns: line for event in lane.events}


def _draw_chain(
    drawing: _Drawing,
    panel: Panel,
    lines: dict[str, dict[int, float]],
    x_of: Callable[[int], float],
) -> None:
    """The way of the signal: from lane to lane at its instants."""
    points: list[tuple[float, float]] = []
    for name, time_ns in panel.chain:
        x, y = x_of(time_ns), next(iter(lines[name].values()))
        if points and points[-1][1] != y:
            points.append((x, points[-1][1]))
        points.append((x, y))
    if points:
        drawing.path(points, "way")


def _draw_spans(drawing: _Drawing, panel: Panel, x_of: Callable[[int], float]) -> None:
    """The shares of the delay: a bar for each, its name and length beside it."""
    rows, placed = _Rows(), []
    for name, begin_ns, end_ns in panel.spans:
        words = f"{name}, {shown(end_ns - begin_ns, panel.unit)} {panel.unit}"
        left, right = sorted((x_of(begin_ns), x_of(end_ns)))
        room = width_px(words)
        is_right = right + 6 + room <= RIGHT
        begin, end = (left, right + 6 + room) if is_right else (left - 6 - room, right)
        placed.append((rows.place(begin - 2, end + 8), left, right, words, is_right))
    drawing.text(8, drawing.y + 16, "delay", "head")
    for row, left, right, words, is_right in placed:
        y = drawing.y + 12 + row * (ROW_PX + 2)
        drawing.parts.append(
            f'<rect class="bar" x="{left:.1f}" y="{y - 5:.1f}"'
            f' width="{max(right - left, 1.0):.1f}" height="10"/>'
        )
        drawing.text(
            right + 6 if is_right else left - 6, y + 4, words, "", "start" if is_right else "end"
        )
    drawing.y += 12 + len(rows) * (ROW_PX + 2)


def _draw_panel(drawing: _Drawing, panel: Panel) -> None:
    def x_of(time_ns: int) -> float:
        share = (time_ns - panel.begin_ns) / (panel.end_ns - panel.begin_ns)
        return LEFT + share * (RIGHT - LEFT)

    drawing.text(8, drawing.y + 4, panel.title)
    drawing.y += 16
    top = drawing.y
    if panel.curve is not None:
        _draw_curve(drawing, panel, x_of)
    lines = {lane.name: _draw_lane(drawing, lane, panel, x_of) for lane in panel.lanes}
    _draw_chain(drawing, panel, lines, x_of)
    for lane in panel.lanes:
        for event in lane.events:
            if event.kind == "value":
                x = x_of(event.time_ns)
                drawing.path([(x, top), (x, lines[lane.name][event.time_ns])], "guide")
    if panel.spans:
        _draw_spans(drawing, panel, x_of)
    drawing.y += 24


def svg(title: str, panels: Sequence[Panel]) -> str:
    """Return a picture of these panels, one below the other."""
    drawing = _Drawing()
    for panel in panels:
        _draw_panel(drawing, panel)
    height = round(drawing.y) - 12
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}"'
        f' viewBox="0 0 {WIDTH} {height}" role="img">\n<title>{escape(title)}</title>\n'
        f'<style>{STYLE}</style>\n<rect width="100%" height="100%" fill="#ffffff"/>\n'
    )
    return head + "\n".join([*drawing.parts, *drawing.words]) + "\n</svg>\n"
