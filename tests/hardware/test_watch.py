"""The lines of `axisrig drive`: frames written out by hand, and the lines they give."""

import csv
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.functions.touch_probe import Latch
from axisrig.bench.tools.virtual_drive.terminal_watch import TerminalWatcher
from axisrig.bench.tools.virtual_drive.watch import EthercatWatcher, Watcher
from axisrig.kernel.cosim.plant.probe import Contact
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize(
    ("can_id", "data", "found"),
    [
        (0x083, "11 86 21 00 00 00 00 00",
         "EMCY    0x8611, following error, error register 0x21"),
        (0x083, "00 00 00 00 00 00 00 00", "EMCY    reset, error register 0x00"),
        (0x583, "80 60 60 00 30 00 09 06",
         "SDO     abort of 0x6060:00 with 0x06090030, value is not allowed"),
        (0x583, "80 60 60 00 01 00 00 0F",
         "SDO     abort of 0x6060:00 with 0x0F000001, a code of the manufacturer"),
    ],
)  # fmt: skip
def test_codes_are_shown_in_words(can_id: int, data: str, found: str) -> None:
    axis = SimpleNamespace(segment="can1", plant="z")
    settings: Any = SimpleNamespace(rig=SimpleNamespace(axis={"Z": axis}))
    node: Any = SimpleNamespace(
        node_id=3,
        nmt_state=SimpleNamespace(name="OPERATIONAL"),
        state=State.SWITCHED_ON,
        image=ProcessImage(),
    )
    plant: Any = None
    lines: list[str] = []
    with ExitStack() as opened:
        watch = Watcher(settings, {"Z": node}, plant, lines.append, None, opened)
        watch(1_000_000, "can1", data_frame(can_id, bytes.fromhex(data)), False)
    assert lines == [f"    0.001000 s  Z    {found}"]


def machine(**contacts_ns: tuple[int, ...]) -> tuple[Any, Any]:
    """A rig with the axes X and Y, whose probes are at input 1 and 2; its plant with contacts.

    Where a probe touches, X is at as many mm as the instant has ms, Y at 100 mm more.
    """
    axes = {
        "X": SimpleNamespace(plant="x", probe_1="touch", probe_2=None),
        "Y": SimpleNamespace(plant="y", probe_1="touch", probe_2="other"),
    }
    probes = {
        name: SimpleNamespace(
            contacts=[Contact(at, {"x": at / MS, "y": 100 + at / MS}) for at in instants]
        )
        for name, instants in contacts_ns.items()
    }
    return SimpleNamespace(rig=SimpleNamespace(axis=axes)), SimpleNamespace(probes=probes)


def slave(units_per_mm: float) -> Any:
    """A drive of CiA 402 on a line, in operation."""
    probes = [SimpleNamespace(latches={True: Latch(), False: Latch()}) for _ in range(2)]
    return SimpleNamespace(
        states=SimpleNamespace(state=AlState.OP, code=0),
        state=State.OPERATION_ENABLED,
        image=ProcessImage(),
        profile=SimpleNamespace(units_per_mm=units_per_mm),
        servo=SimpleNamespace(touch_probe=SimpleNamespace(probes=probes)),
    )


def latch(node: Any, probe: int, edge: str, units: int, time_ns: int) -> None:
    image, count = node.image, f"count_{probe}_{edge}"
    setattr(image, f"latch_{probe}_{edge}", units)
    setattr(image, count, getattr(image, count) + 1)
    latches = node.servo.touch_probe.probes[probe - 1].latches
    latches[edge == "positive"].instant_ns = time_ns


@pytest.mark.interpreted
def test_a_drive_on_ethercat_has_a_line_for_state_control_word_and_mode() -> None:
    settings, plant = machine()
    nodes: Any = {"X": slave(1000), "Y": slave(2**20 / 10)}
    lines: list[str] = []
    with ExitStack() as opened:
        watch = EthercatWatcher(settings, nodes, plant, lines.append, None, opened)
        watch.look(MS)
        assert lines == []
        nodes["Y"].states.state, nodes["Y"].states.code = AlState.SAFEOP, 0x1B
        nodes["Y"].state, nodes["Y"].image.controlword = State.SWITCH_ON_DISABLED, 0x0D
        nodes["X"].image.mode = 8
        watch.look(2 * MS)
        watch.look(3 * MS)
    assert [line.split(maxsplit=2)[2].partition(", no outputs")[0] for line in lines] == [
        "X    mode    0 -> 8 (6060)",
        "Y    AL      OP -> SAFEOP, 0x001B",
        "Y    state   OPERATION_ENABLED -> SWITCH_ON_DISABLED (6040 = 0x000D)",
    ]


@pytest.mark.interpreted
def test_a_latch_is_in_mm_of_its_drive_with_the_contact_before_it(
    tmp_path: Path,
) -> None:
    """Each drive by its own scaling; a contact after the latch, or of another probe, is not its."""
    settings, plant = machine(touch=(4 * MS, 9 * MS), other=(5 * MS,))
    nodes: Any = {"X": slave(1000), "Y": slave(2**20 / 10)}
    lines: list[str] = []
    with ExitStack() as opened:
        watch = EthercatWatcher(settings, nodes, plant, lines.append, tmp_path, opened)
        latch(nodes["X"], 1, "positive", 4001, 4 * MS + 1000)
        latch(nodes["X"], 2, "positive", 77, 4 * MS + 1000)  # nothing is wired there
        latch(nodes["Y"], 1, "negative", -(2**20), 3 * MS)  # before the first contact
        latch(nodes["Y"], 2, "negative", 11 * 2**20, 6 * MS)
        watch.look(7 * MS)
        watch.look(8 * MS)
        latch(nodes["X"], 1, "positive", 9002, 9 * MS)
        watch.look(10 * MS)
        # A drive that is switched off begins to count anew: that is no latch
        nodes["X"].image.count_1_positive = nodes["Y"].image.count_2_negative = 0
        watch.look(11 * MS)
    assert [line.split("latch")[1].strip() for line in lines] == [
        "probe 1, 0x60BA = 4001 = 4.001000 mm; contact was at 4.000000 mm",
        "probe 2, 0x60BC = 77 = 0.077000 mm",
        "probe 1, 0x60BB = -1048576 = -10.000000 mm",
        "probe 2, 0x60BD = 11534336 = 110.000000 mm; contact was at 105.000000 mm",
        "probe 1, 0x60BA = 9002 = 9.002000 mm; contact was at 9.000000 mm",
    ]
    with (tmp_path / "latches.csv").open() as file:
        rows = [tuple(row.values()) for row in csv.DictReader(file)]
    assert rows[3] == ("6000000", "Y", "2", "0x60BD", "11534336", "110.0", "5000000", "105.0")
    assert rows[1][-2:] == rows[2][-2:] == ("", "")


@pytest.mark.interpreted
def test_a_contact_of_a_probe_that_another_axis_carries_has_no_place_of_this_one(
    tmp_path: Path,
) -> None:
    """Both drives watch the same probe, which reads the place of Y alone."""
    settings, plant = machine(touch=(4 * MS,))
    plant.probes["touch"].contacts = [Contact(4 * MS, {"y": 104.0})]
    nodes: Any = {"X": slave(1000), "Y": slave(1000)}
    lines: list[str] = []
    with ExitStack() as opened:
        watch = EthercatWatcher(settings, nodes, plant, lines.append, tmp_path, opened)
        for node in nodes.values():
            latch(node, 1, "positive", 4001, 5 * MS)
        watch.look(6 * MS)
    assert [line.split("latch")[1].strip() for line in lines] == [
        "probe 1, 0x60BA = 4001 = 4.001000 mm",
        "probe 1, 0x60BA = 4001 = 4.001000 mm; contact was at 104.000000 mm",
    ]
    with (tmp_path / "latches.csv").open() as file:
        rows = [tuple(row.values())[-2:] for row in csv.DictReader(file)]
    assert rows == [("", ""), ("4000000", "104.0")]


@pytest.mark.interpreted
def test_both_edges_between_two_looks_have_the_instants_of_their_own() -> None:
    """A touch of 0.4 ms that bounces: the rising edge at the first contact, the falling one later.

    Which of the two comes last does not matter.
    """
    settings, plant = machine(touch=(4 * MS, 5 * MS), other=())
    for up_ms, down_ms in ((4.1, 5.2), (5.2, 4.1)):
        nodes: Any = {"X": slave(1000)}
        lines: list[str] = []
        with ExitStack() as opened:
            watch = EthercatWatcher(settings, nodes, plant, lines.append, None, opened)
            for edge, ms in sorted(
                (("positive", up_ms), ("negative", down_ms)), key=lambda e: e[1]
            ):
                latch(nodes["X"], 1, edge, round(1000 * ms), round(ms * MS))
            watch.look(6 * MS)
        assert [line.split()[0] for line in lines] == [
            f"{ms / 1000:.6f}" for ms in (up_ms, down_ms)
        ]
        for line, ms in zip(lines, (up_ms, down_ms), strict=True):
            assert f"= {ms:.6f} mm; contact was at {int(ms)}.000000 mm" in line


@pytest.mark.interpreted
def test_a_terminal_has_a_line_for_each_stamp_with_the_contact_before_it() -> None:
    _, plant = machine(touch=(4 * MS, 9 * MS), other=(5 * MS,))
    terminal: Any = SimpleNamespace(
        states=SimpleNamespace(state=AlState.SAFEOP, code=0), latches=SimpleNamespace(stamped=[])
    )
    rows: list[tuple[Any, ...]] = []
    watch = TerminalWatcher(
        terminal, {1: "touch", 2: "other", 3: "none"}, plant, lambda *words: rows.append(words)
    )
    (stamp,) = terminal.latches.stamped
    for number, level, ms in (
        (0, True, 4),
        (0, False, 8),
        (1, True, 4),
        (1, False, 6),
        (2, True, 9),
    ):
        stamp(number, level, ms * MS, 1_000_000_000 + ms)
    terminal.states.state = AlState.OP
    watch.look(20 * MS)
    watch.look(21 * MS)  # each once
    name = "terminal"
    assert rows == [
        (20 * MS, name, "AL", "SAFEOP -> OP"),
        (4 * MS, name, "stamp", f"input 1 up, stamp 1000000004 ns{touched(4)}"),
        (8 * MS, name, "stamp", f"input 1 down, stamp 1000000008 ns{touched(4)}"),
        (4 * MS, name, "stamp", "input 2 up, stamp 1000000004 ns"),
        (6 * MS, name, "stamp", f"input 2 down, stamp 1000000006 ns{touched(5)}"),
        (9 * MS, name, "stamp", "input 3 up, stamp 1000000009 ns"),
    ]


@pytest.mark.interpreted
@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize(
    ("edge_ms", "contact_ms"), [(3, None), (4, 4), (8, 4), (9, 9), (12, 9), (15, 15), (99, 15)]
)
def test_the_contact_of_a_stamp_is_the_last_one_until_its_edge(
    edge_ms: int, contact_ms: int | None, order: int
) -> None:
    """Of three touches of its own probe, in whatever order they are kept; at the instant counts."""
    _, plant = machine(touch=(4 * MS, 9 * MS, 15 * MS)[::order], other=(1 * MS, 5 * MS, 14 * MS))
    terminal: Any = SimpleNamespace(
        states=SimpleNamespace(state=AlState.OP, code=0), latches=SimpleNamespace(stamped=[])
    )
    texts: list[str] = []
    watch = TerminalWatcher(
        terminal, {1: "touch", 2: "other"}, plant, lambda *words: texts.append(words[3])
    )
    (stamp,) = terminal.latches.stamped
    for level in (True, False):
        stamp(0, level, edge_ms * MS, 7)
    watch.look(100 * MS)
    place = "" if contact_ms is None else touched(contact_ms)
    assert texts == [f"input 1 {way}, stamp 7 ns{place}" for way in ("up", "down")]


@pytest.mark.interpreted
def test_a_terminal_goes_from_state_to_state_and_a_stamp_has_the_last_contact_before_it() -> None:
    """Each change is from what was shown before; a second contact is the one of later edges."""
    _, plant = machine(touch=(4 * MS, 9 * MS), other=())
    states = SimpleNamespace(state=AlState.INIT, code=0)
    terminal: Any = SimpleNamespace(states=states, latches=SimpleNamespace(stamped=[]))
    rows: list[tuple[Any, ...]] = []
    watch = TerminalWatcher(terminal, {2: "touch"}, plant, lambda *words: rows.append(words))
    way = (AlState.PREOP, AlState.SAFEOP, AlState.PREOP, AlState.PREOP, AlState.INIT)
    for ms, state in enumerate(way, 1):
        states.state = state
        watch.look(ms * MS)
    assert [(at_ns, text) for at_ns, _, _, text in rows] == [
        (1 * MS, "INIT -> PREOP"), (2 * MS, "PREOP -> SAFEOP"), (3 * MS, "SAFEOP -> PREOP"),
        (5 * MS, "PREOP -> INIT"),
    ]  # fmt: skip
    rows.clear()
    (stamp,) = terminal.latches.stamped
    for number, ms in ((1, 3), (1, 8), (1, 9), (1, 12), (0, 12)):
        stamp(number, True, ms * MS, -ms)
    watch.look(20 * MS)
    assert [(at_ns, text) for at_ns, _, _, text in rows] == [
        (3 * MS, "input 2 up, stamp -3 ns"), (8 * MS, f"input 2 up, stamp -8 ns{touched(4)}"),
        (9 * MS, f"input 2 up, stamp -9 ns{touched(9)}"),
        (12 * MS, f"input 2 up, stamp -12 ns{touched(9)}"),
        (12 * MS, "input 1 up, stamp -12 ns"),  # no probe is at it
    ]  # fmt: skip


def touched(ms: int) -> str:
    return f"; contact was x at {ms:.6f} mm, y at {100 + ms:.6f} mm"
