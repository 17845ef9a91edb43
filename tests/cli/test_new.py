"""`axisrig new`: a project whose plans can be run as they are."""

import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.plan.plan import read_plan
from axisrig.bench.tools.project.new import _copied

Call = Callable[..., tuple[int, str, str]]


def test_the_project_has_all_that_its_plan_names(place: Path, axisrig: Call) -> None:
    code, out, err = axisrig("new", "bench")
    assert code == 0
    assert "axisrig run testplans/touch.csv" in err
    made = {Path(line).relative_to("bench").as_posix() for line in out.splitlines()}
    assert made == {
        path.relative_to(place / "bench").as_posix()
        for path in (place / "bench").rglob("*")
        if path.is_file()
    }
    assert {".gitignore", ".github/workflows/bench.yml", "pytest.ini"} <= made
    cases = read_plan(place / "bench" / "testplans" / "touch.csv").cases
    assert {case.rig.name for case in cases} == {"bench.toml"}
    code, _, err = axisrig("new", "bench")
    assert code == 2
    assert "the folder is not empty" in err


@pytest.mark.parametrize(
    ("words", "carrier"),
    [((), "can"), (("--carrier", "can"), "can"), (("--carrier", "ethercat"), "ethercat")],
)
def test_a_drive_is_on_can_where_nothing_else_is_asked_for(
    place: Path, axisrig: Call, words: tuple[str, ...], carrier: str
) -> None:
    assert axisrig("new", "bench", *words)[0] == 0
    with (place / "bench" / "testplans" / "rigs" / "bench.toml").open("rb") as file:
        segments = tomllib.load(file)["segment"].values()
    assert {one.get("carrier", "can") for one in segments} == {carrier}


def test_what_python_has_compiled_is_no_part_of_a_project(tmp_path: Path) -> None:
    """Names that begin with `dot-` begin with a dot there, of folders and of files."""
    source, folder = tmp_path / "template", tmp_path / "made"
    for name in ("dot-git/a.yml", "tests/test_a.py", "tests/test_a.pyc", "b.pyc", "dot-ignore",
                 "x-dot-y"):  # fmt: skip
        path = source / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(name.encode())
    made = _copied(source, folder)
    assert [path.relative_to(folder).as_posix() for path in made] == [
        ".git/a.yml", ".ignore", "tests/test_a.py", "x-dot-y",
    ]  # fmt: skip
    assert {path for path in folder.rglob("*") if path.is_file()} == {*made}
    assert (folder / ".ignore").read_bytes() == b"dot-ignore"


@pytest.mark.long
@pytest.mark.parametrize("model", ["AxisRig.Drives.ServoAxis", "mo/MyAxis.mo"])
def test_its_first_campaign_passes(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch, model: str
) -> None:
    """With the model of the library, which is built already, and with the one of its own."""
    axisrig("new", "bench")
    monkeypatch.chdir(place / "bench")
    rig = Path("testplans/rigs/bench.toml")
    text = rig.read_text(encoding="utf-8")
    rig.write_text(text.replace("AxisRig.Drives.ServoAxis", model), encoding="utf-8")
    code, out, _ = axisrig("run", "testplans/touch.csv")
    assert code == 0, out
    assert (place / "bench" / "out" / "touch" / "report.html").is_file()
