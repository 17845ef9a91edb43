"""A row that searches: the last surface that a measurement run still reaches is its target."""

import shutil
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pandas as pd
import pytest
from tests.reports.pages import whole

Call = Callable[..., tuple[int, str, str]]

TARGET_MM = 126.0  # the program runs there at most
HEAD = "case,program,rig,plc:V.E.FEED,search:plant:probe.surface_mm,check:msg:N30"
HEAD += ",check:alarms,check:search_good,check:search_bad"
ROW = "a,part.nc,rig.toml,3000,125.1 .. 129 to {},== 1,,{},< 126"
FOUND = ROW.format("0.5", "126 .. 126.5")


def _write(place: Path, *rows: str, name: str = "plan.csv") -> str:
    (place / name).write_text("\n".join([HEAD, *rows, ""]), encoding="utf-8")
    return name


def _cases(folder: Path) -> pd.DataFrame:
    return pd.read_csv(folder / "cases.csv", dtype=str, keep_default_na=False).set_index("run")


def _bytes(folder: Path) -> dict[str, bytes]:
    found = {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for name in ("bus", "runs", "traces", "plans")
        for path in (folder / name).iterdir()
    }
    found["cases.csv"] = _cases(folder).drop(columns=["wall_s", "timestamp"]).to_csv().encode()
    return {**found, "results.csv": (folder / "results.csv").read_bytes()}


@pytest.fixture(scope="module")
def searched(originals: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a plan and its results."""
    from axisrig.bench.cli.main import main  # noqa: PLC0415

    folder: Path = tmp_path_factory.mktemp("searched")
    shutil.copytree(originals, folder, dirs_exist_ok=True)
    plan = _write(folder, FOUND)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        with pytest.raises(SystemExit) as ended:
            main(["run", plan, "-o", "out"])
    assert ended.value.code == 0
    return folder


@pytest.mark.long
def test_the_target_is_between_the_two_values(searched: Path) -> None:
    cases = _cases(searched / "out")
    row, probes = cases.loc["plan-a"], cases[cases["probe"] == "plan-a"]
    assert list(cases.index) == ["plan-a", *probes.index]
    assert (row["verdict"], row["runs"], row["frame_log_sha256"]) == ("pass", str(len(probes)), "")
    surfaces = probes["plant:probe.surface_mm"].astype(float)
    # Whatever the search did: each probe passed if and only if the run reaches the surface
    assert list(probes["verdict"] == "pass") == list(surfaces >= TARGET_MM)
    assert set(probes["seed"]) == {row["seed"]}
    results = pd.read_csv(searched / "out" / "results.csv").set_index(["run", "metric"])
    values = {
        name: float(results.loc[("plan-a", name), "value"])
        for name in ("search_good", "search_bad")
    }
    assert values["search_good"] == surfaces[surfaces >= TARGET_MM].min()
    assert values["search_bad"] == surfaces[surfaces < TARGET_MM].max()
    assert values["search_good"] - values["search_bad"] <= 0.5
    suite = ElementTree.parse(searched / "out" / "junit.xml").getroot()[0]
    assert (suite.get("tests"), suite.get("failures")) == ("1", "0")
    page = whole(searched / "out" / "report.html")
    assert "Probes of the search" in page
    assert all(f'href="#{run}"' in page for run in probes.index)


@pytest.mark.long
def test_resume_keeps_a_whole_search_and_repeats_a_broken_one(
    searched: Path, place: Path, axisrig: Call
) -> None:
    shutil.copytree(searched, place, dirs_exist_ok=True)
    plan = _write(place, FOUND)
    whole_bytes = _bytes(place / "out")
    assert "kept 1 run, ran 0" in axisrig("run", plan, "-o", "out", "--resume")[2]
    assert _bytes(place / "out") == whole_bytes
    table = place / "out" / "cases.csv"
    lines = table.read_text(encoding="utf-8").splitlines(keepends=True)
    table.write_text("".join(lines[:-1]), encoding="utf-8")  # the last probe is lost
    assert axisrig("run", plan, "-o", "out", "--resume")[0] == 0
    assert _bytes(place / "out") == whole_bytes


@pytest.mark.long
def test_a_wider_search_takes_the_probes_away_that_it_does_not_need(
    searched: Path, place: Path, axisrig: Call
) -> None:
    shutil.copytree(searched, place, dirs_exist_ok=True)
    plan = _write(place, ROW.format("2", "126 .. 128"))
    assert axisrig("run", plan, "-o", "out")[0] == 0
    assert list(_cases(place / "out").index) == ["plan-a", *(f"plan-a-s0{n}" for n in (1, 2, 3))]
    names = {
        path.stem for name in ("runs", "bus", "traces") for path in (place / "out" / name).iterdir()
    }
    assert names == {f"plan-a-s0{n}" for n in (1, 2, 3)}


@pytest.mark.long
def test_probes_are_found_again_by_their_recordings(
    searched: Path, place: Path, axisrig: Call
) -> None:
    """The row gives no seed: that of its probes follows from its name, not from theirs."""
    shutil.copytree(searched, place, dirs_exist_ok=True)
    assert axisrig("judge", "out", "--plan", "plan.csv")[0] == 0
    before, after = _cases(place / "out"), _cases(place / "out" / "judged" / "1-plan")
    assert list(after["verdict"]) == list(before["verdict"])
    assert list(after["recording"])[1:] == list(before.index)[1:]
    assert len(set(before["seed"])) == 1


@pytest.mark.long
def test_probes_are_judged_and_run_again(searched: Path, place: Path, axisrig: Call) -> None:
    shutil.copytree(searched, place, dirs_exist_ok=True)
    other = _write(place, ROW.format("0.5", "> 127"))
    assert axisrig("judge", "out", "--plan", other)[0] == 1
    before, after = _cases(place / "out"), _cases(place / "out" / "judged" / "1-plan")
    assert after.loc["plan-a", "verdict"] == "fail"
    assert list(after.index) == list(before.index)
    assert list(after["verdict"])[1:] == list(before["verdict"])[1:]
    # A narrower search needs values that nobody has run
    other = _write(place, ROW.format("0.1", "> 126"))
    assert axisrig("judge", "out", "--plan", other)[0] == 4
    _write(place, FOUND)
    assert axisrig("replay", "out", "plan-a-s03")[0] == (
        before.loc["plan-a-s03", "verdict"] != "pass"
    )
    code, _, err = axisrig("replay", "out", "plan-a")
    assert code == 2
    assert "over several runs" in err


@pytest.mark.long
def test_a_limit_outside_the_range_fails(place: Path, axisrig: Call) -> None:
    plan = _write(place, "a,part.nc,rig.toml,3000,128 .. 129 to 0.5,== 1,,,")
    code, out, _ = axisrig("run", plan, "-o", "out")
    assert code == 1
    assert "both ends of the search hold" in out
    assert _cases(place / "out").loc["plan-a", "runs"] == "2"
