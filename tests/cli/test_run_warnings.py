"""What `axisrig check` warns of, `run` and pytest say too; what nothing uses is an error."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.campaign.used_variables import _in_plc_program
from axisrig.bench.cli.main import main

ROOT = Path(__file__).parents[2]
Call = Callable[..., tuple[int, str, str]]
HEAD = "case,program,rig,plc:V.E.FEED"
ROW = "a,programs/probe-z.nc,rigs/probe-z.toml,600"


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("programs/probe-z.nc", "rigs/probe-z.toml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / "testplans" / name, tmp_path / name)
    shutil.copytree(ROOT / "testplans/rigs/lists", tmp_path / "rigs/lists")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def axisrig(capsys: pytest.CaptureFixture[str]) -> Call:
    def call(*words: str) -> tuple[int, str, str]:
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main(list(words))
        found = capsys.readouterr()
        return int(ended.value.code or 0), found.out, found.err

    return call


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_variable_that_nothing_uses_is_an_error_with_its_cell(
    place: Path, axisrig: Call, command: str
) -> None:
    """It was five green rows and no word anywhere."""
    (place / "p.csv").write_text(f"{HEAD},plc:V.E.FEDE\n{ROW},3\n", "utf-8")
    code, _, err = axisrig(command, "p.csv")
    assert code == 2
    assert "p.csv:2:5: plc:V.E.FEDE is not used: probe-z.nc" in err
    assert "did you mean V.E.FEED" in err


def test_an_empty_cell_of_such_a_column_is_none(place: Path, axisrig: Call) -> None:
    (place / "p.csv").write_text(f"{HEAD},plc:V.E.FEDE\n{ROW},\n", "utf-8")
    assert axisrig("check", "p.csv")[0] == 0


@pytest.mark.long
def test_a_default_is_that_of_rows_which_are_not_chosen_too(place: Path, axisrig: Call) -> None:
    """Row b uses V.E.TIME; a run of row a alone says nothing of it, one of both neither."""
    text = (place / "programs/probe-z.nc").read_text(encoding="utf-8")
    (place / "programs/slow.nc").write_text(text.replace("M30", "P1 = V.E.TIME\nM30"), "utf-8")
    (place / "p.csv").write_text(
        f"{HEAD},plc:V.E.TIME\n*,,rigs/probe-z.toml,600,0.1\na,programs/probe-z.nc,,,\n"
        "b,programs/slow.nc,,,\nc,programs/probe-z.nc,,,\n",
        encoding="utf-8",
    )
    for words in (("-k", "a"), ("-k", "b"), ()):
        code, _, err = axisrig("run", "p.csv", "-o", f"out{len(words)}", "--fresh", *words)
        assert (code, "is not used" in err) == (0, False), err
    rows = (place / "p.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (place / "p.csv").write_text("".join(row for row in rows if row[0] != "b"), "utf-8")
    code, _, err = axisrig("run", "p.csv", "-o", "out", "-k", "a")
    assert (code, "is not used" in err) == (0, False)  # of c nobody knows
    assert "p.csv:2:5: plc:V.E.TIME is not used" in axisrig("run", "p.csv", "-o", "out3")[2]


NC = "nc programs/probe-z.nc --rig rigs/probe-z.toml --set plc:V.E.FEED=600"


@pytest.mark.parametrize("command", ["run p.csv", NC])
def test_set_of_a_variable_that_nothing_uses_is_an_error(
    place: Path, axisrig: Call, command: str
) -> None:
    (place / "p.csv").write_text(f"{HEAD}\n{ROW}\n", "utf-8")
    code, _, err = axisrig(*command.split(), "--set", "plc:V.E.FEDE=3")
    assert code == 2
    assert "--set plc:V.E.FEDE is not used" in err


METRES = f"{HEAD},plant:probe.surface,check:alarms\n{ROW},0.1,none\n"


@pytest.mark.long
def test_a_warning_of_check_is_said_by_run_and_stays_in_manifest_and_report(
    place: Path, axisrig: Call
) -> None:
    (place / "p.csv").write_text(METRES, "utf-8")
    code, _, err = axisrig("run", "p.csv", "-o", "out")
    assert code == 0
    said = "p.csv:2:5: plant:probe.surface names no unit, so 0.1 counts in m"
    assert f"warning: {place / said}" in err.replace(
        "warning: p.csv", f"warning: {place / 'p.csv'}"
    )
    manifest = json.loads((place / "out/manifest.json").read_text("utf-8"))
    assert len(manifest["warnings"]) == 1
    assert said in manifest["warnings"][0]
    assert "plant:probe.surface names no unit" in (place / "out/report.html").read_text("utf-8")


@pytest.mark.parametrize("command", ["check", "run"])
def test_strict_makes_an_error_of_it(place: Path, axisrig: Call, command: str) -> None:
    (place / "p.csv").write_text(METRES, "utf-8")
    code, _, err = axisrig(command, "p.csv", "--strict")
    assert code == 2
    assert "plant:probe.surface names no unit" in err
    assert not (place / "out").exists() or not list((place / "out").rglob("cases.csv"))


@pytest.mark.long
def test_pytest_warns_of_it_too(place: Path) -> None:
    (place / "p.csv").write_text(METRES, "utf-8")
    shutil.copy(ROOT / "testplans/conftest.py", place / "conftest.py")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "p.csv"]
    found = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert found.returncode == 0, found.stdout
    assert "PytestWarning: " in found.stdout
    assert "plant:probe.surface names no unit" in found.stdout


@pytest.mark.parametrize(
    ("text", "names", "all_may"),
    [
        ('x = hli.ve["A"]', {"A"}, False),
        ('x = hli.ve.get("B", 0)', {"B"}, False),
        ('if "C" in hli.ve: pass', {"C"}, False),
        ('N = ("D", "E")\nx = hli.ve[N[0]]', {"D", "E"}, True),
        ('hli.ve[f"IN_{n}"] = 1', {"IN_"}, True),
        ("other(hli.ve)", set(), True),
        ("x = 1", set(), False),
    ],
)
def test_names_that_a_plc_program_uses(text: str, names: set[str], all_may: bool) -> None:
    """A name that is computed at run time counts as use, whatever it is."""
    found, all_found = _in_plc_program(text.encode())
    assert names <= set(found)
    assert all_found is all_may
