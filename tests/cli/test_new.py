"""`axisrig new`: a project whose plans can be run as they are."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.plan.plan import read_plan

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


@pytest.mark.long
def test_its_first_campaign_passes(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    axisrig("new", "bench")
    monkeypatch.chdir(place / "bench")
    code, out, _ = axisrig("run", "testplans/touch.csv")
    assert code == 0, out
    assert (place / "bench" / "out" / "touch" / "report.html").is_file()
