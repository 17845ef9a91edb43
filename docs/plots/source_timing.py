"""Timing diagrams of the sources of the measuring signal, from recorded runs of shipped rows.

`python docs/plots/source_timing.py` draws docs/images/source-*.svg and writes the table of instants
on each page of docs/sources. Nothing is drawn by hand: `source_recording.py` has the instants.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
DOCS = HERE.parent
sys.path.insert(0, str(HERE))

import source_pictures as pictures  # noqa: E402
from source_pictures import Picture  # noqa: E402
from source_recording import Recorded, record  # noqa: E402
from timing_diagram import shown, svg  # noqa: E402


@dataclass(frozen=True)
class Source:
    """A source: the row of a shipped plan that is recorded, its page, and who draws it."""

    name: str
    plan: str
    case: str
    page: str
    draw: Callable[[Recorded], Picture]


SOURCES = (
    Source("drive", "latch_accuracy", "f600", "drive", pictures.drive),
    Source("plc", "plc_sources", "plc-f600", "plc", pictures.at_terminal),
    Source("plc-drive-input", "plc_sources", "plc-drive-input", "plc", pictures.drive_input),
    Source("plc-io-node", "io_node", "f600", "plc", pictures.io_node),
    Source(
        "plc-first-event", "plc_sources", "first-event-xz", "plc-first-event", pictures.first_event
    ),
    Source("plc-timestamp", "plc_sources", "stamp-f1000", "plc-timestamp", pictures.timestamp),
    Source(
        "plc-ext-latch-control",
        "plc_sources",
        "ext-f600",
        "plc-ext-latch-control",
        pictures.ext_latch,
    ),
    Source(
        "ext-probe-with-drive",
        "plc_sources",
        "radio-prepared",
        "ext-probe-with-drive",
        pictures.ext_probe,
    ),
    Source("fixed-stop", "fixed_stop_timing", "feed-600", "fixed-stop", pictures.fixed_stop),
)
_PLC = "first cycle of the PLC "
FOLLOWS = {
    "edge latched: value": "t_in",
    "SYNC that samples status and latch": "first SYNC from there on",
    "NC cycle that sees the status": "a after this SYNC",
    "NC cycle of the first set position that brakes": "the same NC cycle",
    "exchange of the terminal": "first exchange from contact + t_in on",
    "cycle of the PLC that writes": _PLC + "from there on",
    "NC cycle that sees the signal": "first NC cycle after it",
    "SYNC whose position is the value": "a before this NC cycle",
    "SYNC that samples 60FD": "first SYNC from contact + t_in on",
    "NC cycle that has 60FD": "a after this SYNC",
    "SYNC that samples the level": "first SYNC from contact + t_in on",
    "stamp of the terminal: value": "t_in",
    "PREPARE: NC cycle that asks": "what times of PREPARE count from",
    "ENABLE: NC cycle that asks": "one NC cycle after the begin of the block",
    "DISABLE: NC cycle that asks": "end of the run, what times of DISABLE count from",
    "cycle of the PLC that reads it": _PLC + "after it",
    "cycle of the PLC that acknowledges": _PLC + "in which the hardware is ready",
    "NC cycle that sees it": "first NC cycle after it",
    "lag above its limit": "(L - e0 + F/k)/v, up to two cycles of the exchange",
    "stop found: value": "minimum time after it",
    "set position at rest": "v/a after it",
    "end of the relaxing motion": "when the axis is in its window",
}
"""What an instant is by the cycles of the rig; of a handshake by the words after its task."""


def table(picture: Picture) -> str:
    """Return the instants of a picture as Markdown."""
    unit = picture.unit
    lines = [f"| instant | {unit} | by the cycles of the rig |", "|---|---|---|"]
    for name, after_ns in picture.instants.items():
        words = FOLLOWS.get(name) or FOLLOWS[name.partition(": ")[2]]
        lines.append(f"| {name} | {shown(after_ns, unit)} | {words} |")
    return "\n".join(lines) + "\n"


def with_table(page: str, name: str, text: str) -> str:
    """Return a page with a table between its marks."""
    begin, end = f"<!-- instants of {name}: begin -->\n", f"<!-- instants of {name}: end -->"
    head, _, rest = page.partition(begin)
    return head + begin + text + end + rest.partition(end)[2]


def drawn(source: Source) -> tuple[Picture, str]:
    """Record a source; return its picture, and as SVG."""
    picture = source.draw(record(source.plan, source.case))
    return picture, svg(picture.title, picture.panels)


if __name__ == "__main__":
    for source in SOURCES:
        picture, text = drawn(source)
        (DOCS / "images" / f"source-{source.name}.svg").write_text(text, encoding="utf-8")
        path = DOCS / "sources" / f"{source.page}.md"
        page = path.read_text(encoding="utf-8")
        path.write_text(with_table(page, source.name, table(picture)), encoding="utf-8")
        print(path, source.name)
