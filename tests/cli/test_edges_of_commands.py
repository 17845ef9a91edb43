"""Options that do not go together, help without types, what a watch leaves, how files are named."""

import errno
import json
import os
import signal
from collections.abc import Sequence
from pathlib import Path

import pytest

from axisrig.bench.campaign.talk import Talk
from axisrig.bench.cli.guard import needs_progress
from axisrig.bench.cli.main import main
from axisrig.bench.cli.run_options import talk_of
from axisrig.bench.files import beside, json_text, named, write_whole

RIGS = Path("testplans/rigs").resolve()
LINE = str(RIGS / "probe-z-ethercat.toml")


def call(*words: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(words)
    return int(ended.value.code or 0)


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["--bitrate", "500000"], "--bitrate"),
        (["--option", "a=1"], "--option"),
        (["--segment", "line"], "--segment"),
        (["--eds", "d.eds"], "--eds"),
        (["--by-sync"], "--by-sync"),
    ],
)
def test_a_slave_on_ethernet_takes_nothing_of_can(
    words: Sequence[str], named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call("drive", LINE, "--interface", "ecat", "--channel", "lo", *words) == 2
    assert capsys.readouterr().err.splitlines() == [
        f"error: this is for CAN, not for EtherCAT; found '{named}'; leave it out"
    ]


@pytest.mark.parametrize("words", [[], ["--interface", "slcan"], ["--eds", "d.eds"]])
def test_a_node_on_can_takes_no_word_of_ethernet(
    words: Sequence[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert call("drive", str(RIGS / "probe-z.toml"), "--real", *words) == 2
    assert capsys.readouterr().err.splitlines() == [
        "error: this is for EtherCAT; found '--real'; --interface ecat"
    ]


COMMANDS = (
    "run", "demo", "judge", "nc", "check", "replay", "drive", "bus", "budget", "probe-feed",
    "report", "merge", "diff", "trend", "export", "query", "errors", "docs", "params", "perf",
    "scenarios", "rig from", "rig export", "fmu check", "fmu build", "plan expand",
)  # fmt: skip


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_no_types_of_python(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    """An argument has its name alone, an option says what follows it."""
    assert call(*command.split(), "--help") == 0
    shown = capsys.readouterr().out
    begin = min(at for word in ("Arguments:", "Options:") if (at := shown.find(word)) >= 0)
    assert "<" not in shown[begin:].replace("<=", "")
    assert " range" not in shown.partition("Options:")[2].replace("a range", "")


def test_a_check_of_a_program_knows_the_words_that_its_rig_passes_over(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program, rig = tmp_path / "a.nc", tmp_path / "rig.toml"
    program.write_text("N10 #TIMER START [ID=1]\nN20 G0 X1\nN30 M30\n")
    rig.write_text(f'base = "{RIGS / "probe-xyz.toml"}"\n')
    assert call("nc", str(program), "--check", "--rig", str(rig)) == 0
    assert "1:5: #TIMER is in the manuals and does not act yet" in capsys.readouterr().out
    rig.write_text(f'base = "{RIGS / "probe-xyz.toml"}"\n[language]\npass_over = ["#TIMER"]\n')
    assert call("nc", str(program), "--check", "--rig", str(rig)) == 0
    assert "1:5: #TIMER is passed over" in capsys.readouterr().out


@pytest.mark.skipif(not hasattr(signal, "SIGVTALRM"), reason="timers of Unix")
def test_a_watch_leaves_the_signal_as_it_found_it() -> None:
    class Going:
        place = (0, 0)

    before = signal.getsignal(signal.SIGVTALRM)
    with needs_progress(Going(), Path("a.blf"), cpu_s=5.0):
        assert signal.getsignal(signal.SIGVTALRM) is not before
        assert signal.getitimer(signal.ITIMER_VIRTUAL)[1] == 5.0
    assert signal.getsignal(signal.SIGVTALRM) == before
    assert signal.getitimer(signal.ITIMER_VIRTUAL) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("is_quiet", "is_verbose", "talk"),
    [
        (False, False, Talk.SHORT),
        (False, True, Talk.ALL),
        (True, False, Talk.NONE),
        (True, True, Talk.NONE),
    ],
)
def test_quiet_is_stronger_than_verbose(is_quiet: bool, is_verbose: bool, talk: Talk) -> None:
    assert talk_of(is_quiet, is_verbose) is talk


def test_an_error_keeps_the_file_that_it_names() -> None:
    own = OSError(errno.ENOSPC, "full", "a.csv")
    assert named(own, Path("b.csv")) is own
    without = named(OSError(errno.ENOSPC, "full"), Path("b.csv"))
    assert (without.filename, without.errno) == ("b.csv", errno.ENOSPC)
    assert without.strerror == os.strerror(errno.ENOSPC)
    bare = OSError("no number")
    assert named(bare, Path("b.csv")) is bare


def test_what_a_killed_process_has_left_beside_a_file_goes(tmp_path: Path) -> None:
    path = tmp_path / "whole.json"
    beside(path).write_text("half of an old o")
    write_whole(path, "new")
    assert path.read_text() == "new"
    assert not beside(path).exists()


def test_equal_objects_are_equal_texts() -> None:
    text = json_text({"b": 1, "a": {"d": "\u00b5", "c": 2}})
    assert text == json_text({"a": {"c": 2, "d": "\u00b5"}, "b": 1})
    assert json.loads(text) == {"a": {"c": 2, "d": "\u00b5"}, "b": 1}
    assert text.index('"a"') < text.index('"c"') < text.index("\u00b5") < text.index('"b"')
