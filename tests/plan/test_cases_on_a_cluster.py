"""A case on its way to a worker of a cluster and back, in this process: nothing is run."""

import os
import pickle
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import platformdirs
import pytest

from axisrig.bench.campaign import cluster
from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.runner import Limits, no_stopwatch
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.own_metrics import OwnModule
from axisrig.bench.plan.table import Place
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError

FILES = {"plans/p.csv": "plan", "plans/part.nc": "program", "plans/rigs/r.toml": "rig",
         "lists/a.lst": "list", "lists/b.lst": "list"}  # fmt: skip


@pytest.fixture
def case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Case:
    here = tmp_path / "here"
    for name, text in FILES.items():
        (here / name).parent.mkdir(parents=True, exist_ok=True)
        (here / name).write_text(text, encoding="utf-8")
    plans = here / "plans"
    monkeypatch.setattr(cluster, "files_of_case", lambda _: [here / name for name in FILES])
    monkeypatch.setattr(platformdirs, "user_cache_dir", lambda _: str(tmp_path / "cache"))
    return Case("p", "a", "p-a", 0, plans / "part.nc", plans / "rigs" / "r.toml", {}, (), "", (),
                "", 1, 0, plans / "p.csv", 2, {}, folder=plans)  # fmt: skip


def packed(case: Case, out: Path, limits: Limits | None = None, probes: int = 0) -> Any:
    places = [RunFiles([], out / f"p-a-s0{n + 1}.parquet") for n in range(probes)]
    files = RunFiles([out / "p-a.blf", out / "p-a.asc"], out / "p-a.parquet", places)
    return cluster._packed(case, files, limits or Limits(), no_stopwatch)


def test_files_travel_once_by_their_content_and_names_are_below_one_folder(
    case: Case, tmp_path: Path
) -> None:
    parcel, contents = packed(case, tmp_path, probes=2)
    assert sorted(contents.values()) == sorted({text.encode() for text in FILES.values()})
    assert set(parcel.names) == set(FILES)
    for name, (key, path) in parcel.names.items():
        assert contents[key] == FILES[name].encode()
        assert Path(path) == tmp_path / "here" / name
    assert (str(parcel.case.program), str(parcel.case.rig)) == (
        "plans/part.nc",
        "plans/rigs/r.toml",
    )
    assert (str(parcel.case.file), str(parcel.case.folder)) == ("plans/p.csv", "plans")
    assert parcel.suffixes == (".blf", ".asc")
    assert parcel.probes == ("p-a-s01", "p-a-s02")
    assert (parcel.rig, list(parcel.limits.apart)) == ("rigs/r.toml", [])
    apart, _ = packed(case, tmp_path, Limits(5.0, [case.rig, Path("other")], 7.0))
    assert list(apart.limits.apart) == [Path("plans/rigs/r.toml")]
    assert (apart.limits.timeout_s, apart.limits.call_limit_s) == (5.0, 7.0)
    other, _ = packed(case, tmp_path, Limits(apart=[Path("other")]))
    assert list(other.limits.apart) == []


def worked(parcel: Any, contents: Mapping[str, bytes], patch: pytest.MonkeyPatch) -> Any:
    """What a worker gives back; its run writes its files and names them in what it says."""
    orders: list[Any] = []

    def run(order: Any) -> CaseResult:
        orders.append(order)
        result = CaseResult(order.case, Verdict.FAIL, [], error=f"see {order.case.program}")
        result.log = [f"{order.case.rig} is odd"]
        places = [order.files, *order.files.probes]
        for place in places:
            place.trace.write_bytes(b"trace")
        order.files.bus_logs[0].write_bytes(b"log")
        return result

    patch.setattr(cluster, "_run", run)
    patch.setattr(cluster, "_run_beside", run)
    content = cluster._work(pickle.dumps(parcel), contents)
    return content, orders[0]


def test_a_worker_has_the_files_and_what_it_says_names_those_here(
    case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parcel, contents = packed(case, tmp_path, Limits(call_limit_s=7.0), probes=1)
    content, order = worked(parcel, contents, monkeypatch)
    tree = order.case.program.parents[1]
    assert tree.parent == tmp_path / "cache" / "cluster"
    assert {path.relative_to(tree).as_posix(): path.read_text(encoding="utf-8")
            for path in tree.rglob("*") if path.is_file()} == FILES  # fmt: skip
    assert (order.case.rig, order.case.folder) == (tree / "plans/rigs/r.toml", tree / "plans")
    assert (order.files.rig, order.limits.call_limit_s) == ("rigs/r.toml", 7.0)
    assert [path.name for path in order.files.bus_logs] == ["p-a.blf", "p-a.asc"]
    assert [place.trace.name for place in order.files.probes] == ["p-a-s01.parquet"]
    out = tmp_path / "out"
    out.mkdir()
    files = RunFiles([out / "p-a.blf", out / "p-a.asc"], out / "p-a.parquet")
    result = cluster._unpacked(case, content, lambda _: files)
    assert result.case is case
    assert result.error == f"see {tmp_path / 'here' / 'plans' / 'part.nc'}"
    assert result.log == [f"{tmp_path / 'here' / 'plans' / 'rigs' / 'r.toml'} is odd"]
    assert (out / "p-a.blf").read_bytes() == b"log"
    assert not (out / "p-a.asc").exists()  # none was written
    assert (out / "p-a.parquet").read_bytes() == b"trace"
    assert result.series is not None


def test_a_file_that_a_cell_names_is_that_of_the_tree(
    case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From the table of the cell, here or in another folder; other cells stay as they are."""
    here = tmp_path / "here"
    names = {
        "drive:D.eds": "maps/d.eds",
        "drive:D.pdo_map": "../lists/map.csv",
        "drive:E.pdo_map": str(here / "lists" / "e.csv"),
        "plc:V.E.A": "maps/d.eds",
    }
    places = {
        "drive:D.eds": Place(here / "plans" / "p.csv", 2, 4, "drive:D.eds"),
        "drive:D.pdo_map": Place(here / "parts" / "q.csv", 3, 5, "drive:D.pdo_map"),
    }
    for name in ("plans/maps/d.eds", "lists/map.csv", "lists/e.csv"):
        (here / name).parent.mkdir(parents=True, exist_ok=True)
        (here / name).write_text(name, encoding="utf-8")
    named = replace(case, inputs=names, places=places)
    files = [item.value for item in named.assignments() if item.names_file]
    monkeypatch.setattr(
        cluster, "files_of_case", lambda _: [*(here / name for name in FILES), *map(Path, files)]
    )
    parcel, contents = packed(named, tmp_path)
    _, order = worked(parcel, contents, monkeypatch)
    tree = order.case.program.parents[1]
    found = {item.column: item.value for item in order.case.assignments()}
    assert found.pop("plc:V.E.A") == "maps/d.eds"
    inside = {column: Path(value).relative_to(tree) for column, value in found.items()}
    assert inside == {
        "drive:D.eds": Path("plans/maps/d.eds"),
        "drive:D.pdo_map": Path("lists/map.csv"),
        "drive:E.pdo_map": Path("lists/e.csv"),
    }
    for value in found.values():
        assert Path(value).read_text(encoding="utf-8") == Path(value).relative_to(tree).as_posix()


@pytest.mark.parametrize("is_file", [True, False])
def test_probes_come_back_with_the_cells_and_the_metrics_of_here(
    case: Case, tmp_path: Path, is_file: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each has its own value of what is searched; a file of metrics travels, an entry point not."""
    here = tmp_path / "here"
    for name in ("plans/own.py", "plans/maps/d.eds"):
        (here / name).parent.mkdir(parents=True, exist_ok=True)
        (here / name).touch()
    module = OwnModule("own", here / "plans" / "own.py" if is_file else None, {})
    cells = {"drive:D.eds": "maps/d.eds", "plc:V.E.A": "1"}
    searched = replace(case, inputs=cells, module=module)
    files = [*(here / name for name in FILES), here / "plans" / "maps" / "d.eds"]
    monkeypatch.setattr(
        cluster, "files_of_case", lambda _: [*files, *([module.path] if module.path else [])]
    )
    parcel, contents = packed(searched, tmp_path, probes=2)

    def run(order: Any) -> CaseResult:
        there = order.case
        assert there.module.name == "own"
        assert (there.module.path is None) != is_file
        assert there.module.path is None or here not in there.module.path.parents
        result = CaseResult(there, Verdict.PASS, [])
        result.probes = tuple(
            CaseResult(
                replace(there, run=f"p-a-s0{n}", inputs={**there.inputs, "plc:V.E.B": f"{n}"}),
                Verdict.PASS,
                [],
            )
            for n in (1, 2)
        )
        return result

    monkeypatch.setattr(cluster, "_run", run)
    content = cluster._work(pickle.dumps(parcel), contents)
    result = cluster._unpacked(searched, content, lambda _: RunFiles(probes=[RunFiles()] * 2))
    assert result.case is searched
    for number, probe in enumerate(result.probes, 1):
        assert probe.case == replace(
            searched, run=f"p-a-s0{number}", inputs={**cells, "plc:V.E.B": f"{number}"}
        )


def test_a_tree_is_made_once_and_for_each_content(
    case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parcel, contents = packed(case, tmp_path)
    _, first = worked(parcel, contents, monkeypatch)
    (first.case.program.parent / "kept").touch()
    _, again = worked(parcel, {}, monkeypatch)  # nothing is needed of what is there
    assert again.case.program == first.case.program
    case.program.write_text("changed", encoding="utf-8")
    changed, more = packed(case, tmp_path)
    _, other = worked(changed, more, monkeypatch)
    assert other.case.program != first.case.program
    assert len(list((tmp_path / "cache" / "cluster").iterdir())) == 2


@pytest.mark.parametrize("is_apart", [True, False])
def test_a_foreign_rig_runs_beside_the_worker(
    is_apart: bool, case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parcel, contents = packed(case, tmp_path, Limits(apart=[case.rig] if is_apart else []))
    ran: list[str] = []

    def run(way: str) -> Any:
        def made(order: Any) -> CaseResult:
            ran.append(way)
            assert order.limits.is_apart(order.case) is is_apart
            return CaseResult(order.case, Verdict.PASS, [])

        return made

    monkeypatch.setattr(cluster, "_run", run("here"))
    monkeypatch.setattr(cluster, "_run_beside", run("beside"))
    cluster._work(pickle.dumps(parcel), contents)
    assert ran == ["beside" if is_apart else "here"]


def test_a_run_of_a_worker_has_its_limits_and_leaves_its_signals_in_files(
    case: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a search those of every probe too: what goes back is what can be sent."""
    asked: dict[str, Any] = {}
    probes = [CaseResult(case, Verdict.PASS, [], series=object()) for _ in range(2)]  # type: ignore[arg-type]
    whole = CaseResult(case, Verdict.FAIL, [], series=object(), probes=tuple(probes))  # type: ignore[arg-type]

    def run_cases(cases: Any, files_of: Any, **given: Any) -> Any:
        asked.update(given, cases=cases, files=files_of(case.run))
        return iter([whole])

    monkeypatch.setattr(cluster, "run_cases", run_cases)
    files, limits = RunFiles(rig="r"), Limits(5.0, [case.rig], 7.0)
    assert cluster._run(cluster._Order(case, files, limits, no_stopwatch)) is whole
    assert asked == {
        "cases": [case], "files": files, "limits": limits, "stopwatch": no_stopwatch
    }  # fmt: skip
    assert [one.series for one in (whole, *probes)] == [None] * 3


@pytest.mark.parametrize("code", [0, -9, 3])
def test_the_process_beside_a_worker_hands_over_its_result_or_costs_its_row(
    code: int, case: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What it writes to its standard error is the log of a run that it could not end."""
    order = cluster._Order(case, RunFiles(), Limits(), no_stopwatch)
    watched: list[int] = []
    monkeypatch.setattr(cluster, "end_with", watched.append)
    monkeypatch.setattr(
        cluster, "_run", lambda one: CaseResult(one.case, Verdict.MARGINAL, [], error="of the run")
    )

    def run(command: list[str], **_: Any) -> Any:
        assert command[:2] == [cluster.sys.executable, "-c"]
        if code == 0:
            exec(command[2], {})
        return SimpleNamespace(returncode=code, stderr=b"one\ntwo \xff\n")

    monkeypatch.setattr(cluster.subprocess, "run", run)
    result = cluster._run_beside(order)
    if code == 0:
        assert (result.verdict, result.error, result.log) == (Verdict.MARGINAL, "of the run", [])
        assert watched == [os.getpid()]
    else:
        assert (result.case, result.verdict) == (case, Verdict.ERROR)
        assert result.error == f"the process of the run ended: exit code {code}"
        assert result.log == ["one", "two \N{REPLACEMENT CHARACTER}"]


def test_a_worker_with_other_sources_runs_nothing(
    case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parcel, contents = packed(case, tmp_path)
    monkeypatch.setattr(cluster, "sources_sha256", lambda: "other")
    content = cluster._work(pickle.dumps(parcel), contents)
    result = cluster._unpacked(case, content, lambda _: RunFiles())
    assert (result.verdict, result.error) == (Verdict.ERROR, "the worker has another axisrig")
    lost = cluster._unpacked(case, "no worker could run it: odd", lambda _: RunFiles())
    assert (lost.verdict, lost.error) == (Verdict.ERROR, "no worker could run it: odd")


def test_probes_of_a_search_get_their_files_and_the_names_of_here(
    case: Case, tmp_path: Path
) -> None:
    there = replace(case, program=Path("/there/part.nc"), file=Path("/there/p.csv"))
    probe = CaseResult(replace(there, run="p-a-s01"), Verdict.PASS, [])
    found = CaseResult(there, Verdict.PASS, [])
    found.probes = [probe]
    files = {"p-a-s01.parquet": b"of the probe"}
    out = tmp_path / "out"
    out.mkdir()
    places = RunFiles([], out / "p-a.parquet", [RunFiles([], out / "p-a-s01.parquet")])
    content = pickle.dumps(cluster._Returned(found, files))
    result = cluster._unpacked(case, content, lambda _: places)
    (one,) = result.probes
    assert (one.case.run, one.case.program, one.case.file) == ("p-a-s01", case.program, case.file)
    assert (out / "p-a-s01.parquet").read_bytes() == b"of the probe"
    assert one.series is not None
    assert result.series is None


def test_a_lost_scheduler_is_named_and_a_lost_worker_is_a_reason() -> None:
    def future(status: str, value: Any = None) -> Any:
        return SimpleNamespace(
            status=status, result=lambda: value, exception=lambda: ValueError("a\n  b")
        )

    assert cluster._content(future("finished", b"x"), "tcp://s") == b"x"
    assert cluster._content(future("error"), "tcp://s") == "no worker could run it: a b"
    for status in ("lost", "cancelled"):
        with pytest.raises(ConnectionError, match="scheduler tcp://s is lost"):
            cluster._content(future(status), "tcp://s")

    class FutureCancelledError(Exception):
        pass

    for error, is_lost in ((OSError("x"), True), (FutureCancelledError(), True),
                           (UserError("y"), False)):  # fmt: skip
        with pytest.raises(ConnectionError if is_lost else UserError):
            raise_within(error)


def raise_within(error: Exception) -> None:
    with cluster._naming_lost("tcp://s"):
        raise error


def test_names_are_replaced_wherever_a_text_has_them(case: Case) -> None:
    here = {"/there/a.nc": "here.nc"}
    value = {"k": ["see /there/a.nc:3", ("/there/a.nc", 5, None)], "n": 1.5}
    assert cluster._renamed(value, here) == {"k": ["see here.nc:3", ("here.nc", 5, None)], "n": 1.5}
    assert cluster._renamed(case, {"p-a": "other"}) is case


@pytest.mark.parametrize("has_logs", [True, False])
def test_logs_of_each_kind_and_segment_go_to_the_places_of_their_run(
    case: Case, tmp_path: Path, has_logs: bool
) -> None:
    """Also of a probe; of a run without logs, or a trace without a place, nothing is written."""
    found = CaseResult(case, Verdict.PASS, [])
    found.probes = [CaseResult(replace(case, run="p-a-s01"), Verdict.PASS, [])]
    names = ["p-a.blf", "p-a.asc", "p-a@ec1.pcapng", "p-a@ec2.pcapng", "p-a-s01.blf",
             "p-a-s01@ec1.pcapng"]  # fmt: skip
    files = {name: name.encode() for name in [*names, "p-a.parquet", "p-b@ec1.pcapng"]}
    out = tmp_path / "out"
    out.mkdir()
    logs = [out / "p-a.blf", out / "p-a.asc"] if has_logs else []
    of_probe = [out / "p-a-s01.blf"] if has_logs else []
    places = RunFiles(logs, None, [RunFiles(of_probe, out / "p-a-s01.parquet")])
    content = pickle.dumps(cluster._Returned(found, files))
    result = cluster._unpacked(case, content, lambda run: {"p-a": places}[run])
    left = {path.name: path.read_bytes().decode() for path in out.iterdir()}
    assert left == ({name: name for name in names} if has_logs else {})
    assert [one.series for one in (result, *result.probes)] == [None, None]


def test_a_run_that_a_worker_could_not_make_is_an_error_with_its_reason(case: Case) -> None:
    content = pickle.dumps(cluster._Returned(None, {}, "the rig of there is odd"))
    lost = cluster._unpacked(case, content, lambda _: RunFiles())
    assert (lost.case, lost.verdict, lost.error) == (case, Verdict.ERROR, "the rig of there is odd")
