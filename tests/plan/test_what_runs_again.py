"""Which runs a call runs again, how a process that ended is named, axes in their order."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of
from tests.plan.test_process_ends import INSIDE, OUTSIDE
from tests.plan.test_runs_that_stay import kept, stored

from axisrig.bench.campaign import hardware_runs, processes
from axisrig.bench.campaign.hardware_runs import Outside, allow
from axisrig.bench.campaign.resuming import GoingOn
from axisrig.bench.plan.table import read_table
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError


@pytest.mark.parametrize("verdict", Verdict)
@pytest.mark.parametrize("going_on", [GoingOn.MISSING, GoingOn.FAILED])
@pytest.mark.parametrize("fits", [True, False])
def test_a_run_stays_by_its_verdict_and_by_what_it_depends_on(
    tmp_path: Path, verdict: Verdict, going_on: GoingOn, fits: bool
) -> None:
    """`--resume`: what has ended and still fits. `--failed`: what passed, whatever it is of."""
    run = stored(tmp_path, "p-a", verdict.word, depends="h" if fits else "older")
    found = kept(tmp_path, [case_of("a")], [run], going_on)
    stays = (
        fits and verdict is not Verdict.ABORTED
        if going_on is GoingOn.MISSING
        else verdict in (Verdict.PASS, Verdict.MARGINAL)
    )
    assert list(found.verdicts) == ([verdict] if stays else [])
    assert len(found.cases) == (not stays)
    assert found.changed == (not stays and not fits)


@pytest.mark.parametrize("code", [0, 1, 3, 255])
def test_a_process_that_ended_by_itself_did_not_crash(code: int) -> None:
    """Whatever its exit code is; a signal is a crash."""
    words = processes._in_words(code, INSIDE)
    assert words.endswith(
        f"(plant z) ended the process in fmi3DoStep at t = 1.500000 ms: exit code {code}"
    )
    assert processes._in_words(code, OUTSIDE).startswith(
        f"the process ended: exit code {code}; the last call was fmi3DoStep"
    )
    assert " crashed in fmi3DoStep" in processes._in_words(-6, INSIDE)


@pytest.mark.parametrize("names", ["XYZ", "ZYX", "CBAZYX", "QWERTZUIOP"])
def test_axes_that_will_move_are_named_in_their_order_rig_by_rig(
    names: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hardware_runs, "outside_axes", lambda rig: frozenset(rig.axes))
    monkeypatch.setattr(hardware_runs, "simulated_plants", lambda _rig: [])
    monkeypatch.setattr(hardware_runs, "foreign_plants", lambda plants: plants)
    family = SimpleNamespace(outside=lambda _rig, name: f"drive of {name}")
    monkeypatch.setattr(hardware_runs, "family_of", lambda _rig, _name: family)
    lines: list[str] = []
    outside = Outside(lambda: None, may_move=True, put_out=lines.append)  # type: ignore[arg-type,return-value]
    rigs: Any = [
        SimpleNamespace(rig=SimpleNamespace(hardware=False), axes=axes) for axes in (names, "BA")
    ]
    allow(rigs, outside)
    axes = [line.split()[1].rstrip(":") for line in lines if line.startswith("  axis")]
    assert axes == [*dict.fromkeys([*sorted(names), "A", "B"])]


@pytest.mark.parametrize("empty", [0, 1, 2, 5])
@pytest.mark.parametrize("separator", [",", ";"])
def test_columns_without_a_name_at_the_end_are_no_columns(
    tmp_path: Path, empty: int, separator: str
) -> None:
    """As a spreadsheet program writes them that has once had something there."""
    path = tmp_path / "p.csv"
    end = separator * empty
    rows = [["case", "program", "rig"], ["a", "a.nc", "r.toml"], ["b", "b.nc", ""]]
    path.write_text("".join(separator.join(row) + end + "\n" for row in rows), encoding="utf-8")
    found = read_table(path)
    assert list(found.columns) == rows[0]
    assert [dict(row.cells) for row in found.rows] == [
        dict(zip(rows[0], row, strict=True)) for row in rows[1:]
    ]
    if empty > 1:
        text = separator.join(["c", "c.nc", "r.toml"]) + separator * (empty - 1) + "x"
        with path.open("a", encoding="utf-8") as file:
            file.write(f"{text}{separator}\n")
        with pytest.raises(UserError, match="more cells than the header"):
            read_table(path)
