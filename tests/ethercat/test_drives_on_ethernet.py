"""`axisrig drive` as EtherCAT slaves: what of it needs no interface."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from axisrig.bench.bus.ethercat.raw import RawPort
from axisrig.bench.cli.main import app
from axisrig.kernel.errors import UserError

ROOT = Path(__file__).parents[2]
RIG = str(ROOT / "testplans" / "rigs" / "probe-z.toml")


def test_an_esi_file_is_written_and_its_drive_named(tmp_path: Path) -> None:
    path = tmp_path / "drive.xml"
    got = CliRunner().invoke(app, ["drive", RIG, "--esi", str(path)])
    assert got.exit_code == 0, got.output
    assert "axis Z (servo, profile generic)" in got.output
    assert "<Index>#x607A</Index>" in path.read_text(encoding="utf-8")


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
