"""Which runs `--resume` and `--failed` keep, and what a call takes over from its folder."""

import hashlib
import itertools
import json
import os
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import resuming
from axisrig.bench.campaign.results.stored import DEPENDS, PROBE, RUNS, StoredRun
from axisrig.bench.campaign.results.sums import RECORDING_SUM
from axisrig.bench.campaign.resuming import (
    GoingOn,
    Kept,
    choose,
    longest_first,
    own_plan,
    stored_arguments,
)
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError

SEARCH: Any = SimpleNamespace(checks=())


def stored(
    place: Path, run: str, verdict: str = "pass", *, depends: str = "h", is_there: bool = True,
    is_altered: bool = False, **more: str,
) -> StoredRun:  # fmt: skip
    """A run of a folder with its file, and the sum of it; altered: it was written to since."""
    path = place / "runs" / f"{run}.json"
    path.parent.mkdir(exist_ok=True)
    path.write_text("later" if is_altered else run, encoding="utf-8")
    row = {"run": run, "verdict": verdict, DEPENDS: depends, **more}
    row[RECORDING_SUM] = hashlib.sha256(run.encode()).hexdigest()
    return StoredRun(row, [], path if is_there else None, None, place=place)


def kept(
    place: Path, cases: Sequence[Case], runs: Sequence[StoredRun], going_on: GoingOn,
    now: str = "h",
) -> Kept:  # fmt: skip
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(resuming, "is_results_folder", lambda _: True)
        patch.setattr(resuming, "read_results", lambda _: SimpleNamespace(runs=runs))
        return choose(cases, {case.run: now for case in cases}, place, going_on)


A, B, C = (case_of(name) for name in "abc")
S = case_of("s", search=SEARCH)


def test_what_fits_stays_and_the_rest_is_counted(tmp_path: Path) -> None:
    """Of a run without a row nothing has changed, nor of one whose file is missing."""
    runs = [
        stored(tmp_path, "p-b", "fail"),
        stored(tmp_path, "p-a", depends="older"),
        stored(tmp_path, "p-d", "marginal"),
        stored(tmp_path, "p-e", is_there=False),
    ]
    cases = [A, B, C, case_of("d"), case_of("e")]
    found = kept(tmp_path, cases, runs, GoingOn.MISSING)
    assert [case.run for case in found.cases] == ["p-a", "p-c", "p-e"]
    assert list(found.verdicts) == [Verdict.FAIL, Verdict.MARGINAL]
    assert found.counts == {"kept": 2, "run": 3, "changed": 1}
    assert list(found.altered) == []


def test_failed_ones_alone_run_whatever_they_depend_on(tmp_path: Path) -> None:
    runs = [
        stored(tmp_path, "p-a", depends="older"),
        stored(tmp_path, "p-b", "fail"),
        stored(tmp_path, "p-c", "inconclusive", depends="older"),
    ]
    found = kept(tmp_path, [A, B, C], runs, GoingOn.FAILED)
    assert [case.run for case in found.cases] == ["p-b", "p-c"]
    assert found.counts == {"kept": 1, "run": 2, "changed": 1}


def test_a_run_of_which_nothing_can_be_known_runs_again(tmp_path: Path) -> None:
    """Rig or program cannot be read: an empty hash is equal to no other, not to an empty one."""
    runs = [stored(tmp_path, "p-a", depends=""), stored(tmp_path, "p-b", depends="h")]
    found = kept(tmp_path, [A, B], runs, GoingOn.MISSING, now="")
    assert found.counts == {"kept": 0, "run": 2, "changed": 2}


@pytest.mark.parametrize("probes", [0, 1, 2, 3])
@pytest.mark.parametrize("is_there", [True, False])
def test_a_search_stays_with_just_the_probes_that_it_counts(
    tmp_path: Path, probes: int, is_there: bool
) -> None:
    """It has no file of its own; probes of another search, and runs, are none of its."""
    runs = [stored(tmp_path, "p-s", is_there=is_there, **{RUNS: "2"}), stored(tmp_path, "p-a")]
    runs += [stored(tmp_path, f"p-s-s0{n}", **{PROBE: "p-s"}) for n in range(1, probes + 1)]
    runs += [stored(tmp_path, "p-t-s01", **{PROBE: "p-t"})]
    found = kept(tmp_path, [S], runs, GoingOn.MISSING)
    assert found.counts == {"kept": int(probes == 2), "run": int(probes != 2), "changed": 0}


@pytest.mark.parametrize("going_on", [GoingOn.MISSING, GoingOn.FAILED])
def test_a_run_with_a_file_of_another_is_run_again_in_any_case(
    tmp_path: Path, going_on: GoingOn
) -> None:
    """A search too, by the file of one probe."""
    runs = [
        stored(tmp_path, "p-a", is_altered=True),
        stored(tmp_path, "p-b"),
        stored(tmp_path, "p-s", **{RUNS: "2"}),
        stored(tmp_path, "p-s-s01", **{PROBE: "p-s"}),
        stored(tmp_path, "p-s-s02", is_altered=True, **{PROBE: "p-s"}),
    ]
    found = kept(tmp_path, [A, B, S], runs, going_on)
    assert [case.run for case in found.cases] == ["p-a", "p-s"]
    assert found.counts == {"kept": 1, "run": 2, "changed": 2}
    words = "not as the run has written it: runs"
    assert list(found.altered) == [f"p-a: {words}/p-a.json", f"p-s-s02: {words}/p-s-s02.json"]


def test_a_folder_without_results_keeps_nothing(tmp_path: Path) -> None:
    found = choose([A], {"p-a": "h"}, tmp_path, GoingOn.MISSING)
    assert found.counts == {"kept": 0, "run": 1, "changed": 0}
    assert choose([A], {}, tmp_path, GoingOn.NO).counts == {}


@pytest.mark.parametrize("options", list(itertools.product([False, True], repeat=3)))
def test_options_that_keep_exclude_each_other_and_what_clears(
    options: tuple[bool, bool, bool],
) -> None:
    is_resumed, is_failed, is_fresh = options
    named = {"is_resumed": is_resumed, "is_failed": is_failed, "is_fresh": is_fresh}
    if sum(options) > 1:
        with pytest.raises(UserError, match="--failed"):
            GoingOn.of(**named)
    else:
        expected = "--resume" if is_resumed else "--failed" if is_failed else ""
        assert GoingOn.of(**named).option == expected


# The call that the manifest of a folder holds

VALUED = ("-o", "--out", "-k", "--set", "-j", "--jobs", "--timeout", "--live-port")


def folder_of(place: Path, *words: str, plan: str = "p.csv") -> Path:
    manifest = {"command": list(words), "axisrig": "1", "runs_planned": 1,
                "plans": [{"name": "p", "path": plan, "sha256": "0" * 64}]}  # fmt: skip
    place.mkdir(exist_ok=True)
    (place / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    return place


@pytest.mark.parametrize(
    ("words", "given", "rest"),
    [
        ("p.csv q.csv -o out", "", "p.csv q.csv"),
        ("-o out p.csv --resume -k a -v", "", "p.csv -k a -v"),
        ("p.csv --out=out --timeout=5 --fresh", "", "p.csv --timeout=5"),
        ("p.csv -oout -j4 -k a", "", "p.csv -j4 -k a"),
        ("p.csv -j4 --set a=b --set=c=d", "-j --jobs", "p.csv --set a=b --set=c=d"),
        ("p.csv -j 4 -k -o --timeout 9", "-j --jobs", "p.csv -k -o --timeout 9"),
        ("p.csv --timeout 9 --failed -y x", "--timeout", "p.csv x"),
        ("p.csv --live --live-terminal --yes -k", "", "p.csv -k"),
        ("p.csv -k a", "-k", "p.csv"),
        ("p.csv -o", "", "p.csv"),
    ],
)
def test_what_a_call_gives_takes_the_place_of_what_the_folder_has(
    tmp_path: Path, words: str, given: str, rest: str
) -> None:
    """The word after an option with a value is that value, whatever it looks like."""
    folder = folder_of(tmp_path / "out", "axisrig", "run", *words.split())
    assert stored_arguments(folder, given.split(), VALUED) == rest.split()


@pytest.mark.parametrize("words", [(), ("axisrig",), ("axisrig", "judge", "run"), ("run", "p.csv")])
def test_a_folder_of_another_command_is_not_gone_on_with(
    tmp_path: Path, words: tuple[str, ...]
) -> None:
    with pytest.raises(UserError, match="does not come from `axisrig run`"):
        stored_arguments(folder_of(tmp_path / "out", *words), (), ())
    with pytest.raises(UserError, match="no plan is named"):
        stored_arguments(None, (), ())


@pytest.mark.parametrize(
    ("path", "is_own"),
    [("out/p.csv", False), ("out/plans/p.csv", False), ("x/../out/p.csv", False),
     ("out-p.csv", True), ("p.csv", True), ("out/../p.csv", True)],
)  # fmt: skip
def test_no_plan_comes_out_of_a_results_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str, is_own: bool
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = folder_of(Path("out"), "axisrig", "run", path, plan=path)
    if is_own:
        assert own_plan(folder, path) == Path(path)
        assert stored_arguments(folder, (), ()) == [path]
        return
    for refused in (lambda: own_plan(folder, path), lambda: stored_arguments(folder, (), ())):
        with pytest.raises(UserError, match="names a plan inside itself"):
            refused()


def test_a_damaged_table_gives_no_order(tmp_path: Path) -> None:
    folder_of(tmp_path, "axisrig", "run")
    (tmp_path / "cases.csv").write_text("nothing,of,this\n1\n", encoding="utf-8")
    assert longest_first([B, A, C], tmp_path) == [B, A, C]


def test_none_of_the_plans_of_a_folder_may_lie_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of several, whichever it is."""
    monkeypatch.chdir(tmp_path)
    folder = folder_of(Path("out"), "axisrig", "run", "p.csv", "q.csv", plan="p.csv")
    file = folder / "manifest.json"
    manifest = json.loads(file.read_text(encoding="utf-8"))
    for paths, is_refused in ((("p.csv", "q.csv"), False), (("p.csv", "out/q.csv"), True),
                              (("out/p.csv", "q.csv"), True)):  # fmt: skip
        manifest["plans"] = [{"name": "p", "path": path, "sha256": "0" * 64} for path in paths]
        file.write_text(json.dumps(manifest), encoding="utf-8")
        if not is_refused:
            assert stored_arguments(folder, (), ()) == ["p.csv", "q.csv"]
            continue
        with pytest.raises(UserError, match="names a plan inside itself"):
            stored_arguments(folder, (), ())


@pytest.mark.skipif(os.name != "posix", reason="links")
def test_a_folder_whose_files_are_links_is_not_gone_on_with(tmp_path: Path) -> None:
    """A file of results leads nowhere else."""
    folder = folder_of(tmp_path / "out", "axisrig", "run", "p.csv")
    (tmp_path / "elsewhere.csv").write_text("run\n", encoding="utf-8")
    (folder / "cases.csv").symlink_to(tmp_path / "elsewhere.csv")
    with pytest.raises(UserError, match="a results folder has no links") as caught:
        stored_arguments(folder, (), ())
    assert caught.value.value == "cases.csv"
