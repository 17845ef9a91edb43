"""Each word of an image and each parameter changes something, or has its reason in the table.

Both ends run twice, once with a word altered on its way. The far end has to do something else in
between, or, where the table says that the word has no function, exactly the same.
"""

import csv
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from tests.profidrive.ends import Ends as ProfidriveEnds
from tests.speed_drive.ends import FAMILIES, MILLISECOND
from tests.speed_drive.ends import Ends as SpeedDriveEnds

from axisrig.bench.bus.cyclic.segment import CyclicSegment
from axisrig.bench.drive.profidrive.parameters import DriveParameters
from axisrig.bench.rig.profidrive.keys import DriveTable
from axisrig.kernel.drives.cyclic.carrier import CyclicCarrier
from axisrig.kernel.drives.power import Power
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.profidrive import parameters as parameter_words
from axisrig.kernel.profiles.profidrive import words
from axisrig.kernel.time.clock import MS, US

HERE = Path(__file__).parent
with (HERE / "word_effects.csv").open(encoding="utf-8", newline="") as file:
    ROWS = list(csv.DictReader(file))
WORDS = [row for row in ROWS if row["direction"] != "parameter"]
PARAMETERS = {int(row["word"]): row for row in ROWS if row["direction"] == "parameter"}
CYCLES = 48
EDGES_NS = [30 * MS + 300 * US, 31 * MS + 300 * US]
AHEAD_MM = 0.2
Codec = tuple[Sequence[str], Callable[[bytes], Sequence[int]], Callable[..., bytes]]


def position_m(time_s: float) -> float:
    """At rest for 20 ms, then up."""
    return (100.0 + 10.0 * max(0.0, time_s - 0.02)) * 1e-3


def ends_of(row: dict[str, str]) -> tuple[Any, dict[str, Codec]]:
    """Return both ends of a row, with names and codec of each direction."""
    cycle_ns = 600 * US
    if row["family"] == "profidrive":
        telegram = words.telegrams()[int(row["telegram"])]
        ends: Any = ProfidriveEnds(
            telegram.number, position_m, EDGES_NS, MILLISECOND, cycle_ns, row["edge"]
        )
        of_telegram = {"out": telegram.to_drive, "in": telegram.from_drive}
        return ends, {
            direction: (names, words.codec_of(names).unpack, words.codec_of(names).pack)
            for direction, names in of_telegram.items()
        }
    ends = SpeedDriveEnds(row["family"], position_m, EDGES_NS, MILLISECOND, edge=row["edge"])
    images = dict(zip(("out", "in"), FAMILIES[row["family"]].images, strict=True))
    return ends, {
        direction: (image.names, image.codec.unpack, image.codec.pack)
        for direction, image in images.items()
    }


class Between:
    """A drive on its segment with a word that is altered on its way from a cycle on."""

    def __init__(self, node: Any, codecs: dict[str, Codec], row: dict[str, str] | None) -> None:
        self._node, self._codecs, self._row = node, codecs, row
        self._exchanges = 0
        self.made: list[bytes] = []
        self.sent: list[bytes | None] = []

    @property
    def inputs(self) -> bytes:
        return bytes(self._node.inputs)

    def sample(self) -> None:
        self._node.sample()

    def cycle(self) -> None:
        self._node.cycle()

    def exchange(self, outputs: bytes | None) -> bytes:
        self._exchanges += 1
        self.sent.append(outputs)
        inputs = self._node.exchange(outputs and self._altered("out", outputs))
        self.made.append(inputs)
        return inputs and self._altered("in", inputs)

    def _altered(self, direction: str, data: bytes) -> bytes:
        row = self._row
        if row is None or row["direction"] != direction or self._exchanges <= int(row["since"]):
            return data
        names, unpack, pack = self._codecs[direction]
        values, place = list(unpack(data)), list(names).index(row["word"])
        values[place] ^= int(row["flips"], 16)
        return pack(*values)


def trace(row: dict[str, str], *, is_altered: bool) -> dict[str, list[Any]]:
    """Run both ends and return what the far end of the word does in each cycle."""
    ends, codecs = ends_of(row)
    between = Between(ends.node, codecs, row if is_altered else None)
    segment = CyclicSegment(
        ends.scheduler, {"Z": between}, MILLISECOND, lambda _axis, data: ends.port.receive(data)
    )
    ends.carrier = CyclicCarrier("bus", {"Z": ends.port}, segment.begin)
    seen: list[Any] = []
    for number in range(CYCLES):
        try:
            ends.cycle()
        except Alarm as alarm:
            seen.append(alarm.id)
            ends.link.send(ends.link.set_mm)
            continue
        link = ends.link
        if link.is_clear and number > 10:
            link.arm()
        ends.link.send(link.actual_mm + AHEAD_MM)
        seen.append(
            (
                link.power, link.actual_mm, link.is_armed, link.has_latched, link.latched_mm,
                link.is_actuated, link.second_increments, link.is_in_fault,
            )
        )  # fmt: skip
    if row["direction"] == "in":
        return {"control": seen, "sent": between.sent}
    moved = [
        (each.time_ns, each.position_m, each.velocity_m_s, each.kind) for each in ends.axis.commands
    ]
    return {"inputs": between.made, "axis": moved, "limits": ends.axis.limits}


def _name(row: dict[str, str]) -> str:
    return "-".join(row[column] for column in ("family", "telegram", "direction", "word"))


@pytest.mark.parametrize("row", WORDS, ids=_name)
def test_a_word_changes_something_or_has_no_function(row: dict[str, str]) -> None:
    differs = trace(row, is_altered=False) != trace(row, is_altered=True)
    assert differs is (row["acts"] == "yes")
    assert row["what"]


@pytest.mark.parametrize(
    "row", [row for row in WORDS if row["direction"] == "in" and row["since"] == "24"], ids=_name
)
def test_unaltered_both_ends_operate_and_measure(row: dict[str, str]) -> None:
    """Otherwise nothing that a word does could be seen."""
    seen = trace(row, is_altered=False)["control"]
    assert seen[-1][0] is Power.OPERATING
    (value_mm,) = {each[4] for each in seen} - {None}
    edge_ns = EDGES_NS[row["edge"] == "NEG"]
    assert value_mm == pytest.approx(position_m((edge_ns + 4 * US) * 1e-9) * 1e3, abs=2.5e-3)


def test_each_word_of_each_image_is_in_the_table() -> None:
    listed = {(row["family"], row["direction"], row["word"]) for row in WORDS}
    known = {
        (family, direction, name)
        for family, made in FAMILIES.items()
        for direction, image in zip(("out", "in"), made.images, strict=True)
        for name in image.names
    }
    for telegram in words.telegrams().values():
        known |= {("profidrive", "out", name) for name in telegram.to_drive}
        known |= {("profidrive", "in", name) for name in telegram.from_drive}
    assert listed == known


def test_each_parameter_has_a_test_or_cannot_be_written() -> None:
    """A row of a test that shows what it does, or the error of a write (0x01)."""
    assert set(PARAMETERS) == set(parameter_words.parameters())
    drive = DriveParameters(DriveTable.model_validate({"family": "profidrive"}).make())
    texts = [path.read_text("utf-8") for path in HERE.parent.glob("*/test_*profidrive*.py")]
    tests = {name for text in texts for name in re.findall(r"^def (test_\w+)", text, re.M)}
    for number, row in PARAMETERS.items():
        known, before = parameter_words.parameters()[number], dict(drive.values)
        data = before[number].to_bytes(known.bits // 8, "big")
        found = drive.answer(parameter_words.Request(1, number, 0, data).pack())
        is_refused = bool(found[1] & parameter_words.NEGATIVE)
        assert is_refused is known.is_read_only is (row["acts"] == "no")
        assert drive.values == before
        assert row["what"] in tests if row["acts"] == "yes" else row["what"].startswith("read only")


INCREMENTS_UM = {
    "conventional": 1e4 / 4096,
    "encoder_terminal": 1e4 / 4096,
    "lightbus": 1.0 + 1e4 / 2**20,
    "profidrive": 1e4 / 2**22,
}
"""Of a latched value; on Lightbus the position is rounded before it is counted in um."""


@pytest.mark.parametrize("edge", ["POS", "NEG"])
def test_families_agree_on_the_value_of_the_same_edge(edge: str) -> None:
    """The same motion and signal: to half an increment of each of two."""
    families = [name for name in INCREMENTS_UM if edge == "POS" or name != "encoder_terminal"]
    values_um = {}
    for family in families:
        row = {"family": family, "telegram": "5", "edge": edge, "direction": "in"}
        (value_mm,) = {each[4] for each in trace(row, is_altered=False)["control"]} - {None}
        values_um[family] = value_mm * 1e3
    for one in families:
        for other in families:
            most_um = (INCREMENTS_UM[one] + INCREMENTS_UM[other]) / 2
            assert abs(values_um[one] - values_um[other]) <= most_um
