"""The block trace of a run: its table, and the lane over its plots.

Of many commands the table has the first and the last ones; in the lane short neighbours are one.
"""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from typing import Any
from urllib.parse import quote

from markupsafe import Markup

from axisrig.bench.plan.sentences import short_number
from axisrig.bench.record.blocks import (
    STATES,
    BlockRows,
    BlockTrace,
    ProgramLine,
    block_kinds,
    held_ns,
)

TABLE_MAX, LANE_MAX = 300, 2000
"""So many commands the table of a run has at most; the lane joins short ones above its number."""
REDUCED_TABLE_MAX, REDUCED_LANE_MAX = 60, 400
"""The same of a run that passed."""
_AGAIN_MAX = 20
_ORDINARY = ("done", "signal", "stop found")
_BESIDE = "independent"

Address = Callable[[str], str]
"""The address of a file from the page, empty where there is none."""


def blocks_style() -> Markup:
    """Return the rules of the section, for the element `style` of a page."""
    return Markup(resources.files(__package__).joinpath("style.css").read_text(encoding="utf-8"))


def blocks_view(
    trace: BlockTrace | None, address: Address, *, is_reduced: bool
) -> dict[str, Any] | None:
    """Return what the table prints; None for a run without a block trace, or without blocks.

    Raises UserError when the trace is damaged.
    """
    if trace is None or not trace.count:
        return None
    rows = trace.rows()
    most = REDUCED_TABLE_MAX if is_reduced else TABLE_MAX
    count, half = trace.count, most // 2
    kept = range(count) if count <= most else [*range(half), *range(count - half, count)]
    files = {_file(line) for line in trace.lines}
    shown = [_row(trace, rows, place, address) for place in kept]
    return {
        "rows": shown,
        "left_out": count - len(shown),
        "half": half if count > len(shown) else -1,
        "words": _words(trace, rows),
        # The name of the file is in the rows where there are several
        "file": files.pop() if len(files) == 1 else "",
        "again": _again(trace, rows, address),
        "has_waits": any(row["waited"] for row in shown),
        "has_feed": any(row["feed"] for row in shown),
        "has_way": any(row["way"] for row in shown),
    }


def blocks_lane(trace: BlockTrace | None, *, is_reduced: bool) -> dict[str, Any] | None:
    """Return what the lane draws: `rows` of number, due, begin and end in ns, group, lane, label.

    `lanes`: 2 where axes move beside the path. `holds`: feedholds.
    """
    if trace is None or not trace.count:
        return None
    rows, kinds = trace.rows(), block_kinds()
    drawn: list[list[Any]] = []
    for at in range(trace.count):
        kind = trace.kinds[rows.kind[at]]
        line = trace.lines[rows.line[at]]
        begin_ns, end_ns = int(rows.begin_ns[at]), int(rows.end_ns[at])
        lane = int(kind.startswith(_BESIDE))
        group = kinds[kind]["group"] if kind in kinds else "other"
        drawn.append([at, int(rows.due_ns[at]), begin_ns, end_ns, group, lane, _label(line)])
    most = REDUCED_LANE_MAX if is_reduced else LANE_MAX
    if trace.count > most:
        whole_ns = int(rows.end_ns.max() - rows.due_ns.min())
        shortest_ns = max(2 * whole_ns // most, 1)
        lanes = [[row for row in drawn if row[5] == lane] for lane in (0, 1)]
        drawn = [row for lane in lanes for row in _joined(lane, shortest_ns)]
    return {
        "rows": drawn,
        "lanes": 1 + max(row[5] for row in drawn),
        "holds": [list(hold) for hold in trace.holds],
    }


def _joined(rows: Sequence[list[Any]], shortest_ns: int) -> list[list[Any]]:
    """Join neighbours that are short until together they are not; a stretch has the group of most.

    rows: of one lane, as `blocks_lane` has them.
    """
    found: list[list[Any]] = []
    together: list[list[Any]] = []

    def close() -> None:
        if len(together) > 1:
            spent: Counter[str] = Counter()
            for _, due_ns, _, end_ns, group, _, _ in together:
                spent[group] += end_ns - due_ns
            first, end_ns = together[0], max(row[3] for row in together)
            group, label = spent.most_common(1)[0][0], f"{len(together)} from {first[6]}"
            found.append([first[0], first[1], first[1], end_ns, group, first[5], label])
        else:
            found.extend(together)
        together.clear()

    for row in rows:
        if row[3] - row[1] >= shortest_ns:
            close()
            found.append(row)
            continue
        together.append(row)
        if row[3] - together[0][1] >= shortest_ns:
            close()
    close()
    return found


def _label(line: ProgramLine) -> str:
    """The block with its number; without one, with its line."""
    if line.number is not None and line.text.startswith("N"):
        return line.text
    return f"{line.line}: {line.text}"


def _file(line: ProgramLine) -> str:
    return line.file.replace("\\", "/").rpartition("/")[2]


def _row(trace: BlockTrace, rows: BlockRows, at: int, address: Address) -> dict[str, Any]:
    kind, state = trace.kinds[rows.kind[at]], STATES[rows.state[at]]
    known = block_kinds().get(kind, {"group": "other", "meaning": kind})
    begin_ns, end_ns = int(rows.begin_ns[at]), int(rows.end_ns[at])
    due_ns = int(rows.due_ns[at])
    held = held_ns(trace.holds, begin_ns, end_ns) if known["group"] != "other" else 0
    return {
        **_place(trace.lines[rows.line[at]], address),
        "at": at,
        "begin_ns": begin_ns if end_ns > begin_ns else due_ns,
        "end_ns": end_ns,
        "kind": kind,
        "group": known["group"],
        "meaning": known["meaning"],
        "begin": _ms(begin_ns),
        "lasts": _ms(end_ns - begin_ns) if end_ns > begin_ns else "",
        "waited": _ms(begin_ns - due_ns) if begin_ns > due_ns else "",
        "held": _ms(held) if held else "",
        "feed": _number(rows.feed_mm_min[at]),
        "way": _way(float(rows.path_mm[at]), float(rows.travelled_mm[at])),
        "state": state,
        "is_ordinary": state in _ORDINARY,
    }


def _place(line: ProgramLine, address: Address) -> dict[str, str]:
    """Where a block is written; the address asks the browser to show its text."""
    name = _file(line)
    where = address(line.file) if line.file else ""
    text = quote(line.text, safe="").replace("-", "%2D")
    return {
        "where": f"{name}:{line.line}" if name else f"line {line.line}",
        "line": f"line {line.line}",
        "address": f"{where}#:~:text={text}" if where else "",
        "text": line.text,
    }


def _ms(time_ns: int) -> str:
    return f"{time_ns / 1e6:.3f}"


def _number(value: float) -> str:
    return "" if math.isnan(value) else short_number(float(value), 7)


def _way(path_mm: float, travelled_mm: float) -> str:
    """The way to the programmed end, and what was travelled of it where that is less."""
    if math.isnan(path_mm):
        return ""
    if math.isnan(travelled_mm) or math.isclose(path_mm, travelled_mm, abs_tol=1e-6):
        return _number(path_mm)
    return f"{_number(travelled_mm)} of {_number(path_mm)}"


def _words(trace: BlockTrace, rows: BlockRows) -> str:
    """How much was carried out, how long it took, and how much of it was waiting."""
    begin_ns, end_ns = int(rows.due_ns.min()), int(rows.end_ns.max())
    waited = _waited_ns(trace, rows)
    words = f"{trace.count} command{'s' if trace.count > 1 else ''} in {_s(end_ns - begin_ns)}"
    if waited:
        words += f", of it {_s(waited)} waiting"
    held = sum(end - begin for begin, end in trace.holds)
    return f"{words}, feedhold {_s(held)}" if held else words


def _waited_ns(trace: BlockTrace, rows: BlockRows) -> int:
    """How long the program waited: before a command began, and in commands that are waits."""
    groups = [block_kinds().get(kind, {"group": "other"})["group"] for kind in trace.kinds]
    is_wait = [groups[kind] == "wait" for kind in rows.kind]
    is_path = [not trace.kinds[kind].startswith(_BESIDE) for kind in rows.kind]
    before = (rows.begin_ns - rows.due_ns)[is_path]
    return int(before.sum() + (rows.end_ns - rows.begin_ns)[is_wait].sum())


def _s(time_ns: int) -> str:
    return f"{time_ns / 1e9:.3f} s"


def _again(trace: BlockTrace, rows: BlockRows, address: Address) -> list[Mapping[str, Any]]:
    """Lines that were carried out more than once, those that took the longest first."""
    counts = Counter(zip(rows.line.tolist(), rows.kind.tolist(), strict=True))
    spent: Counter[tuple[int, int]] = Counter()
    for line, kind, due_ns, end_ns in zip(
        rows.line.tolist(), rows.kind.tolist(), rows.due_ns, rows.end_ns, strict=True
    ):
        spent[line, kind] += int(end_ns - due_ns)
    several = sorted((key for key in counts if counts[key] > 1), key=lambda key: -spent[key])
    return [
        {
            **_place(trace.lines[line], address),
            "kind": trace.kinds[kind],
            "count": counts[line, kind],
            "lasts": _ms(spent[line, kind]),
        }
        for line, kind in several[:_AGAIN_MAX]
    ]
