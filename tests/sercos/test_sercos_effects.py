"""Each ident that can be written changes something; each other one has its reason in the table."""

import csv
import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.cia402.monitor import FOLLOWING_ERROR, Monitor
from axisrig.bench.drive.sercos.idents import rows
from axisrig.bench.drive.sercos.probe_unit import ProbeUnit
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.bench.tools.virtual_drive.watch import EthercatWatcher
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.profiles.sercos.service import (
    ERROR_CODE,
    HEADER,
    Element,
    Header,
    Operation,
    command_states,
    ident_number,
    pack_list,
    soe_errors,
)
from axisrig.kernel.time.clock import S

ROOT = Path(__file__).parents[2]
EFFECTS = list(csv.DictReader((Path(__file__).parent / "ident_effects.csv").open("r")))
RIGS = ROOT / "testplans" / "rigs"
Open = Callable[[str], Any]


@pytest.fixture
def drive_of(tmp_path: Path) -> Iterator[Open]:
    """Return the virtual drive of a shipped rig, in PREOP."""
    (tmp_path / "own.nc").write_text("%own\nN10 M30\n", encoding="utf-8")
    machines: list[Machine] = []

    def make(rig: str) -> Any:
        changes = [(parse_assignment("drive:servo.latch_check=true"), as_written)]
        settings = read_settings(*read_rig(RIGS / rig), changes)
        machines.append(Machine(settings, read_program(tmp_path / "own.nc", ("Z",))))
        part: Any = machines[-1].installed[0]
        return part.nodes["Z"]

    yield make
    for machine in machines:
        machine.close()


def written(drive: Any, ident: str, data: bytes) -> str | None:
    """Write a value; return the name of the code that refuses it."""
    head = Header(Operation.WRITE, 0, Element.VALUE, ident_number(ident))
    (answer,) = drive.channel.serve(head.pack() + data)
    if not Header.read(answer).is_error:
        return None
    code = ERROR_CODE.unpack_from(answer, HEADER.size)[0]
    return next(name for name, number in soe_errors().items() if number == code)


def test_each_ident_that_can_be_written_is_in_the_table() -> None:
    may = [row["ident"] for row in rows() if row["access"] == "rw"]
    assert [row["ident"] for row in EFFECTS] == may
    texts = [path.read_text("utf-8") for path in sorted((ROOT / "tests" / "sercos").glob("*.py"))]
    tests = {name for text in texts for name in re.findall(r"^def (test_\w+)", text, re.M)}
    cases = {
        line.partition(",")[0]
        for plan in ("sercos", "fixed_stop_sercos")
        for line in (ROOT / "testplans" / f"{plan}.csv").read_text("utf-8").splitlines()
    }
    assert {row["shown_by"] for row in EFFECTS} <= tests | cases


def test_values_of_the_drive_itself_are_read_only(drive_of: Open) -> None:
    drive = drive_of("probe-z-sercos-two.toml")
    for row in rows():
        if row["access"] == "ro" and row["form"] == "value":
            assert written(drive, row["ident"], bytes(int(row["bytes"]))) == "READ_ONLY", row


def test_cyclic_set_values_are_taken_from_the_telegram_alone(drive_of: Open) -> None:
    drive = drive_of("probe-z-sercos.toml")
    for row in rows():
        if row["access"] == "ignored":
            ident = ident_number(row["ident"])
            before = drive.idents.number(ident)
            assert written(drive, row["ident"], (77).to_bytes(int(row["bytes"]), "little")) is None
            assert drive.idents.number(ident) == before


def test_another_telegram_type_is_refused_before_phase_3(drive_of: Open) -> None:
    drive = drive_of("probe-z-sercos.toml")
    assert written(drive, "S-0-0015", (4).to_bytes(2, "little")) is None
    assert drive.telegrams.wrong() == [ident_number("S-0-0015")]
    assert written(drive, "S-0-0127", (3).to_bytes(2, "little")) is None
    assert drive.idents.table[ident_number("S-0-0127")].state == command_states()["FAILED"]


def test_the_lists_decide_on_the_telegrams(drive_of: Open) -> None:
    """An MDT with S-0-0092 is two bytes longer."""
    drive = drive_of("probe-z-sercos.toml")
    assert written(drive, "S-0-0015", (7).to_bytes(2, "little")) is None
    sizes = []
    for names in (["S-0-0047"], ["S-0-0047", "S-0-0092"]):
        listed = [ident_number(name) for name in names]
        assert written(drive, "S-0-0024", pack_list(listed, 2, len(listed))) is None
        drive.telegrams.compile()
        sizes.append(drive.telegrams.outputs.codec.size)
    assert sizes == [6, 8]


@pytest.mark.parametrize(
    ("factor", "exponent", "per_turn"), [(1, -7, 100_000), (5, -6, 2000), (2, -6, 5000)]
)
def test_factor_and_exponent_are_the_unit_of_linear_positions(
    drive_of: Open, factor: int, exponent: int, per_turn: int
) -> None:
    """S-0-0077 10^(S-0-0078) m by a lead of 10 mm, where S-0-0076 is linear by parameter."""
    drive = drive_of("probe-z-sercos.toml")
    for ident, number in (("S-0-0077", factor), ("S-0-0078", exponent), ("S-0-0076", 0x09)):
        assert written(drive, ident, number.to_bytes(2, "little", signed=True)) is None
    image = drive.servo.image
    assert image.feed == per_turn * image.feed_shaft


def test_a_mode_that_there_is_not_is_refused(drive_of: Open) -> None:
    drive = drive_of("probe-z-sercos.toml")
    assert written(drive, "S-0-0032", (2).to_bytes(2, "little")) == "INVALID"
    assert written(drive, "S-0-0032", (3).to_bytes(2, "little")) is None


def test_a_window_of_0_watches_no_lag_and_any_other_is_the_window(drive_of: Open) -> None:
    """FCT-C4 7.3 switches the monitoring off by S-0-0159 = 0, and later on again."""
    drive = drive_of("probe-z-sercos.toml")
    following: Any = SimpleNamespace(limits_speed=False, follows_position=True, is_following=True)
    for window in (100, 0, 101, 99):
        assert written(drive, "S-0-0159", window.to_bytes(4, "little")) is None
        assert drive.idents.number(ident_number("S-0-0159")) == window
        image = drive.servo.image
        image.following_error, image.following_timeout_ms = -100, 0
        monitor = Monitor(image, drive.servo.limits, drive.servo.axis)
        monitor.begin(following)
        assert (monitor.is_active, monitor.look(S)) == (
            window != 0,
            FOLLOWING_ERROR if window == 99 else None,
        )


def test_a_latch_for_a_foreign_master_has_the_name_of_its_ident_and_mm(drive_of: Open) -> None:
    """12.3456 mm at 2^20 a turn of 10 mm are 1 294 530 increments."""
    node = drive_of("probe-z-sercos.toml")
    axis = SimpleNamespace(plant="z", probe_1=None)
    settings: Any = SimpleNamespace(rig=SimpleNamespace(axis={"Z": axis}))
    lines: list[str] = []
    plant: Any = None
    with ExitStack() as opened:
        watch = EthercatWatcher(settings, {"Z": node}, plant, lines.append, None, opened)
        node.image.latch_1_positive, node.image.count_1_positive = 1_294_530, 1
        node.servo.touch_probe.probes[0].latches[True].instant_ns = 5_000_000
        watch.look(6_000_000)
    assert lines == ["    0.005000 s  Z    latch   probe 1, S-0-0130 = 1294530 = 12.345600 mm"]


@pytest.mark.interpreted
@pytest.mark.parametrize("enabled", [(), (0,), (1,), (0, 1)])
def test_each_probe_does_what_its_own_bits_say(enabled: tuple[int, ...]) -> None:
    """S-0-0169: bits 0, 1 edges of probe 1, 2, 3 of probe 2, 5 continuous. 60B8: bit 0 on, 1 every
    event, 4, 5 edges, 6 second encoder; those of probe 2 are 8 bits higher.
    """
    profile: Any = SimpleNamespace(needs_input=False)
    unit: Any = None
    select = 0
    probing = ProbeUnit(profile, unit, lambda: select, lambda probe: probe in enabled)
    for select in (*range(16), *range(1 << 5, (1 << 5) + 16)):
        probing.begin()
        words = []
        for number in (0, 1):
            own = select >> 2 * number & 3 if number in enabled else 0
            on = 1 | (2 if select >> 5 else 0) | (1 << 6 if number else 0)
            words.append(own << 4 | (on if own else 0))
        assert probing.function() == words[0] | words[1] << 8, select
        probing.end()
        assert probing.function() == 0


def test_the_second_enable_arms_the_second_probe(drive_of: Open) -> None:
    drive = drive_of("probe-z-sercos-two.toml")
    assert written(drive, "S-0-0169", (4).to_bytes(2, "little")) is None
    drive.probing.begin()
    assert drive.probing.function() == 0
    assert written(drive, "S-0-0406", (1).to_bytes(2, "little")) is None
    assert drive.probing.function() & 0xFF00


@pytest.mark.parametrize(("allocation", "bit"), [("S-0-0301", 1 << 6), ("S-0-0303", 1 << 7)])
def test_a_real_time_bit_begins_and_ends_the_probing_cycle(
    drive_of: Open, allocation: str, bit: int
) -> None:
    """Its data state follows: 7 while it runs, 0 when it is off, as often as the bit changes."""
    states = command_states()
    drive = drive_of("probe-z-sercos.toml")
    command = drive.idents.table[ident_number("S-0-0170")]
    assert written(drive, "S-0-0169", (1).to_bytes(2, "little")) is None
    assert written(drive, allocation, ident_number("S-0-0170").to_bytes(2, "little")) is None
    for level in (bit, 0, bit, bit, 0):
        drive._take_control(level)
        state = states["RUNNING" if level else "IDLE"]
        assert (drive.probing.is_running, command.state) == (bool(level), state)
