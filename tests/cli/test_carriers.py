"""Each command on each carrier acts, or is refused by name: the rows of `carriers.csv`."""

import shutil
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.results.layout import logs_beside, run_of_log
from axisrig.bench.campaign.results.sums import is_log_sums, sums_of
from axisrig.bench.record.bus import LineFigures
from axisrig.bench.rig.reading.carriers import on_carriers
from axisrig.kernel.errors import UserError
from axisrig.reports.parts.buses import line_facts
from axisrig.results.loading import Results

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "testplans" / "rigs"
PLAN = "case,program,rig,plc:V.E.FEED,{column},check:alarms\nrow,part.nc,{rig},600,{cell},none\n"


@pytest.fixture
def rigs(place: Path) -> Path:
    for name in ("probe-z-ethercat.toml", "probe-xyz-mixed.toml", "probe-z.toml"):
        shutil.copy(RIGS / name, place)
    return place


def words_of(command: str) -> str:
    """What a refusal says, up to the name of a segment."""
    row = next(row for row in on_carriers() if row.command == command and row.acts == "no")
    return row.words.replace("{segment}", "ec1")


def test_the_page_has_the_table() -> None:
    page = (ROOT / "docs" / "ethercat.md").read_text("utf-8")
    for row in on_carriers():
        acts = {"yes": "acts", "no": "refused"}[row.acts]
        words = row.words.replace("{segment}", "S")
        assert f"| `{row.command}` | {acts} | {words} |" in page


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("run --interface", "nc part.nc --rig RIG --interface virtual --channel x"),
        ("run --interface", "drive RIG --interface virtual --channel x --for 0.1"),
        ("drive --eds", "drive RIG --eds x.eds"),
    ],
)
def test_what_is_for_can_is_refused_by_name(
    rigs: Path, rejected: Callable[..., str], command: str, words: str
) -> None:
    said = rejected(*words.replace("RIG", "probe-z-ethercat.toml").split())
    assert words_of(command) in said
    assert not (rigs / "x.eds").exists()


def test_an_interface_is_for_the_bus_of_a_mixed_rig(
    rigs: Path, rejected: Callable[..., str]
) -> None:
    lines = [t for t in (rigs / "probe-xyz-mixed.toml").read_text("utf-8").split("\n")
             if t.startswith("[segment.ec")]  # fmt: skip
    segment = lines[0].removeprefix("[segment.").rstrip("]")
    said = rejected(*f"drive probe-xyz-mixed.toml --interface virtual --channel x --segment"
                     f" {segment}".split())  # fmt: skip
    assert words_of("run --interface").replace("ec1", segment) in said


@pytest.mark.parametrize(
    ("column", "cell", "rig", "says"),
    [
        (
            "fault:drop",
            "Z.TPDO1",
            "probe-z-ethercat.toml",
            "on ec1 there are power_loss, line_lost",
        ),
        ("fault:heartbeat_loss", "Z", "probe-z-ethercat.toml", "there are no such faults"),
        ("fault:line_lost", "can1", "probe-z.toml", "the rig has no line"),
        ("bus:ec1.bitrate", "500000", "probe-z-ethercat.toml", "no such key"),
    ],
)
def test_columns_of_the_other_carrier_are_refused(
    rigs: Path, rejected: Callable[..., str], column: str, cell: str, rig: str, says: str
) -> None:
    (rigs / "plan.csv").write_text(PLAN.format(column=column, cell=cell, rig=rig), "utf-8")
    assert says in rejected("check", "plan.csv")


def test_a_bus_log_by_the_suffix_of_a_line_is_refused(
    rigs: Path, rejected: Callable[..., str]
) -> None:
    words = "nc part.nc --rig probe-z-ethercat.toml --bus-log a.pcapng"
    assert "NAME@SEGMENT.pcapng" in rejected(*words.split())


@pytest.mark.parametrize(
    ("name", "run"),
    [
        ("a-b.blf", "a-b"),
        ("a-b@can1.pcap", "a-b"),
        ("a-b@ec1.pcapng", "a-b"),
        ("a-1.5@ec1.pcapng", "a-1.5"),
        ("a-1.5.pcap", "a-1.5"),
        ("a-b.txt", ""),
    ],
)
def test_a_log_belongs_to_one_run(name: str, run: str) -> None:
    assert run_of_log(name) == run
    assert logs_beside("a-1", [name]) == []


def test_logs_of_segments_are_those_of_the_whole_name_of_the_run() -> None:
    """One that begins with it is another run; that of all segments is beside none."""
    names = ["a@can1.blf", "a@ec 2.pcapng", "ab@can1.blf", "a-1@can1.blf", "b-a@can1.blf", "a.blf",
             "a@can1.txt"]  # fmt: skip
    assert logs_beside("a", names) == ["a@can1.blf", "a@ec 2.pcapng"]


def test_files_of_lines_are_those_of_their_run(tmp_path: Path) -> None:
    names = ["bus/p-a@ec1.pcapng", "bus/p-a@ec2.pcapng", "bus/p-a.blf"]
    for name in names:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(name)
    cell = sums_of(tmp_path, "p-a", names)["bus_log_sha256"]
    assert is_log_sums(cell)
    assert [word.partition(":")[0] for word in cell.split()] == [
        "@ec1.pcapng", "@ec2.pcapng", ".blf",
    ]  # fmt: skip
    assert sorted(logs_beside("p-a", [n.removeprefix("bus/") for n in names])) == [
        "p-a@ec1.pcapng", "p-a@ec2.pcapng",
    ]  # fmt: skip


def shown(**changes: Any) -> dict[str, tuple[str, bool]]:
    figures: dict[str, Any] = {
        "period_us": 1000.0, "wire_us": 10.0, "sent": 2000, "back": 2000, "counter": 6,
        "wrong": 0, "wrong_in_a_row": 0, "slaves": (("X", "OP"), ("Z", "OP")),
    }  # fmt: skip
    return {
        name: (text, is_bad) for name, text, is_bad in line_facts(LineFigures(**figures | changes))
    }


def test_the_report_marks_what_went_wrong_on_a_line() -> None:
    assert not any(is_bad for _, is_bad in shown().values())
    bad = shown(back=1998, wrong=3, wrong_in_a_row=2,
                slaves=(("X", "OP"), ("Z", "SAFEOP, 0x001B, x")))  # fmt: skip
    assert bad["cyclic frames"] == ("2000, not back 2", True)
    assert bad["working counter"] == ("6, another one in 3 frames, 2 in a row", True)
    assert bad["Z: AL state"] == ("SAFEOP, 0x001B, x", True)
    assert not bad["X: AL state"][1]


def test_a_new_project_goes_to_ethercat_as_its_rig_says(
    axisrig: Callable[..., tuple[int, str, str]], place: Path
) -> None:
    """What the comment of the rig asks for is all that there is to do."""
    assert axisrig("new", "mine")[0] == 0
    rig = place / "mine" / "testplans" / "rigs" / "bench.toml"
    text = rig.read_text("utf-8")
    assert 'carrier = "ethercat"' in text
    changed = text.replace("bitrate = 1_000_000", 'carrier = "ethercat"').replace("node = 3\n", "")
    rig.write_text(changed, "utf-8")
    code, out, err = axisrig("check", rig)
    assert (code, err) == (0, "")
    assert "segment can1, EtherCAT, one cycle" in out
    assert axisrig("new", "other", "--carrier", "ethercat")[0] == 0
    made = axisrig("check", place / "other" / "testplans" / "rigs" / "bench.toml")
    named = out.replace("can1", "ec1").replace(str(place / "mine"), str(place / "other"))
    assert made == (0, named, "")


def test_a_new_project_for_a_carrier_that_has_none_is_refused(
    rejected: Callable[..., str], place: Path
) -> None:
    said = rejected("new", "mine", "--carrier", "profibus")
    assert "found 'profibus'; allowed: can, ethercat" in said
    assert not (place / "mine").exists()


@pytest.mark.long
def test_the_campaign_of_a_project_on_ethercat_passes(
    axisrig: Callable[..., tuple[int, str, str]], place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its limits are those of the project on CAN: the latch is the same."""
    axisrig("new", "mine", "--carrier", "ethercat")
    monkeypatch.chdir(place / "mine")
    code, out, _ = axisrig("run", "testplans/touch.csv", "-j", "1")
    assert code == 0, out


def test_the_table_of_frames_is_of_can(tmp_path: Path) -> None:
    """Files of lines beside it are left out, and where there are only these it says so."""
    stored = SimpleNamespace(recording=SimpleNamespace(facts=None), recorded="p-a")
    results: Any = SimpleNamespace(_run=lambda _: stored, folder=tmp_path)
    bus = tmp_path / "bus"
    bus.mkdir()
    (bus / "p-a@ec1.pcapng").touch()
    with pytest.raises(UserError, match="frames of EtherCAT alone"):
        Results.frames(results, "p-a")
    (bus / "p-a.log").write_text("(0.001000) can1 080#\n", "ascii")
    assert list(Results.frames(results, "p-a")["id"]) == [0x80]
