"""A list that names a drive of another type (P-AXIS-00020): refused, or run and shown."""

import csv
import json
from collections.abc import Callable
from pathlib import Path

import pytest
from cli_plan import write_plan
from tests.reports.pages import whole

Call = Callable[..., tuple[int, str, str]]
NC = ("nc", "part.nc", "--rig", "rig.toml", "--set", "plc:V.E.FEED=3000")


@pytest.fixture(autouse=True)
def sercos(place: Path) -> int:
    """Let the list of Z name a SERCOS drive; return its line there."""
    path = place / "lists" / "axis-z.lst"
    lines = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join([*lines, "kenngr.antr_typ 2", ""]), encoding="utf-8")
    return len(lines) + 1


@pytest.mark.long
def test_each_command_refuses_it_and_takes_it_when_told(
    place: Path, axisrig: Call, sercos: int
) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,1,")
    for words in (("run", plan, "-o", "out"), ("check", plan), ("check", "rig.toml"), NC):
        code, out, err = axisrig(*words)
        assert (code, out) == (2, "")
        assert f"axis-z.lst:{sercos}" in err
        assert "SERCOS (2)" in err
        assert "--as-canopen" in err
    assert not (place / "out").exists()
    assert axisrig("check", plan, "--as-canopen")[0] == 0
    assert axisrig("check", "rig.toml", "--as-canopen")[0] == 0
    assert axisrig(*NC, "--as-canopen")[0] == 0


@pytest.mark.long
def test_results_show_the_substitution_and_replay_repeats_it(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,1,")
    assert axisrig("run", plan, "-o", "out", "--as-canopen")[0] == 0
    with (place / "out" / "cases.csv").open(newline="", encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    assert row["drive_substituted"] == "Z: SERCOS (2)"
    manifest = json.loads((place / "out" / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["drive_substituted"] == {"plan-a": "Z: SERCOS (2)"}
    report = whole(place / "out" / "report.html")
    assert report.count("CiA 402 drive in place of") == 2, "heading, and the run"
    assert "Z: SERCOS (2) (1 run)" in report
    code, out, _ = axisrig("replay", "out", "plan-a")
    assert (code, out.splitlines()[-1]) == (0, "frame_log_sha256 equal")


def test_on_an_ethercat_line_it_is_the_drive_of_the_line(place: Path, axisrig: Call) -> None:
    rig = place / "ethercat.toml"
    text = (place / "rig.toml").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith(("bitrate", "node"))]
    at = next(n for n, line in enumerate(lines) if line.startswith("[segment."))
    lines.insert(at + 1, 'carrier = "ethercat"')
    rig.write_text("\n".join(lines) + "\n", encoding="utf-8")
    code, out, _ = axisrig("check", rig)
    assert (code, "SERCOS, profile one_probe" in out) == (0, True)
    code, out, _ = axisrig("check", rig, "--as-canopen")
    assert code == 0
    assert "profile generic" in out
    assert "EtherCAT, one cycle" in out
