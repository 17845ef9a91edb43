"""`axisrig run --shard` and `axisrig merge`: shares of a campaign joined are the whole campaign."""

import csv
import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from axisrig.bench.campaign.sharing import Shard
from axisrig.kernel.errors import UserError

Call = Callable[..., tuple[int, str, str]]
HEAD = "case,program,rig,repeats,plc:V.E.FEED,check:msg:N30,check:mean(latch_error_um)"
ROWS = (
    "a,part.nc,rig.toml,,3000,== 1,",
    "b,part.nc,rig.toml,,[2500 | 3000],== 1,-3 .. 3",
    "c,part.nc,rig.toml,,2000,== 0,",
)


def _plan(place: Path, *rows: str) -> str:
    (place / "plan.csv").write_text("\n".join([HEAD, *rows, ""]), encoding="utf-8")
    return "plan.csv"


def _content(folder: Path) -> dict[str, bytes]:
    """Every file but manifest, report and lock; without wall time."""
    found = {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name not in ("manifest.json", "report.html", ".lock")
    }
    table = pd.read_csv(folder / "cases.csv", dtype=str).drop(columns=["wall_s", "timestamp"])
    found["cases.csv"] = table.to_csv().encode()
    found["junit.xml"] = re.sub(rb' time(stamp)?="[^"]*"', b"", found["junit.xml"])
    return found


@pytest.fixture
def called(axisrig: Call, monkeypatch: pytest.MonkeyPatch) -> Call:
    """Call a command as a process of its own would be: the manifest has its words."""

    def call(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["axisrig", *words])
        return axisrig(*words)

    return call


def _runs(folder: Path) -> list[str]:
    with (folder / "cases.csv").open(encoding="utf-8", newline="") as file:
        return [row["run"] for row in csv.DictReader(file)]


@pytest.mark.parametrize("count", [1, 2, 3, 5, 12])
def test_shares_are_apart_and_whole(count: int) -> None:
    cases = [object() for _ in range(12)]
    shares = [Shard(number, count).share(cases) for number in range(1, count + 1)]  # type: ignore[arg-type]
    assert sorted(map(id, (case for share in shares for case in share))) == sorted(map(id, cases))
    assert max(map(len, shares)) - min(map(len, shares)) <= 1


@pytest.mark.parametrize("text", ["0/3", "4/3", "1", "1/0", "a/b", "1/3/4", "-1/3"])
def test_no_share(text: str) -> None:
    with pytest.raises(UserError, match="no share of a campaign"):
        Shard.of(text)


@pytest.mark.long
def test_shares_joined_are_the_whole_campaign(place: Path, called: Call) -> None:
    plan = _plan(place, *ROWS)
    assert called("run", plan, "-o", "whole")[0] == 1
    for number in (1, 2, 3):
        called("run", plan, "-o", f"s{number}", "--shard", f"{number}/3")
    assert [_runs(place / f"s{n}") for n in (1, 2, 3)] == [
        *(["plan-a", "plan-c"], ["plan-b-2500"], ["plan-b-3000"])
    ]
    code, out, _ = called("merge", "s3", "s1", "s2", "-o", "all")
    assert (code, out.splitlines()[0]) == (0, "4 runs and 1 row of statistics, 0 missing")
    assert _content(place / "all") == _content(place / "whole")
    assert (place / "all" / "report.html").is_file()

    # A share that is missing is said, and can be run into the merged folder
    code, _, err = called("merge", "s1", "s3", "-o", "part")
    assert code == 4
    assert "missing: plan-b-2500" in err
    assert "plan-b" not in _runs(place / "part")  # no statistics over a part
    assert called("run", plan, "-o", "part", "--resume")[0] == 1
    assert _content(place / "part") == _content(place / "whole")

    assert called("merge", "s1", "s2", "-o", "s1")[0] == 2
    # A folder that was copied in part; options that change no result may differ
    (place / "s2" / "traces" / "plan-b-2500.parquet").unlink()
    code, _, err = called("merge", "s1", "s2", "s3", "-o", "bare")
    assert code == 4
    assert "the trace or the file of the run is missing: plan-b-2500" in err
    called("run", plan, "-o", "s2", "--shard", "2/3", "--fresh", "--timeout", "60", "--isolate")
    assert called("merge", "s1", "s2", "s3", "-o", "apart", "--fresh")[0] == 0
    assert _content(place / "apart") == _content(place / "whole")
    # A part of the plan, with options and their values in one word
    called("run", plan, "-ok1", "-j1", "-k", "a or c", "--shard", "1/2")
    called("run", plan, "-o", "k2", "-k", "a or c", "--shard", "2/2")
    called("run", plan, "-o", "k", "-k", "a or c")
    assert called("merge", "k1", "k2", "-o", "kk")[0] == 0
    assert _content(place / "kk") == _content(place / "k")
    # The same share twice is one
    code, _, err = called("merge", "s1", "s1", "s2", "s3", "-o", "twice")
    assert code == 0
    assert "in several folders, with equal results: plan-a" in err
    assert _content(place / "twice") == _content(place / "whole")


@pytest.mark.long
def test_shares_with_other_values_of_one_run_are_not_joined(place: Path, called: Call) -> None:
    """The same frames and verdict, another value; another uncertainty; another limit."""
    plan = _plan(place, ROWS[0])
    called("run", plan, "-o", "s1", "--shard", "1/1")
    shutil.copytree(place / "s1", place / "s2")
    results = place / "s2" / "results.csv"
    text = results.read_text(encoding="utf-8")
    head, *rows = text.splitlines()
    columns = head.split(",")
    assert called("merge", "s1", "s2", "-o", "equal")[0] == 0
    for name in ("value", "uncertainty", "upper", "note"):
        cells = rows[0].split(",")
        cells[columns.index(name)] = "7.5"
        results.write_text("\n".join([head, ",".join(cells), *rows[1:], ""]), encoding="utf-8")
        code, _, err = called("merge", "s1", "s2", "-o", name)
        assert code == 2, name
        assert "another result" in err


@pytest.mark.long
def test_a_share_has_its_probes(place: Path, called: Call) -> None:
    head = "case,program,rig,plc:V.E.FEED,search:plant:probe.surface_mm,check:msg:N30"
    rows = ["a,part.nc,rig.toml,3000,,== 1", "b,part.nc,rig.toml,3000,125.1 .. 129 to 0.5,== 1"]
    text = "\n".join([f"{head},check:search_good", f"{rows[0]},", f"{rows[1]},126 .. 126.5", ""])
    (place / "plan.csv").write_text(text, encoding="utf-8")
    assert called("run", "plan.csv", "-o", "whole")[0] == 0
    for number in (1, 2):
        called("run", "plan.csv", "-o", f"s{number}", "--shard", f"{number}/2")
    assert called("merge", "s1", "s2", "-o", "all")[0] == 0
    assert _content(place / "all") == _content(place / "whole")


@pytest.mark.long
def test_folders_of_other_campaigns_are_refused(place: Path, called: Call) -> None:
    plan = _plan(place, ROWS[0], ROWS[2])
    called("run", plan, "-o", "s1", "--shard", "1/2")
    called("run", plan, "-o", "s2", "--shard", "2/2", "--set", "plant:z.kv=39")
    code, _, err = called("merge", "s1", "s2", "-o", "all")
    assert code == 2
    assert "other options than s1" in err
    called("run", plan, "-o", "s2", "--shard", "2/2", "--fresh")
    table = place / "s2" / "cases.csv"
    row = (place / "s1" / "cases.csv").read_text(encoding="utf-8").splitlines()[1]
    with table.open("a", encoding="utf-8") as file:
        file.write(row.replace(",pass,", ",marginal,") + "\n")
    code, _, err = called("merge", "s1", "s2", "-o", "all")
    assert code == 2
    assert "the run has another result than in s1" in err
    called("run", plan, "-o", "s2", "--shard", "2/2", "--fresh")
    program = place / "part.nc"
    program.write_text(program.read_text(encoding="utf-8") + "(changed)\n", encoding="utf-8")
    code, _, err = called("merge", "s1", "s2", "-o", "all")
    assert code == 2
    assert "what the run depends on is not what it was run with" in err
    assert called("run", plan, "-o", "s3", "--shard", "3/3")[0] == 2
