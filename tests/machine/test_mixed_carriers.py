"""A machine with all kinds of segments at once: what belongs to which axis, and what it leaves.

X and Y on a CAN bus each, Z (CiA 402) and V (SERCOS) on one EtherCAT line, W (PROFIdrive) on a
cyclic segment. The program does nothing: drives start, and leave what they leave.
"""

import hashlib
import random
from pathlib import Path
from typing import Any, NamedTuple

import can
import pytest
from tests.machine.made_rigs import RIGS, above, settings_of

from axisrig.bench.bus.can.frame import Frame, frame_bits
from axisrig.bench.drive.axis.input_circuit import InputCircuit
from axisrig.bench.drive.cia402.functions import touch_probe
from axisrig.bench.machine.cia402 import LOAD_SPAN_NS
from axisrig.bench.machine.ethercat.family import _files
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.faults.acts import Injected
from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.recording.received import Received
from axisrig.bench.record.facts import Facts
from axisrig.bench.rig.reading.faults import read_faults
from axisrig.kernel.drives.power import Power
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, S

RIG = """
[segment.can2]
bitrate = 800_000
[segment.bus]
carrier = "cyclic"
input_us = 125.0
[drive.soe]
family = "sercos"
idents = [
    ["S-0-0169", 1], ["S-0-0301", "S-0-0405"],
    ["S-0-0305", "S-0-0409"], ["S-0-0307", "S-0-0401"],
]
[drive.dp]
family = "profidrive"
p0660 = 80
[axis.V]
list = "axis-v.lst"
segment = "ec1"
drive = "soe"
plant = "v"
probe_1 = "probe"
[axis.W]
list = "axis-w.lst"
segment = "bus"
drive = "dp"
plant = "w"
probe_1 = "probe"
[plant.v]
fmu = "AxisRig.Drives.ServoAxis"
[plant.w]
fmu = "AxisRig.Drives.ServoAxis"
"""
AXES = ["X", "Y", "Z", "V", "W"]
OF_SEGMENT = {"can1": ["X"], "can2": ["Y"], "ec1": ["Z", "V"], "bus": ["W"]}
SHARE = {"X": "can1", "Y": "can2", "Z": "ec1", "V": "ec1", "W": "bus"}


class Left(NamedTuple):
    """A run: the machine, its facts, and the frames of both CAN buses as python-can reads them."""

    machine: Machine
    facts: Facts
    frames: dict[str, list[can.Message]]


def machine_of(folder: Path, seed: int = 1) -> Machine:
    for name, of in (("v", "sercos"), ("w", "profidrive")):
        listed = (RIGS / "lists" / f"axis-z-{of}.lst").read_text(encoding="utf-8")
        lines = [line for line in listed.splitlines() if not line.startswith("kopf.")]
        (folder / f"axis-{name}.lst").write_text("\n".join(lines), encoding="utf-8")
    program = folder / "nothing.nc"
    program.write_text("%nothing\nN10 M30\n", encoding="utf-8")
    settings = settings_of(above(folder, "probe-xyz-mixed.toml", RIG))
    logs = [folder / "run.log"]
    return Machine(settings, read_program(program, tuple(AXES)), bus_logs=logs, seed=seed)


@pytest.fixture(scope="module")
def left(tmp_path_factory: pytest.TempPathFactory) -> Left:
    folder = tmp_path_factory.mktemp("mixed")
    machine = machine_of(folder)
    try:
        machine.run()
        facts = facts_of(machine)
    finally:
        machine.close()
    frames: dict[str, list[can.Message]] = {}
    for message in can.LogReader(folder / "run.log"):
        frames.setdefault(str(message.channel), []).append(message)
    assert facts.alarms == ()
    return Left(machine, facts, frames)


def test_each_axis_is_where_the_rig_has_it(left: Left) -> None:
    machine, facts = left.machine, left.facts
    assert [*machine.links] == [*machine.drives] == [*machine.part_of] == [*facts.axes] == AXES
    assert {name: axis.segment for name, axis in facts.axes.items()} == SHARE
    assert [facts.axes[name].node for name in AXES] == [1, 2, 0, 0, 0]
    for name, link in machine.links.items():
        assert link.name == name
        assert machine.part_of[name].links[name] is link
    assert len({id(part) for part in machine.part_of.values()}) == len(machine.installed) == 3
    assert [*machine._carriers] == [*OF_SEGMENT]


def test_each_drive_went_through_the_states_of_its_own(left: Left) -> None:
    """All are led into operation (ETG.6010, PROFIdrive) and nothing else happens."""
    for name in AXES:
        states = left.facts.axes[name].states
        words = [state.state for state in states]
        assert words[:2] == ["NOT_READY_TO_SWITCH_ON", "SWITCH_ON_DISABLED"], name
        assert words[-1] == "OPERATION_ENABLED", name
        assert words.count("OPERATION_ENABLED") == 1
        assert not any(state.is_trouble for state in states)
        times_ns = [state.time_ns for state in states]
        assert times_ns == sorted(times_ns)
        assert 0 < times_ns[-1] < left.facts.end_ns


@pytest.mark.parametrize(
    ("axis", "names", "fields"),
    [
        ("X", ("RPDO1", "TPDO1", "TPDO2", "TPDO3"), ("controlword", "target", "probe_function")),
        ("Z", ("RxPDO1", "TxPDO1"), ("controlword", "target", "probe_function")),
        ("V", ("RxPDO1", "TxPDO1"), ("controlword", "target")),
        ("W", ("outputs", "inputs"), ("STW1", "NSOLL_B", "STW2", "G1_STW", "XERR", "KPC")),
    ],
)
def test_telegrams_are_those_of_the_axis(
    left: Left, axis: str, names: tuple[str, ...], fields: tuple[str, ...]
) -> None:
    telegrams = left.facts.axes[axis].telegrams
    assert tuple(telegram.name for telegram in telegrams) == names
    assert telegrams[0].fields == fields  # to the drive
    assert ("actual" in telegrams[1].fields) or ("G1_XIST1" in telegrams[1].fields)
    assert [telegram.transmission for telegram in telegrams[:2]] == [1, 1]


def test_a_drive_on_a_line_has_its_own_part_of_the_frame(left: Left) -> None:
    """Z shows its digital inputs, V has no touch probe function in its telegram."""
    inputs = {name: left.facts.axes[name].telegrams[1].fields for name in "ZV"}
    assert ("inputs" in inputs["Z"], "inputs" in inputs["V"]) == (True, False)


def test_figures_of_a_bus_are_those_of_its_frames(left: Left) -> None:
    """Counted in the log by python-can; load: their bits with the intermission, of the run."""
    buses = {bus.segment: bus for bus in left.facts.buses}
    assert [*buses] == ["can1", "can2", "ec1"]  # cyclic segments have none
    for name, bitrate in (("can1", 1_000_000), ("can2", 800_000)):
        bus, frames = buses[name], left.frames[name]
        assert (bus.bitrate, bus.frames, bus.error_frames) == (bitrate, len(frames), 0)
        data = [(message.arbitration_id, bytes(message.data)) for message in frames]
        bits = sum(
            frame_bits(Frame(can_id, each, False, False, len(each))) for can_id, each in data
        )
        run_s = left.machine.scheduler.now_ns / S
        assert bus.load_pct == pytest.approx(100 * bits / (bitrate * run_s), rel=1e-9)
        assert bus.load_pct <= bus.load_100ms_pct <= bus.load_1ms_pct <= 100.0 + 1e-9
        assert (bus.counters, bus.changes, bus.line, bus.overload) == ((), (), None, "")


def test_what_waited_has_the_name_of_its_axis(left: Left) -> None:
    """Identifiers of CiA 301: 0x180, 0x280, 0x380 and 0x200 + node, SDO 0x580 and 0x600, 0x700."""
    base = {"TPDO1": 0x180, "TPDO2": 0x280, "TPDO3": 0x380, "RPDO1": 0x200,
            "SDO answer": 0x580, "SDO request": 0x600, "heartbeat": 0x700}  # fmt: skip
    for bus, axis, node in zip(left.facts.buses, "XY", (1, 2), strict=False):
        waits = [waiting.worst_us for waiting in bus.waiting]
        assert waits == sorted(waits, reverse=True)
        named = {waiting.name: waiting.can_id for waiting in bus.waiting if waiting.axis}
        assert named
        for name, can_id in named.items():
            of, _, what = name.partition(".")
            assert (of, can_id) == (axis, base[what] + node)
        assert {waiting.axis for waiting in bus.waiting} <= {axis, ""}


def test_a_line_reports_what_its_cycles_did(left: Left) -> None:
    """LRW counts 1 for a slave that is read and 2 for one that is written to: 3 for each drive."""
    (line,) = (bus.line for bus in left.facts.buses if bus.segment == "ec1")
    assert line is not None
    assert (line.period_us, line.counter) == (1000.0, 3 * len(OF_SEGMENT["ec1"]))
    assert line.slaves == (("Z", "OP"), ("V", "OP"))
    assert (line.wrong, line.wrong_in_a_row) == (0, 0)
    assert 0 <= line.sent - line.back <= 1


def test_the_hash_of_a_run_is_over_all_segments(left: Left) -> None:
    """In the order of the registry; one part of them does not stand for all."""
    parts = [part.hexdigest() for part in left.machine.installed]
    assert len({*parts}) == 3
    assert left.facts.frame_log_sha256 == hashlib.sha256("".join(parts).encode()).hexdigest()


def test_positions_are_as_old_as_their_carriers_make_them(left: Left) -> None:
    """CAN: sampled at the SYNC that was heard. Cyclic: T_I = 125 us before the begin."""
    machine, sync_ns = left.machine, left.machine.channel.sync_ns
    ages = {name: part.sampled_ns(name, sync_ns) for name, part in machine.part_of.items()}
    assert ages["W"] == sync_ns - 125_000
    assert ages["X"] == max(sync_ns, machine.drives["X"].sync_ns)
    # A SYNC has 44 bits and up to 8 stuff bits, 1 us each; at 800 kbit/s each takes 5/4 of that
    x_ns, y_ns = (machine.drives[name].sync_ns - sync_ns for name in "XY")
    assert 44_000 <= x_ns <= 52_000
    assert y_ns == x_ns * 5 // 4
    later_ns = sync_ns + 5 * MS
    assert machine.part_of["X"].sampled_ns("X", later_ns) == later_ns


@pytest.mark.interpreted  # it replaces a class of a compiled module
def test_each_input_of_each_drive_draws_its_own_numbers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two inputs of three drives, one of W: nowhere the same seed, in another run other ones."""
    seeds: list[int] = []
    of_run = []

    class Seeded(InputCircuit):
        def __init__(self, signal: Any, habits: Any, seed: int = 0) -> None:
            super().__init__(signal, habits, seed)
            seeds.append(seed)

    monkeypatch.setattr(touch_probe, "InputCircuit", Seeded)
    for run in (1, 2):
        machine_of(tmp_path, run).close()
        of_run.append([*seeds])
        assert len({*seeds}) == len(seeds) >= 2 * len(AXES)
        seeds.clear()
    assert not any(one == other for one, other in zip(*of_run, strict=True))


# --- what each kind of segment gives


def part(left: Left, axis: str) -> Any:
    return left.machine.part_of[axis]


def test_each_drive_is_reached_by_the_words_of_its_own_family(left: Left) -> None:
    """Objects of CiA 402, idents of SERCOS, parameters of PROFIdrive; each axis has its own."""
    ways = {axis: part(left, axis).functions() for axis in AXES}
    assert ways["X"] is not None
    assert {*part(left, "X").accesses} == {"X", "Y"}
    assert {*part(left, "Z").accesses} == {"Z"}  # V has idents
    on_line = ways["Z"]._by_axis
    assert {*on_line} == {"Z", "V"}
    assert [type(on_line[axis]).__name__ for axis in "ZV"] == ["DriveFunctions", "SercosAccesses"]
    assert {*ways["W"]._by_axis} == {"W"}
    whole = left.machine._build_functions()
    assert {*whole._by_axis} == {*AXES}  # type: ignore[attr-defined]
    for axis in AXES:
        assert left.machine.links[axis].name == axis
    assert [part(left, axis).warnings for axis in "XZW"] == [[], [], []]


def test_a_drive_is_off_without_torque_or_in_a_fault(
    left: Left, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of CiA 402 also where it is ready to switch on; the others by their power."""
    assert [part(left, axis).is_off(axis) for axis in AXES] == [False] * 5
    for axis in "VW":
        for power in Power:
            monkeypatch.setattr(left.machine.links[axis], "power", power)
            is_off = power in (Power.OFF, Power.FAULT)
            assert part(left, axis).is_off(axis) is is_off, (axis, power)
    for axis in "XZ":
        for state in State:
            off = state in (State.SWITCH_ON_DISABLED, State.READY_TO_SWITCH_ON, State.FAULT)
            monkeypatch.setattr(left.machine.links[axis], "state", state)
            assert part(left, axis).is_off(axis) is off, (axis, state)


def test_what_is_shown_of_each_segment_is_its_own(left: Left) -> None:
    buses = {one["segment"]: one for axis in "XZW" for one in part(left, axis).shown()}
    assert [*buses] == ["can1", "can2", "ec1"]
    assert [buses[name]["bitrate"] for name in buses] == [1_000_000, 800_000, 100_000_000]
    assert left.machine.scheduler.now_ns < LOAD_SPAN_NS  # so that the load is that of the whole run
    for name, figures in zip(("can1", "can2"), left.facts.buses, strict=False):
        assert buses[name]["frames"] == len(left.frames[name])
        assert buses[name]["load_pct"] == pytest.approx(figures.load_pct)
    assert buses["ec1"]["line"]["slaves"] == (("Z", "OP"), ("V", "OP"))
    assert [(one["is_outside"], one["lost"]) for one in buses.values()] == [(False, None)] * 3


def test_a_fault_is_built_in_where_its_segment_is_and_nowhere_else(left: Left) -> None:
    rig = left.machine.settings.rig
    for kind, text, axis in (
        ("drop", "Y.TPDO1", "Y"), ("line_lost", "ec1", "Z"), ("image_lost", "W", "W"),
        ("power_loss", "V", "V"), ("babble", "can2 id=5", "X"),
    ):  # fmt: skip
        (fault,) = read_faults(kind, text, rig)
        record = Injected(kind, fault.axis)
        built = [
            part(left, name).build_fault(fault, random.Random(1), record) is not None
            for name in "XZW"
        ]
        of = [part(left, name) is part(left, axis) for name in "XZW"]
        assert built == of, kind


def test_logs_of_lines_lie_beside_those_of_buses(tmp_path: Path) -> None:
    assert _files([], ["ec1"]) == []
    logs = [tmp_path / "p-run.blf", tmp_path / "other.log"]
    assert _files(logs, ["ec1", "ec2"]) == [
        ("ec1", tmp_path / "p-run@ec1.pcapng"), ("ec2", tmp_path / "p-run@ec2.pcapng"),
    ]  # fmt: skip


def test_telegrams_with_positions_come_as_the_controllers_took_them(tmp_path: Path) -> None:
    """6064 of X and Y, each by its own telegram; a position of 0 mm, and the earliest instant."""
    machine = machine_of(tmp_path)
    try:
        heard = Received()
        for installed in machine.installed:
            installed.listen(heard)
        machine.run()
        facts = facts_of(machine)
    finally:
        machine.close()
    assert {*heard.positions} == {"X", "Y"} == {*heard.increments} == {*heard.first_ns}
    for axis, bitrate in (("X", 1_000_000), ("Y", 800_000)):
        found = heard.positions[axis]
        assert 5 < len(found) <= facts.end_ns / MS
        times_ns = [at for at, _ in found]
        assert times_ns == sorted(times_ns)
        values = {heard.increments[axis](data) for _, data in found}
        per_mm = facts.axes[axis].increments_per_mm
        assert all(abs(value / per_mm) < 0.001 for value in values)
        size = len(found[0][1])  # SYNC, intermission and telegram without a stuff bit
        assert heard.first_ns[axis] == (44 + 3 + 44 + 8 * size) * S // bitrate
    assert heard.inputs == []
