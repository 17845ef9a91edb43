"""Every row of the table of reactions, provoked: what the kernel says and what it publishes.

The tables are `fault_reactions.csv` of `bench/axisrig/bench/bus/can` and of
`bench/axisrig/bench/bus/ethercat`; docs/faults.md shows both to readers.
"""

import csv
from pathlib import Path

import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.checks import parse_condition
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.rig.reading.faults import fault_kinds
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.bench.tools.scenarios.campaign import examine
from axisrig.bench.tools.scenarios.oracle import Result
from axisrig.bench.tools.scenarios.scenario import Scenario
from axisrig.kernel.errors import catalogue
from axisrig.kernel.nc.text.parser import read_program

ROOT = Path(__file__).parents[2]
BUSES = ROOT / "bench" / "axisrig" / "bench" / "bus"
ROWS, OF_LINES, OF_IMAGES = (
    list(csv.DictReader((BUSES / carrier / "fault_reactions.csv").read_text("utf-8").splitlines()))
    for carrier in ("can", "ethercat", "cyclic")
)
INPUTS = ("plc:V.E.FEED1=900", "plc:V.E.FEED2=300", "plc:V.E.RETRACT=0.2")
MS = 1_000_000
MISSING_CYCLES = 3
"""`missing_cycles` of the rig, its default."""


@pytest.mark.long(but=1)
@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['kind']} {row['example']}")
def test_the_reaction_is_the_documented_one(row: dict[str, str]) -> None:
    """The last alarm is one of the row, or none; values are right, or there is none.

    What no control can know is a wrong value without any alarm.
    """
    judgement, _ = examine(Scenario(0, 1, (*INPUTS, f"fault:{row['kind']}={row['example']}")))
    if row["value"] == "wrong":
        assert (judgement.result, judgement.alarms) == (Result.GOOD, []), judgement.note
        assert judgement.right < 4
        return
    assert judgement.result in (Result.GOOD, Result.ALARM), judgement.note
    ending = [i for i in judgement.alarms if catalogue()[i].reaction_class > 1]
    assert parse_condition(row["alarms"], "alarms").judge(ending[-1:]) is Verdict.PASS
    values = {"right": [4], "none": [0], "right or none": [0, 2, 4]}[row["value"]]
    assert judgement.right in values


@pytest.mark.long
@pytest.mark.parametrize(
    ("fault", "alarm_id"),
    [
        ("drop=Z.TPDO1", 900006), ("drop=Z.TPDO2", 900006), ("sync_loss=Z", 900006),
        ("sync_loss=can1", 900006), ("alter=Z.TPDO1 byte=1 xor=0x40", 900081),
        ("second_sender=Z.TPDO1", 900080), ("reset=Z command=pre_operational", 900006),
    ],
)  # fmt: skip
@pytest.mark.provokes(900080, 7, axis="Z", pdo="TPDO1", cycles=4)
def test_the_axis_is_stopped_within_the_configured_cycles(fault: str, alarm_id: int) -> None:
    """The cycle after `missing_cycles` bad ones brakes: its number counts from the first bad one.

    The fault begins 5 ms after the motion, between two cycles, or with the next frame of its kind.
    """
    judgement, machine = examine(Scenario(0, 1, (*INPUTS, f"fault:{fault} at=motion+5ms")))
    assert machine is not None
    assert judgement.alarms == [alarm_id]
    start_ns = machine.channel.records[0].start_ns
    assert start_ns is not None
    begin_ns = start_ns + 5 * MS
    cycles = (machine.channel.alarm_ns[0] - begin_ns) / MS
    assert MISSING_CYCLES < cycles <= MISSING_CYCLES + 2


LINE_RIG = ROOT / "testplans" / "rigs" / "probe-z-ethercat.toml"
LINE_PLANS = ("ethercat", "sercos")
IMAGES_RIG = LINE_RIG.with_name("probe-z-profidrive.toml")
IDENTS_RIG = LINE_RIG.with_name("probe-z-sercos.toml")
"""For kinds of drives with idents."""
TOUCH = """%touch
N10 G90 G01 Z102 F6000
N20 G100 Z98 F600
N25 $IF V.A.MERF.Z == 1
N30 #MSG SYN["z=%f", V.A.MEAS.ACS.VALUE.Z]
N35 $ENDIF
N40 M30
"""
EDGE_MM = 100.0 - 10.0 * 4e-6
"""The surface, and what the axis moves on at 10 mm/s within the delay of the input."""
INCREMENT_MM = 10.0 / 2**20
FINE_INCREMENT_MM = 10.0 / 2**22
"""2048 lines and 11 bits."""


def run_on_line(
    tmp_path: Path, fault: str, other: Path | None = None
) -> tuple[list[int], list[float]]:
    """Alarms and measured values of one touch with a fault, on EtherCAT or with another rig."""
    (tmp_path / "touch.nc").write_text(TOUCH, encoding="utf-8")
    assigned = [
        (parse_assignment(text), as_written)
        for text in (f"fault:{fault}", "plant:z.position_start_mm=102")
    ]
    kind = fault_kinds()[fault.partition("=")[0]]
    rig = other or (IDENTS_RIG if kind.room == "idents" else LINE_RIG)
    settings = read_settings(*read_rig(rig), assigned)
    machine = Machine(settings, read_program(tmp_path / "touch.nc", ("Z",)))
    try:
        machine.run()
    finally:
        machine.close()
    values = [float(message.shown.partition("=")[2]) for message in machine.messages]
    return [alarm.id for alarm in machine.channel.alarms], values


@pytest.mark.long(but=1)
@pytest.mark.parametrize("row", OF_LINES, ids=lambda row: f"{row['kind']} {row['example']}")
def test_the_reaction_on_a_line_is_the_documented_one(tmp_path: Path, row: dict[str, str]) -> None:
    alarms, values = run_on_line(tmp_path, f"{row['kind']}={row['example']}")
    ending = [i for i in alarms if catalogue()[i].reaction_class > 1]
    assert parse_condition(row["alarms"], "alarms").judge(ending[:1]) is Verdict.PASS
    # The printed text has six decimals
    right = [pytest.approx(EDGE_MM, abs=INCREMENT_MM + 1e-6)]
    assert values == {"right": right, "none": []}[row["value"]]


@pytest.mark.long(but=1)
@pytest.mark.parametrize("row", OF_IMAGES, ids=lambda row: f"{row['kind']} {row['example']}")
def test_the_reaction_on_a_cyclic_segment_is_the_documented_one(
    tmp_path: Path, row: dict[str, str]
) -> None:
    alarms, values = run_on_line(tmp_path, f"{row['kind']}={row['example']}", IMAGES_RIG)
    ending = [i for i in alarms if catalogue()[i].reaction_class > 1]
    assert parse_condition(row["alarms"], "alarms").judge(ending[:1]) is Verdict.PASS
    right = [pytest.approx(EDGE_MM, abs=FINE_INCREMENT_MM + 1e-6)]
    assert values == {"right": right, "none": []}[row["value"]]


def test_every_kind_of_fault_has_a_reaction() -> None:
    """Of what these machines have not (sensors, PLC, ...), rows of a plan are that."""
    text = (ROOT / "testplans" / "wires.csv").read_text(encoding="utf-8")
    kinds = {row["kind"] for row in (*ROWS, *OF_LINES, *OF_IMAGES)}
    for kind in fault_kinds().values():
        assert kind.name in kinds or f"fault:{kind.name}" in text, kind.name
        assert kind.name in kinds or kind.room in ("sensors", "plants", "plc", "clock")
    plans = [(ROOT / "testplans" / f"{name}.csv").read_text("utf-8") for name in LINE_PLANS]
    assert [row["kind"] for row in OF_LINES if f"fault:{row['kind']}" not in "".join(plans)] == []


def test_the_document_shows_the_table() -> None:
    text = (ROOT / "docs" / "faults.md").read_text("utf-8")
    shown = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in text.splitlines()
        if line.startswith("| `fault:")
    ]
    assert shown == [
        [f"`fault:{row['kind']} = {row['example']}`", *list(row.values())[2:]]
        for row in (*ROWS, *OF_LINES, *OF_IMAGES)
    ]


def test_every_alarm_of_the_table_is_in_the_catalogue() -> None:
    ids = {word for row in (*ROWS, *OF_LINES, *OF_IMAGES) for word in row["alarms"].split()} - {
        "none",
        "one",
        "of",
    }
    assert {int(word) for word in ids} <= set(catalogue())
