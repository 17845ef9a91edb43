"""Timing diagrams of the sources: the instants of each run are those of the page's formula.

The closed forms are written out here from the numbers of the rigs, read as the text they are; of
the recording they take the contact, and where a handshake begins.
"""

import csv
import html
import importlib
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.plans.shipped_files import PLANS, rig_of

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
US, MS = 1_000, 1_000_000
SYNC_NS = 48 * US  # 44 bits and 4 stuff bits at 1 Mbit/s
MADE_AGAIN = "run `python docs/plots/source_timing.py`"
NAMES = (
    *("drive", "plc", "plc-drive-input", "plc-io-node", "plc-first-event", "plc-timestamp"),
    *("plc-ext-latch-control", "ext-probe-with-drive", "fixed-stop"),
)


@pytest.fixture(scope="module")
def timing() -> Iterator[Any]:
    folder = str(DOCS / "plots")
    sys.path.insert(0, folder)
    yield importlib.import_module("source_timing")
    sys.path.remove(folder)


@pytest.fixture(scope="module", params=NAMES)
def shown(request: pytest.FixtureRequest, timing: Any) -> tuple[Any, Any, Any]:
    """The source, its recording and its picture."""
    (source,) = (each for each in timing.SOURCES if each.name == request.param)
    found = timing.record(source.plan, source.case)
    return source, found, source.draw(found)


def _row(source: Any) -> dict[str, str]:
    with (PLANS / f"{source.plan}.csv").open(encoding="utf-8", newline="") as file:
        default, *rows = csv.DictReader(file)
    (row,) = (each for each in [default, *rows] if each["case"] == source.case)
    if default["case"] == "*":
        row = {column: row[column] or default[column] for column in row}
    return row


class Rig:
    """Cycles and delays of a row, ns."""

    def __init__(self, source: Any) -> None:
        row = _row(source)
        table = rig_of(PLANS / row["rig"])
        self.cnc, self.turn = (table["cycle"][key] * US for key in ("period_us", "cycle_offset_us"))
        plc, servo = table.get("plc", {}), table["drive"]["servo"]
        self.plc, self.offset = plc.get("period_us", 1) * US, plc.get("offset_us", 0) * US
        self.of_drive = round(servo.get("input_delay_us", 0) * US)
        self.of_terminal = round(float(row.get("plc:terminal.filter_us") or 0) * US)
        self.switch_on = round(float(row.get("plc:V.E.SWITCH_ON_MS") or 0) * MS)

    def sync_from(self, time_ns: int) -> int:
        return time_ns + (SYNC_NS - time_ns) % self.cnc

    def nc_after(self, time_ns: int) -> int:
        return time_ns + 1 + (self.turn - time_ns - 1) % self.cnc

    def plc_from(self, time_ns: int) -> int:
        return time_ns + (self.offset - time_ns) % self.plc

    def plc_after(self, time_ns: int) -> int:
        return self.plc_from(time_ns + 1)

    @property
    def age(self) -> int:
        return self.turn - SYNC_NS

    def seen(self, plc_ns: int) -> dict[str, int]:
        """What follows from the cycle of the PLC that writes the signal."""
        cnc = self.nc_after(plc_ns)
        return {
            "cycle of the PLC that writes": plc_ns,
            "NC cycle that sees the signal": cnc,
            "NC cycle of the first set position that brakes": cnc,
            "SYNC whose position is the value": cnc - self.age,
        }

    def at_terminal(self, contact_ns: int) -> dict[str, int]:
        image = self.plc_from(contact_ns + self.of_terminal)
        return {"exchange of the terminal": image, **self.seen(image)}

    def in_drive(self, contact_ns: int) -> dict[str, int]:
        latch = contact_ns + self.of_drive
        sync = self.sync_from(latch)
        return {
            "edge latched: value": latch,
            "SYNC that samples status and latch": sync,
            "NC cycle that sees the status": sync + self.age,
            "NC cycle of the first set position that brakes": sync + self.age,
        }

    def handshake(self, task: str, asked_ns: int, ready_ns: int = 0) -> dict[str, int]:
        read = self.plc_after(asked_ns)
        done = self.plc_from(read + ready_ns)
        return {
            f"{task}: NC cycle that asks": asked_ns,
            f"{task}: cycle of the PLC that reads it": read,
            f"{task}: cycle of the PLC that acknowledges": done,
            f"{task}: NC cycle that sees it": self.nc_after(done),
        }


def _since(zero_ns: int, instants: dict[str, int]) -> dict[str, int]:
    return {name: time_ns - zero_ns for name, time_ns in instants.items()}


def _expected(source: Any, found: Any) -> dict[str, int]:
    """Instants from the contact, those of handshakes from where they begin."""
    rig, contact = Rig(source), found.contact_ns
    begin, end = found.run.begin_ns, found.run.end_ns
    enable = _since(begin, rig.handshake("ENABLE", begin + rig.cnc))
    disable = _since(end, rig.handshake("DISABLE", end))
    sync = rig.sync_from(contact + rig.of_terminal)
    read = rig.sync_from(contact + rig.of_drive) + rig.age
    stamp = contact + rig.of_terminal
    of_contact = {
        "drive": lambda: rig.in_drive(contact),
        "ext-probe-with-drive": lambda: rig.in_drive(contact),
        "plc-drive-input": lambda: {
            "SYNC that samples 60FD": read - rig.age,
            "NC cycle that has 60FD": read,
            **rig.seen(rig.plc_after(read)),
        },
        # The PLC has the telegram of the SYNC before it
        "plc-io-node": lambda: {
            "SYNC that samples the level": rig.plc_from(sync) - rig.offset % rig.cnc + SYNC_NS,
            **rig.seen(rig.plc_from(sync)),
        },
        "plc-timestamp": lambda: {
            "stamp of the terminal: value": stamp,
            **{k: v for k, v in rig.at_terminal(contact).items() if not k.startswith("SYNC")},
        },
    }.get(source.name, lambda: rig.at_terminal(contact))
    expected = _since(contact, of_contact())
    if source.name == "plc-ext-latch-control":
        return {**enable, **expected, **disable}
    if source.name == "ext-probe-with-drive":
        asked = found.handshake(1).asked_ns
        prepare = _since(asked, rig.handshake("PREPARE", asked, rig.switch_on))
        return {**prepare, **enable, **expected, **disable}
    return expected


@pytest.mark.long
def test_the_instants_of_the_run_are_those_of_the_formula(shown: tuple[Any, Any, Any]) -> None:
    source, found, picture = shown
    if source.name != "fixed-stop":
        assert dict(picture.instants) == _expected(source, found)
        return
    # Kv 40 1/s, d 2; 36.2 % of 2.2 N.m on 10 mm against 20 N/um; P-AXIS-00774, 00775 of the row
    row = _row(source)
    detect = "set:Z.kenngr.measure.fixed_stop_detect."
    v = float(row["plc:V.E.FEED"]) / 60
    limit, tau_ns = float(row[f"{detect}pos_lag_limit"]) / 1e4, int(row[f"{detect}min_time"]) * US
    pressed = float(row["plc:V.E.LIMIT"]) / 1e3 * 2.2 * 2 * 3.141592653589793 / 0.01 / 20e3
    due_ns = (limit - v / 40 + pressed) / v * 1e9
    rig, instants = Rig(source), picture.instants
    assert due_ns + rig.age - 0.05 * MS <= instants["lag above its limit"]
    assert instants["lag above its limit"] <= due_ns + rig.age + rig.cnc + 0.05 * MS
    assert instants["stop found: value"] - instants["lag above its limit"] == tau_ns
    assert instants["set position at rest"] - instants["stop found: value"] == v / 1000 * 1e9
    assert instants["end of the relaxing motion"] > instants["set position at rest"]


@pytest.mark.long
def test_the_value_is_the_true_position_of_its_instant(shown: tuple[Any, Any, Any]) -> None:
    """Within an increment of 9.54 nm."""
    _source, found, picture = shown
    curve = next(panel.curve for panel in picture.panels if panel.curve is not None)
    truth_mm = float(found.truth_mm(curve.dot[0]))
    assert found.run.latched_mm["Z"] == pytest.approx(truth_mm, abs=10 / 2**20)


@pytest.mark.long
def test_the_page_shows_this_picture_and_its_instants(
    shown: tuple[Any, Any, Any], timing: Any
) -> None:
    source, _found, picture = shown
    stored = DOCS / "images" / f"source-{source.name}.svg"
    assert stored.read_text(encoding="utf-8") == timing.svg(picture.title, picture.panels), (
        MADE_AGAIN
    )
    page = (DOCS / "sources" / f"{source.page}.md").read_text(encoding="utf-8")
    assert f"](../images/{stored.name})" in page
    assert timing.with_table(page, source.name, timing.table(picture)) == page, MADE_AGAIN
    assert f"testplans/{source.plan}.csv" in page
    assert re.search(rf"row `{re.escape(source.case)}`", page)


def test_every_source_has_a_page_with_the_same_parts() -> None:
    pages = sorted((DOCS / "sources").glob("*.md"))
    assert len(pages) == 7
    for page in pages:
        text = page.read_text(encoding="utf-8")
        titles = [line[3:] for line in text.splitlines() if line.startswith("## ")]
        wanted = ["Timing", "Delay", "Parameters", "What goes wrong", "Rig and program"]
        assert [title for title in titles if title in wanted] == wanted, page.name


@pytest.mark.parametrize("name", NAMES)
def test_no_words_of_a_picture_cover_others(name: str, timing: Any) -> None:
    """Boxes as wide as the script reckons; a title is wider than its picture in none."""
    diagram = importlib.import_module("timing_diagram")
    assert set(NAMES) == {source.name for source in timing.SOURCES}
    svg = (DOCS / "images" / f"source-{name}.svg").read_text(encoding="utf-8")
    found = re.findall(r'<text x="([\d.]+)" y="([\d.]+)".*?anchor="(\w+)">(.*?)</text>', svg)
    assert len(found) > 8
    boxes = []
    for x, y, anchor, escaped in found:
        words = html.unescape(escaped)
        room = diagram.width_px(words)
        left = float(x) - {"start": 0.0, "middle": room / 2, "end": room}[anchor]
        assert 0 <= left <= left + room <= diagram.WIDTH, words
        boxes.append((left, left + room, float(y) - 9, float(y) + 2, words))
    for place, (left, right, top, bottom, words) in enumerate(boxes):
        for other in boxes[place + 1 :]:
            is_apart = right < other[0] or other[1] < left or bottom < other[2] or other[3] < top
            assert is_apart, (words, other[4])
