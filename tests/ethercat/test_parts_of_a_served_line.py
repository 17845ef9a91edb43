"""Parts of `axisrig drive` on EtherCAT: its slaves, who answers when, and what is summed up."""

import itertools
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.ethercat.segment import Passage
from axisrig.bench.bus.paced import RealTime
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.rig.real_axes import simulated_plants
from axisrig.bench.tools.virtual_drive import ethercat
from axisrig.bench.tools.virtual_drive.ethercat import LineServer, Wanted, line_settings, whose_esi
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


class Slave:
    """Counts in the last byte of a frame, and notes how the frame came."""

    def __init__(self) -> None:
        self.passages: list[Passage] = []
        self.begun_ns: list[int] = []
        self.servo = SimpleNamespace(begin=self.begun_ns.append)

    def process(self, frame: bytearray, passage: Passage) -> None:
        frame[-1] += 1
        self.passages.append(passage)


def server(**parts: Any) -> Any:
    made: Any = LineServer.__new__(LineServer)
    for name, value in parts.items():
        setattr(made, name, value)
    return made


def test_a_frame_passes_every_slave_and_comes_back_from_the_last_one() -> None:
    """The source address has the bit of a local one then (IEEE 802), also in the log."""
    slaves, logged = [Slave(), Slave(), Slave()], list[Any]()
    frames = SimpleNamespace(add=lambda *words: logged.append(words))
    line = server(_line=slaves, _frames=frames, scheduler=SimpleNamespace(now_ns=7 * MS))
    frame = bytearray(60)
    line._answer(frame)
    assert [one.passages for one in slaves] == [
        [Passage(7 * MS, 7 * MS)], [Passage(7 * MS, 7 * MS)], [Passage(7 * MS, None)],
    ]  # fmt: skip
    assert (frame[6], frame[-1]) == (2, 3)
    assert logged == [(7 * MS, 0, bytes(frame))]
    alone = server(_line=slaves[:1], _frames=None, scheduler=SimpleNamespace(now_ns=8 * MS))
    alone._answer(frame)
    assert slaves[0].passages[-1] == Passage(8 * MS, None)
    assert (frame[6], frame[-1]) == (2, 4)


def test_plants_that_no_cycle_steps_go_on_every_20_ms() -> None:
    drives = {"X": Slave(), "Z": Slave()}
    asked: list[int] = []
    terminal = SimpleNamespace(before_latches=lambda: asked.append(1))
    line = server(drives=drives, terminal=terminal, _kept_ns=0)
    for now_ms in (1, 19, 20, 21, 39, 41, 60, 61):
        line._keep_up(now_ms * MS)
    assert [one.begun_ns for one in drives.values()] == [[20 * MS, 41 * MS, 61 * MS]] * 2
    assert len(asked) == 3
    bare = server(drives=drives, terminal=None, _kept_ns=0)
    bare._keep_up(30 * MS)
    assert drives["Z"].begun_ns[-1] == 30 * MS


def test_a_summary_says_how_fast_frames_were_answered_and_what_was_given_up() -> None:
    quiet = SimpleNamespace(slips=0, slipped_ns=0)
    late = SimpleNamespace(slips=2, slipped_ns=250 * MS)
    answered = SimpleNamespace(latencies_ns=[US] * 98 + [9 * US] * 2, frames=100, latest_ns=12 * US)
    nothing = SimpleNamespace(latencies_ns=[], frames=0, latest_ns=0)
    for port, deadlines, count in ((answered, quiet, 1), (answered, late, 2), (nothing, late, 1)):
        lines = server(port=port, scheduler=SimpleNamespace(deadlines=deadlines))._summary()
        assert len(lines) == count
        if port is answered:
            assert lines[0].startswith("100 frames answered; from reception to answer median 1 us,")
            assert lines[0].endswith(" p99 9 us, max 12 us")
        if deadlines is late:
            assert "more than 100 ms late 2 times, 250 ms in all" in lines[-1]
    assert server(port=nothing, scheduler=SimpleNamespace(deadlines=quiet))._summary() == []


def test_an_esi_file_fits_all_axes_with_one_drive_and_none_of_several(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """X, Y and Z have the drive `servo`; where Y has another one, an axis has to be named."""
    rig = RIGS / "probe-xyz-ethercat.toml"
    three, axes = line_settings(rig, [], []), ("X", "Y", "Z")
    assert whose_esi(three) == ", ".join(f"axis {n} (servo, profile generic)" for n in axes)
    path = ethercat.write_esi(three, tmp_path / "a.xml")
    assert "<Index>#x607A</Index>" in path.read_text(encoding="utf-8")
    assert list(line_settings(rig, ["Y"], []).rig.axis) == ["Y"]
    monkeypatch.setattr(ethercat, "_describe", lambda _, name: name == "Y")
    with pytest.raises(UserError, match="of which one the ESI file is to be") as refused:
        ethercat.write_esi(three, tmp_path / "b.xml")
    assert refused.value.hint == "--axis NAME"
    assert not (tmp_path / "b.xml").exists()


@pytest.mark.interpreted
def test_slaves_have_their_places_from_0_and_serial_numbers_from_1(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In the order of the rig; the terminal of the first line that has one is behind them."""
    asked: list[Any] = []
    settings: Any = SimpleNamespace(rig=SimpleNamespace(axis={"Z": None, "X": None, "Y": None}))

    def drive_slave(_settings: Any, name: str, clock: Any, beside: Any, *numbers: int) -> str:
        asked.append((name, clock, beside, *numbers))
        return f"drive {name}"

    def terminal_slave(_settings: Any, name: str, *more: Any) -> str | None:
        asked.append((name, *more))
        return None if name == "ec1" else f"terminal of {name}"

    monkeypatch.setattr(ethercat, "drive_slave", drive_slave)
    monkeypatch.setattr(ethercat, "terminal_slave", terminal_slave)
    line = server(scheduler="clock", plant=SimpleNamespace(advance_to="advance"))
    line.drives = line._build(settings, "beside")
    assert list(line.drives.items()) == [(name, f"drive {name}") for name in "ZXY"]
    assert [words[3:] for words in asked] == [(1, 0), (2, 1), (3, 2)]
    assert {words[1:3] for words in asked} == {("clock", "beside")}
    for lines_of_rig, found, count in (
        (["ec1"], None, 1), (["ec1", "ec2", "ec3"], "terminal of ec2", 2), ([], None, 0)
    ):  # fmt: skip
        asked.clear()
        line._line = list(line.drives.values())
        monkeypatch.setattr(ethercat, "ec_segments", lambda _, names=lines_of_rig: names)
        assert line._build_terminal(settings, "beside") == found
        assert line._line == [*line.drives.values(), *([found] if found else [])]
        assert asked == [(name, "clock", "beside", "advance", 4) for name in lines_of_rig[:count]]


@pytest.mark.interpreted
def test_the_terminal_is_looked_at_with_the_inputs_of_its_own_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tables = {"ec1": None, "ec2": SimpleNamespace(inputs={1: "probe"})}
    monkeypatch.setattr(ethercat, "ec_segments", lambda _: list(tables))
    monkeypatch.setattr(ethercat, "terminal_on", lambda _, name: tables[name])
    made: list[Any] = []

    def watcher(*words: Any) -> Any:
        made.append(words)
        return SimpleNamespace(look="look of the terminal")

    monkeypatch.setattr(ethercat, "TerminalWatcher", watcher)
    settings: Any = None
    parts = {"plant": "plant", "_watcher": SimpleNamespace(report="report")}
    for terminal, count in (("terminal", 1), (None, 0)):
        line = server(terminal=terminal, **parts, _looks=["first"])
        line._watch_terminal(settings)
        assert line._looks == ["first", *["look of the terminal"] * count]
        assert made == [("terminal", {1: "probe"}, "plant", "report")]


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("rig", "wanted", "message"),
    [
        ("probe-z-ethercat", Wanted(None), "EtherCAT needs an Ethernet interface"),
        ("probe-z-sercos", Wanted("eth7", store=Path("s.json")), "no drive of the rig stores"),
    ],
)
def test_a_line_is_refused_before_an_interface_is_opened(
    rig: str, wanted: Wanted, message: str
) -> None:
    settings = line_settings(RIGS / f"{rig}.toml", [], [])
    nothing: Any = SimpleNamespace(real_time=SimpleNamespace(monotonic_ns=None))
    with pytest.raises(UserError, match=message):
        LineServer(settings, wanted, nothing, [].append)


@pytest.mark.interpreted
@pytest.mark.parametrize("axes", [("X", "Y"), ("Y", "X")])
def test_a_file_is_for_those_drives_of_a_line_that_store(
    axes: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """X has CiA 402, Y SERCOS, which has no 1010: the line is opened with it, in either order."""
    tables = {
        name: line_settings(RIGS / f"{rig}.toml", [], []).rig.drive
        for name, rig in (("X", "probe-z-ethercat"), ("Y", "probe-z-sercos"))
    }
    drives = {name: next(iter(of_rig.values())) for name, of_rig in tables.items()}
    rig = SimpleNamespace(
        axis={name: SimpleNamespace(drive=f"of {name}") for name in axes},
        drive={f"of {name}": drives[name] for name in axes},
    )

    def port(channel: str, *_: object, is_real: bool) -> None:
        raise UserError("the interface is opened", value=channel, allowed=[is_real])

    monkeypatch.setattr(ethercat, "RawPort", port)
    nothing: Any = SimpleNamespace(real_time=SimpleNamespace(monotonic_ns=None))
    settings: Any = SimpleNamespace(rig=rig)
    with pytest.raises(UserError, match="the interface is opened") as opened:
        LineServer(settings, Wanted("eth7", store=Path("s.json")), nothing, [].append)
    assert opened.value.value == "eth7"


def test_every_plant_of_a_line_is_simulated_whatever_carries_the_axes_in_the_rig() -> None:
    """With a real CAN interface in the rig its drives are outside; here they are these slaves."""
    given = ["bus:can1.interface=virtual", "bus:can1.channel=line"]
    found = line_settings(RIGS / "probe-z.toml", [], given)
    assert not found.has_kernel
    assert list(simulated_plants(found)) == list(found.rig.plant)
    found.has_kernel = True
    assert list(simulated_plants(found)) != list(found.rig.plant)


@pytest.mark.interpreted
def test_what_a_master_stores_in_a_line_is_in_a_new_file_and_in_the_next_life(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without --store there is no file, and the drive has its defaults again."""
    times = itertools.count(0, 10 * US)  # real time goes on whenever it is asked for
    port = SimpleNamespace(
        is_waiting=False, receive=lambda _: None, close=lambda: None, latencies_ns=[], frames=0,
        latest_ns=0,
    )  # fmt: skip
    monkeypatch.setattr(ethercat, "RawPort", lambda *_, **__: port)
    idle = dict.fromkeys(("collect", "freeze", "disable", "enable", "unfreeze"), lambda: None)
    monkeypatch.setattr(ethercat, "gc", SimpleNamespace(**idle))
    path, settings = tmp_path / "drives.json", line_settings(RIGS / "probe-z-ethercat.toml", [], [])

    def life(store: Path | None, stored: dict[tuple[int, int], int] | None) -> Any:
        lines: list[str] = []
        wanted, real = (
            Wanted("eth7", store=store, for_s=0.004),
            RealTime(lambda: next(times), lambda _: None),
        )
        with LineServer(settings, wanted, Hardware(real), lines.append) as server:
            memory = server.drives["Z"].storage
            found = dict(memory.stored)
            if stored is not None:
                memory.load(stored)
            server.run()
        return found, sum("parameters written" in line for line in lines)

    value = {(0x6065, 0): 2500}
    assert life(None, value) == ({}, 0)
    assert list(tmp_path.iterdir()) == []
    assert life(path, None) == ({}, 0)
    assert list(tmp_path.iterdir()) == []
    assert life(path, value) == ({}, 1)
    assert json.loads(path.read_text()) == {"Z": {"6065:00": 2500}}
    assert life(path, None) == (value, 0)
    assert life(None, None) == ({}, 0)
