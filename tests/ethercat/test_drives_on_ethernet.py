"""`axisrig drive` as EtherCAT slaves: the parts that need no interface."""

import struct
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import ClassVar

import pytest
from tests.ethercat.line import answers, frame, physical
from typer.testing import CliRunner

from axisrig.bench.bus.ethercat.raw import RawPort
from axisrig.bench.bus.paced import Arrival, RealTime
from axisrig.bench.cli.main import app
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.tools.virtual_drive import ethercat
from axisrig.kernel.errors import UserError

ROOT = Path(__file__).parents[2]
RIG = str(ROOT / "testplans" / "rigs" / "probe-z.toml")


def test_an_esi_file_is_written_and_its_drive_named(tmp_path: Path) -> None:
    path = tmp_path / "drive.xml"
    got = CliRunner().invoke(app, ["drive", RIG, "--esi", str(path)])
    assert got.exit_code == 0, got.output
    assert "axis Z (servo, profile generic)" in got.output
    assert "<Index>#x607A</Index>" in path.read_text(encoding="utf-8")


def rig_of(name: str) -> str:
    return str(ROOT / "testplans" / "rigs" / f"{name}.toml")


def test_an_esi_file_of_a_sercos_drive_has_its_channel(tmp_path: Path) -> None:
    path = tmp_path / "drive.xml"
    got = CliRunner().invoke(app, ["drive", rig_of("probe-z-sercos"), "--esi", str(path)])
    assert got.exit_code == 0, got.output
    assert "axis Z (servo, SERCOS, profile one_probe" in got.output
    assert '<SoE ChannelCount="1" />' in path.read_text(encoding="utf-8")


def test_nothing_is_stored_where_no_drive_has_1010(tmp_path: Path) -> None:
    words = ["--interface", "ecat", "--channel", "x", "--store", str(tmp_path / "kept.json")]
    got = CliRunner().invoke(app, ["drive", rig_of("probe-z-sercos"), *words])
    assert got.exit_code == 2
    assert "no drive of the rig stores its parameters (1010)" in got.output


@pytest.mark.parametrize("name", ["probe-z-profidrive", "probe-z-lightbus"])
@pytest.mark.parametrize("words", [["--interface", "ecat", "--channel", "x"], ["--esi", "x.xml"]])
def test_drives_of_families_that_are_not_on_ethercat_are_refused(
    name: str, words: list[str]
) -> None:
    got = CliRunner().invoke(app, ["drive", rig_of(name), *words])
    assert got.exit_code == 2
    assert "of a family that is not on EtherCAT" in got.output
    assert "allowed: canopen, sercos" in got.output


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--interface", "ecat"], "EtherCAT needs an Ethernet interface"),
        (["--interface", "ecat", "--channel", "x", "--by-sync"], "found '--by-sync'"),
        (["--interface", "ecat", "--channel", "x", "--bitrate", "500000"], "found '--bitrate'"),
        (["--interface", "ecat", "--channel", "x", "--segment", "can1"], "found '--segment'"),
        (["--interface", "ecat", "--channel", "no-such-if"], "there is no such interface"),
        (["--real"], "this is for EtherCAT"),
        (["--interface", "ecat", "--channel", "x", "--axis", "Q"], "no such axis"),
    ],
)
def test_what_does_not_go_together_is_said(words: list[str], said: str) -> None:
    got = CliRunner().invoke(app, ["drive", RIG, *words])
    assert got.exit_code == 2
    assert said in got.stderr


def test_the_loopback_interface_has_an_address() -> None:
    with pytest.raises(UserError, match=r"IP address.*--real|no such interface|needs Linux"):
        RawPort("lo", lambda frame: None, lambda: 0)


class FakePort:
    """Stands for the raw socket: gives its frames one after the other, keeps what comes back."""

    is_waiting = False
    latencies_ns: ClassVar[list[int]] = [1000, 2000, 5000]
    latest_ns = 5000
    last: ClassVar["FakePort"]
    sent: ClassVar[list[bytes]] = []

    def __init__(
        self, interface: str, answer: Callable[[bytearray], None], _now: object, *, is_real: bool
    ) -> None:
        self.said, self.answer = (interface, is_real), answer
        self.waiting, self.back = list(self.sent), list[bytes]()
        self.is_open = True
        FakePort.last = self

    @property
    def frames(self) -> int:
        return len(self.back)

    def receive(self, timeout_s: float) -> Arrival | None:
        return (False, partial(self._act, self.waiting.pop(0))) if self.waiting else None

    def _act(self, sent: bytes) -> None:
        frame = bytearray(sent)
        self.answer(frame)
        self.back.append(bytes(frame))

    def close(self) -> None:
        self.is_open = False


class Real:
    """Real time that goes on by 10 us each time that somebody looks."""

    def __init__(self) -> None:
        self.now_ns = 0

    def monotonic_ns(self) -> int:
        self.now_ns += 10_000
        return self.now_ns

    def pause(self, time_s: float) -> None:
        self.now_ns += round(time_s * 1e9)


TERMINAL_RIG = ROOT / "testplans" / "rigs" / "plc-timestamp-line.toml"


@pytest.mark.long
def test_the_stamping_terminal_is_the_last_slave(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two slaves answer; the second one goes to PREOP without a mailbox and shows its registers."""
    to_preop = physical(2, -1, 0x0120, b"\x02\x00")
    asked = [physical(1, -1, 0x0130, 2), physical(1, -1, 0x09AE, 34)]
    asked += [physical(1, -place, 0x0110, 2) for place in (0, 1)]
    FakePort.sent = [frame(physical(7, 0, 0, 1)), frame(to_preop), frame(*asked)]
    monkeypatch.setattr(ethercat, "RawPort", FakePort)
    lines: list[str] = []
    real = Real()
    settings = ethercat.line_settings(TERMINAL_RIG, [], [])
    hardware = Hardware(RealTime(real.monotonic_ns, real.pause))
    wanted = ethercat.Wanted("v7", is_real=True, for_s=0.03)
    ethercat.serve_line(settings, wanted, hardware, lines.append)
    counters = [answer.wkc for sent in FakePort.last.back for answer in answers(sent)]
    assert counters == [2, 1, 1, 1, 1, 1]
    # DL status, bits 4 to 7: a link on port 0, and on port 1 where a slave follows
    links = [answer.number >> 4 & 0xF for answer in answers(FakePort.last.back[-1])[-2:]]
    assert links == [0b0011, 0b0001]
    assert lines[:2] == ["axis Z: slave 0 on v7", "terminal: slave 1 on v7"]
    assert any("terminal AL      INIT -> PREOP" in line for line in lines)


@pytest.mark.long
def test_frames_are_answered_and_what_happens_is_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mailboxes = struct.pack("<HHBBBBHHBBBB", 0x1000, 128, 0x26, 0, 1, 0, 0x1080, 128, 0x22, 0, 1, 0)
    ready = [physical(2, 0, 0x0800, mailboxes), physical(2, 0, 0x0120, b"\x02\x00")]
    FakePort.sent = [frame(physical(7, 0, 0, 1)), frame(*ready), frame(physical(7, 0, 0x0130, 2))]
    monkeypatch.setattr(ethercat, "RawPort", FakePort)
    lines: list[str] = []
    real = Real()
    store = tmp_path / "kept.json"
    wanted = ethercat.Wanted("v7", True, tmp_path / "out", store, 0.03)
    settings = ethercat.line_settings(Path(RIG), [], [])
    hardware = Hardware(RealTime(real.monotonic_ns, real.pause))
    ethercat.serve_line(settings, wanted, hardware, lines.append)
    port = FakePort.last
    assert (port.said, port.is_open) == (("v7", True), False)
    assert [answer.wkc for sent in port.back for answer in answers(sent)] == [1, 1, 1, 1]
    assert answers(port.back[-1])[0].number == 2
    assert lines[0] == "axis Z: slave 0 on v7"
    assert any("AL      INIT -> PREOP" in line for line in lines)
    assert lines[-1] == (
        "3 frames answered; from reception to answer median 2 us, p99 5 us, max 5 us"
    )
    assert (tmp_path / "out" / "events.csv").read_text().count("PREOP") == 1
    content = (tmp_path / "out" / "bus.pcapng").read_bytes()
    assert all(sent in content for sent in port.back)
