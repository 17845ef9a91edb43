"""What `axisrig drive` does in each slice and at its end, on CAN and on a line, with stand-ins."""

from contextlib import closing
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.frame import Frame, data_frame
from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.tools.virtual_drive import ethercat
from axisrig.bench.tools.virtual_drive import serve as serving
from axisrig.bench.tools.virtual_drive.ethercat import LineServer, Wanted
from axisrig.bench.tools.virtual_drive.serve import DriveServer
from axisrig.kernel.time.clock import MS, Phase

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

LATE = "this computer was more than 100 ms late 2 times, 250 ms in all; the drives ran slower"


class Clock:
    """Real time from 5 s on, which goes on with the slices of a scheduler: 2 ms each."""

    def __init__(self, slips: int = 0, stops_after: int = 10**6) -> None:
        self.now_ns, self.slices, self._stops = 0, list[int](), stops_after
        self.deadlines = SimpleNamespace(slips=slips, slipped_ns=125 * MS * slips)
        self.real_time = SimpleNamespace(monotonic_ns=lambda: 5000 * MS + self.now_ns)

    def run_until(self, time_ns: int) -> None:
        self.now_ns = time_ns
        self.slices.append(time_ns // MS)

    def stop(self) -> bool:
        return len(self.slices) >= self._stops


class Stored:
    """A memory in which something is stored in the second and in the third slice."""

    def __init__(self) -> None:
        self.looks = 0

    def look(self) -> bool:
        self.looks += 1
        return self.looks in (2, 3)


class Watched:
    def __init__(self) -> None:
        self.looks: list[int] = []
        self.lines: list[tuple[float, str, str, str]] = []

    def look(self, time_ns: int) -> None:
        self.looks.append(time_ns // MS)

    def report(self, time_ns: int, *words: str) -> None:
        self.lines.append((time_ns // MS, *words))  # type: ignore[arg-type]


STORED = [(at_ms, "", "store", "parameters written") for at_ms in (4, 6)]


class Interface(OutsideSegment):
    """An interface that is not opened, on a channel of its own."""

    def __init__(self, channel: str) -> None:
        self._own, self.lost = channel, None

    @property
    def info(self) -> str:
        return self._own


@pytest.fixture(autouse=True)
def collector(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What is done with the collector, which takes a second where much is loaded."""
    calls: list[str] = []
    names = ("collect", "freeze", "disable", "enable", "unfreeze")
    own = SimpleNamespace(**{name: partial(calls.append, name) for name in names})
    monkeypatch.setattr(ethercat, "gc", own)
    return calls


def drives(clock: Clock, lines: list[str], **parts: Any) -> tuple[Any, list[int]]:
    server: Any = DriveServer.__new__(DriveServer)
    mended: list[int] = []
    server.segments = {"can1": Interface("vcan0"), "can2": Interface("vcan1")}
    server.nodes = {"X": SimpleNamespace(node_id=2), "Z": SimpleNamespace(node_id=3)}
    server.scheduler = server._hardware = clock
    server._put_out, server._watcher, server._parameters = lines.append, Watched(), None
    server._mend = lambda real_ns: mended.append(real_ns // MS)
    for name, value in parts.items():
        setattr(server, name, value)
    return server, mended


def line(clock: Clock, lines: list[str], **parts: Any) -> tuple[Any, list[int]]:
    server: Any = LineServer.__new__(LineServer)
    kept: list[int] = []
    server.drives, server.terminal = {"X": None, "Z": None}, None
    server.scheduler = server._hardware = clock
    server._put_out, server._watcher, server._parameters = lines.append, Watched(), None
    server._wanted, server._looks = Wanted("eth7"), [server._watcher.look]
    server._keep_up = lambda now_ns: kept.append(now_ns // MS)
    server.port = SimpleNamespace(latencies_ns=[], frames=0, latest_ns=0)
    for name, value in parts.items():
        setattr(server, name, value)
    return server, kept


def test_the_head_names_every_segment_and_every_drive_with_its_own_node() -> None:
    lines: list[str] = []
    server, _ = drives(Clock(), lines)
    server.run(0)
    assert lines == [
        "segment can1: vcan0", "segment can2: vcan1", "axis X: drive with node 2",
        "axis Z: drive with node 3",
    ]  # fmt: skip
    assert server.scheduler.slices == []


def test_drives_on_can_look_store_and_mend_in_each_slice_until_the_time_is_over() -> None:
    """7 ms are four slices of 2 ms; interfaces are tried by real time, all else by that of the
    drives.
    """
    for slips in (0, 2):
        lines: list[str] = []
        clock = Clock(slips)
        server, mended = drives(clock, lines, _parameters=Stored())
        server.run(7 * MS)
        assert clock.slices == server._watcher.looks == [2, 4, 6, 8]
        assert mended == [5002, 5004, 5006, 5008]
        assert server._watcher.lines == STORED
        late = [text for text in lines if "late" in text]
        assert len(late) == slips // 2
        assert all(text.startswith(LATE) for text in late)


def test_the_operator_stops_drives_on_can_before_their_time_and_without_one() -> None:
    for for_ns in (None, 100 * MS):
        clock = Clock(stops_after=3)
        server, mended = drives(clock, [])
        server.run(for_ns)
        assert (clock.slices, len(mended)) == ([2, 4, 6], 3)


@pytest.mark.parametrize(("for_s", "stops"), [(0.007, 10**6), (None, 4), (1.0, 4)])
def test_a_line_looks_stores_and_keeps_up_in_each_slice(for_s: float | None, stops: int) -> None:
    lines: list[str] = []
    clock, terminal = Clock(2, stops), Watched()
    server, kept = line(clock, lines, _parameters=Stored(), _wanted=Wanted("eth7", for_s=for_s))
    server._looks.append(terminal.look)
    server.run()
    assert clock.slices == kept == server._watcher.looks == terminal.looks == [2, 4, 6, 8]
    assert server._watcher.lines == STORED
    assert lines[-1].startswith(LATE)


def test_the_terminal_is_the_slave_behind_all_drives() -> None:
    for terminal, more in ((None, []), (object(), ["terminal: slave 2 on eth7"])):
        lines: list[str] = []
        server, _ = line(Clock(), lines, terminal=terminal, _wanted=Wanted("eth7", for_s=0.0))
        server.run()
        assert lines[:-1] == ["axis X: slave 0 on eth7", "axis Z: slave 1 on eth7", *more]
        assert "nothing may be connected behind them" in lines[-1]


def test_a_summary_comes_also_where_a_slice_breaks(collector: list[str]) -> None:
    """And what is no longer used is collected again."""
    lines: list[str] = []
    server, _ = line(Clock(2), lines)

    def breaks(_: int) -> None:
        raise RuntimeError("odd")

    server._keep_up = breaks
    with pytest.raises(RuntimeError, match="odd"):
        server.run()
    assert lines[-1].startswith(LATE)
    assert collector == ["collect", "freeze", "disable", "enable", "unfreeze"]


# --- a trace, and what the command line gives


def test_a_row_of_the_trace_is_of_each_sync_after_the_nodes_have_acted() -> None:
    """A SYNC has the identifier 80h of 11 bits (CiA 301)."""
    called: list[Any] = []
    kept: list[int] = []
    clock = SimpleNamespace(now_ns=3 * MS, call_at=lambda *words: called.append(words))
    server, _ = drives(Clock(), [], scheduler=clock, _trace=SimpleNamespace(add=kept.append))
    others = data_frame(0x81, bytes(8)), Frame(0x80, b"", True, False, 0), data_frame(0x180, b"0")
    for frame in (data_frame(0x80, b""), *others):
        server._on_frame(1 * MS, "can1", frame, False)
    ((at_ns, phase, act),) = called
    assert (at_ns, phase, kept) == (3 * MS, Phase.ARBITRATION, [])
    clock.now_ns = 9 * MS
    act()
    assert kept == [3 * MS]


def test_a_server_with_a_folder_writes_its_trace_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[Any] = []

    class Writer:
        def __init__(self, path: Path) -> None:
            made.append(path)

        def add(self, columns: Any) -> None:
            made.append(columns)

        def close(self) -> None:
            made.append("closed")

    monkeypatch.setattr("axisrig.bench.tools.virtual_drive.serve.SeriesWriter", Writer)
    opened = SimpleNamespace(close=lambda: made.append("all closed"))
    trace = SimpleNamespace(columns=lambda: "columns")
    server, _ = drives(Clock(), [], _folder=tmp_path, _open=opened, _trace=trace)
    server.close()
    assert made == [tmp_path / "trace.parquet", "columns", "closed", "all closed"]
    server.close()
    assert made[4:] == ["all closed"]


class Server:
    """Stands for a server of either kind: what it was made with, and how it has run."""

    made: "list[Server]"

    def __init__(self, *given: Any, **words: Any) -> None:
        self.given, self.words, self.calls = given, words, list[Any]()
        self.made.append(self)

    def __enter__(self) -> "Server":
        self.calls.append("opened")
        return self

    def __exit__(self, *_: object) -> None:
        self.calls.append("closed")

    def run(self, *for_ns: int | None) -> None:
        self.calls.append(("ran", *for_ns))


@pytest.mark.parametrize(("for_s", "for_ns"), [(None, None), (1.5, 1500 * MS), (0.0004, 400_000)])
@pytest.mark.parametrize("by_sync", [True, False])
def test_what_the_command_line_says_reaches_the_drives(
    for_s: float | None, for_ns: int | None, by_sync: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The interface is open as long as they run."""
    own = type("Own", (Server,), {"made": []})
    ends: list[str] = []
    outside: Any = SimpleNamespace(open_hardware=lambda: closing(Hardware(ends)))
    monkeypatch.setattr(serving, "DriveServer", own)
    settings: Any = "settings"
    serving.serve(
        settings, outside, ends.append, by_sync=by_sync, folder=Path("f"), for_s=for_s,
        store=Path("s"),
    )  # fmt: skip
    (made,) = own.made
    assert made.given[0] == "settings"
    assert made.given[1].ends is ends
    assert made.words == {"by_sync": by_sync, "folder": Path("f"), "store": Path("s")}
    assert made.calls == ["opened", ("ran", for_ns), "closed"]
    assert ends == ["closed"]
    monkeypatch.setattr(ethercat, "LineServer", own)
    wanted: Any = "wanted"
    hardware: Any = "hardware"
    ethercat.serve_line(settings, wanted, hardware, ends.append)
    assert own.made[1].given == ("settings", "wanted", "hardware", ends.append)
    assert own.made[1].calls == ["opened", ("ran",), "closed"]


class Hardware:
    def __init__(self, ends: list[str]) -> None:
        self.ends = ends

    def close(self) -> None:
        self.ends.append("closed")
