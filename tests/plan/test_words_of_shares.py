"""Which words of a command make another campaign, and which runs of its shares are the same."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer

from axisrig.bench.bus.can.logs import SEGMENT_MARK
from axisrig.bench.campaign import sharing
from axisrig.bench.campaign.results.stored import StoredRun
from axisrig.bench.campaign.sharing import (
    Shard,
    _files,
    _is_bare,
    _kept_words,
    _names,
    _runs,
    _select,
    merge,
)
from axisrig.bench.cli.main import app
from axisrig.kernel.errors import UserError


@pytest.mark.parametrize(
    ("words", "kept"),
    [
        ("run a.csv", ""),
        ("run a.csv -o out -j 4", ""),
        ("run a.csv -oout -j4 --shard=1/2", ""),
        ("run a.csv --shard 1/2 --resume --fresh --full", ""),
        ("run a.csv -k first", "-k first"),
        ("run a.csv -kfirst", "-k first"),
        ("run a.csv --set Z.kp=1 --set=Z.tv=2", "--set Z.kp=1 --set=Z.tv=2"),
        ("run a.csv --force", "--force"),
        ("run -k first a.csv -o out b.csv", "-k first"),
        # Values count of whatever decides, or says what is tested
        ("run a.csv --info serial=4 --info=order=5", "--info serial=4 --info=order=5"),
        ("run --bus-log asc a.csv --bitrate 250000", "--bus-log asc --bitrate 250000"),
        ("run a.csv --channel can1 --segment x", "--channel can1 --segment x"),
        # How it is shown, and whether it goes on or asks, counts as little as time and place
        ("run -q a.csv -v -x -y --strict --yes", ""),
        ("run a.csv --quiet --verbose --exitfirst", ""),
        ("run -xq a.csv -vxy", ""),
        ("run --timeout 5 a.csv --call-timeout=7 -k b", "-k b"),
        ("run --engine dask a.csv --scheduler tcp://h:8786 --jobs 2 --force", "--force"),
        ("run --live a.csv --live-terminal --isolate --failed --as-canopen", "--as-canopen"),
    ],
)
def test_words_that_decide_on_results_are_kept(words: str, kept: str) -> None:
    """However an option is written; plans are compared by their content."""
    assert _kept_words(words.split()) == kept.split()


def test_each_option_of_a_run_decides_on_results_or_is_beside_them() -> None:
    """Of each that a value follows the value goes with it, whatever it looks like."""
    run = typer.main.get_command(app).commands["run"]  # type: ignore[attr-defined]
    deciding = {"-k", "--set", "--info", "--force", "--as-canopen", "--bus-log", "--bitrate",
                "--interface", "--channel", "--option", "--segment"}  # fmt: skip
    options = [one for one in run.params if one.param_type_name == "option" and one.name != "help"]
    assert deciding <= {name for option in options for name in option.opts}
    for option in options:
        for name in option.opts:
            words = [name] if option.is_flag else [name, "-v"]
            kept = words if deciding & {*option.opts} else []
            assert _kept_words(["run", "a.csv", *words, "b.csv"]) == kept, name


def test_plans_are_kept_where_the_command_is_written_anew() -> None:
    words = ["axisrig", "run", "a.csv", "-o", "out", "-kfirst", "b.csv"]
    assert _kept_words(words, has_plans=True) == ["axisrig", "run", "a.csv", "-k", "first", "b.csv"]


@pytest.mark.parametrize(
    ("words", "select"),
    [(["-k", "a or b"], "a or b"), (["-ka or b"], "a or b"), ([], None), (["--set", "x=-k"], None),
     (["-o", "out", "-k", "-a"], "-a"), (["-k", "--set", "-x"], "--set")],
)  # fmt: skip
def test_what_a_share_was_selected_by(words: list[str], select: str | None) -> None:
    part: Any = SimpleNamespace(manifest={"command": ["axisrig", "run", "p.csv", *words]})
    assert _select(part) == select


@pytest.mark.parametrize(
    ("text", "runs"), [("1/1", "abcde"), ("1/2", "ace"), ("2/2", "bd"), ("3/3", "c"), ("5/5", "e")]
)
def test_a_share_has_every_nth_run(text: str, runs: str) -> None:
    cases: Any = "abcde"
    assert "".join(Shard.of(text).share(cases)) == runs  # type: ignore[arg-type]


@pytest.mark.parametrize("text", ["0/2", "3/2", "1", "1/0", "a/b", "1/2/3", "-1/2", ""])
def test_what_is_no_share_is_refused(text: str) -> None:
    with pytest.raises(UserError, match="no share of a campaign"):
        Shard.of(text)


def run(name: str, rows: Any = (), **cells: str) -> StoredRun:
    case = {"run": name, "plan": "p", "wall_s": "1", "bus_log_sha256": "x", "verdict": "pass",
            "frame_log_sha256": "f", **cells}  # fmt: skip
    return StoredRun(case, list(rows), None, None)


def part(name: str, *runs: StoredRun) -> Any:
    return SimpleNamespace(folder=Path(name), planned=list(runs))


def test_a_run_of_two_folders_is_the_first_one_where_both_are_the_same() -> None:
    """The time that it took and the sum of its bus log may differ."""
    first = part("a", run("r"), run("s"))
    second = part("b", run("r", wall_s="9", bus_log_sha256="y"), run("t"))
    found, doubled = _runs([first, second])
    assert {name: str(of.folder) for name, (of, _) in found.items()} == {
        "r": "a",
        "s": "a",
        "t": "b",
    }
    assert doubled == ["r"]
    for other in (run("r", verdict="fail"), run("r", rows=[{"metric": "m"}]),
                  run("r", frame_log_sha256="g")):  # fmt: skip
        with pytest.raises(UserError, match="another result than in a") as refused:
            _runs([first, part("b", other)])
        assert refused.value.value == "r"


def test_files_of_a_run_are_those_whose_name_goes_on_as_one(tmp_path: Path) -> None:
    for name in ("r.blf", "r@can2.blf", "r2.blf", "r-1.blf", "other.blf"):
        (tmp_path / name).write_text("x", encoding="utf-8")
    (tmp_path / "r.d").mkdir()
    assert sorted(path.name for path in _files(tmp_path, "r")) == ["r.blf", "r@can2.blf"]
    assert list(_files(tmp_path / "none", "r")) == []


def test_a_run_that_sent_frames_without_its_files_is_bare() -> None:
    here = Path("x")
    case = run("r").case
    assert _is_bare(run("r"))
    assert _is_bare(StoredRun(case, [], here, None))
    assert _is_bare(StoredRun(case, [], None, here))
    assert not _is_bare(StoredRun(case, [], here, here))
    assert not _is_bare(run("r", frame_log_sha256=""))


def test_plans_are_named_with_the_begin_of_their_hashes() -> None:
    plans = [{"name": "p", "sha256": "0123456789abcdef"}, {"name": "q", "sha256": "f" * 64}]
    assert _names({"plans": plans}) == ["p (0123456789ab)", "q (ffffffffffff)"]
    assert _names({}) == []


# What is made of shares


@pytest.mark.parametrize("name", ["one", "two/../one", "./one", "{}/one"])
def test_a_folder_is_none_of_those_to_join_however_it_is_written(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before any of them is read."""
    (tmp_path / "two").mkdir()
    monkeypatch.chdir(tmp_path)
    into = Path(name.format(tmp_path))
    for folders in ([Path("one"), Path("two")], [Path("two"), tmp_path / "one"]):
        with pytest.raises(UserError, match="the folder to make is one of those to join") as e:
            merge(folders, into, started="now")
        assert e.value.file == str(into)


def test_the_manifest_has_all_parts_and_the_command_of_the_whole(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With its plans, and without what was of one share."""
    monkeypatch.setattr(sharing, "build_manifest", lambda plans, **given: {"plans": plans, **given})
    words = "axisrig run a.csv b.csv -k first --shard 1/2 -o part -j 4 --force -x"
    parts: Any = [
        SimpleNamespace(manifest={"command": text.split()}, folder=Path(name))
        for name, text in (("p1", words), ("p2", words.replace("1/2", "2/2")))
    ]
    assert sharing._manifest(parts, ["plans"], "then", Path("all")) == {  # type: ignore[list-item]
        "plans": ["plans"], "started": "then", "output": "all", "merged": ["p1", "p2"],
        "command": ["axisrig", "run", "a.csv", "b.csv", "-k", "first", "--force", "-o", "all"],
    }  # fmt: skip


def test_a_run_comes_with_its_own_probes_and_files(tmp_path: Path) -> None:
    """Of two searches in a folder, whose ids begin with each other."""
    names = ["s-s01.parquet", "s.blf", "s1.blf", "s1-s01.parquet", f"s{SEGMENT_MARK}can1.pcap"]
    for name in names:
        path = tmp_path / ("traces" if name.endswith("parquet") else "bus") / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    took: list[tuple[str, set[str], list[str]]] = []

    def take(case: Any, rows: Any, files: dict[Any, Path], probes: list[str]) -> None:
        assert rows == [f"rows of {case['run']}"]
        took.append((case["run"], {path.name for path in files.values()}, probes))

    def one(name: str, of: str = "") -> Any:
        return SimpleNamespace(
            run=name, is_probe=bool(of), case={"run": name, "probe": of}, rows=[f"rows of {name}"]
        )

    runs = [one("s-s01", "s"), one("s"), one("s1-s01", "s1"), one("s1"), one("s-s02", "s")]
    part: Any = SimpleNamespace(folder=tmp_path, runs=runs)
    sharing._take(SimpleNamespace(take=take), part, runs[1])  # type: ignore[arg-type]
    probes = ["s-s01", "s-s02"]
    assert took == [
        ("s-s01", {"s-s01.parquet"}, probes), ("s-s02", set(), probes),
        ("s", {"s.blf", f"s{SEGMENT_MARK}can1.pcap"}, probes),
    ]  # fmt: skip


def test_an_axisrig_of_others_is_named_by_the_begin_of_its_hash() -> None:
    def part(name: str, sign: str) -> Any:
        command = ["axisrig", "run", "a.csv"]
        plans = [{"name": "a", "sha256": "0" * 64}]
        manifest = {"command": command, "sources_sha256": sign * 64, "plans": plans}
        return SimpleNamespace(folder=Path(name), manifest=manifest)

    with pytest.raises(UserError, match="not of one campaign: other axisrig than one") as caught:
        sharing._refuse_strangers([part("one", "a"), part("two", "a"), part("three", "b")])
    error = caught.value
    assert (error.file, error.value, error.allowed) == ("three", "b" * 12, "a" * 12)
