"""Plans of very many rows: all are read before the first run, and built as they come."""

from collections.abc import Callable
from pathlib import Path

import pytest
from cli_plan import HEADER

from axisrig.bench.campaign import preparing, runner
from axisrig.bench.campaign.processes import CALL_LIMIT_S
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import prepare_all, run_case
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError

Call = Callable[..., tuple[int, str, str]]

COUNT = preparing.WHOLE_MAX + 20
BITRATE = "bus:can1.bitrate"


def _plan(place: Path, bitrates: dict[int, str], feed: str = "3000") -> Path:
    """A plan of two kinds of rows; bitrates: by number of the row, else that of the rig."""
    head = HEADER.replace("check:msg", f"{BITRATE},check:msg", 1)
    rows = [
        f"r{n},part.nc,rig.toml,{feed if n == COUNT - 1 else 1000 + n},{bitrates.get(n, '')},== 1,"
        for n in range(COUNT)
    ]
    path = place / "many.csv"
    path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    return path


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """What machines were built before a run."""
    preparing.forget()
    made: list[object] = []

    def machine(*words: object) -> Machine:
        made.append(words)
        return Machine(*words)  # type: ignore[arg-type]

    monkeypatch.setattr(preparing, "Machine", machine)
    return made


def _prepare(path: Path) -> None:
    prepare_all(read_plan(path).cases, apart=(), call_limit_s=CALL_LIMIT_S)


@pytest.mark.long
def test_of_many_rows_the_machine_of_each_kind_is_built(
    place: Path, axisrig: Call, built: list[object]
) -> None:
    _prepare(_plan(place, {3: "1000000", 50: "1000000"}))
    assert len(built) == 2
    code, out, _ = axisrig("check", place / "many.csv")
    assert code == 0
    assert f"note: the machine of 2 rows was built, of the other {COUNT - 2} as they run" in out
    assert len(built) == 2  # they are known


@pytest.mark.long
def test_of_a_common_plan_every_machine_is_built(place: Path, built: list[object]) -> None:
    path = _plan(place, {})
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join(lines[: preparing.WHOLE_MAX + 1]), encoding="utf-8")
    _prepare(path)
    assert len(built) == preparing.WHOLE_MAX


@pytest.mark.long
def test_a_cell_of_the_last_row_is_refused_before_anything_runs(place: Path, axisrig: Call) -> None:
    path = _plan(place, {COUNT - 1: "fast"}, feed="much")
    with pytest.raises(UserError, match=f"many.csv:{COUNT + 1}"):
        _prepare(path)
    for command in ("check", "run"):
        code, _, err = axisrig(command, path)
        assert code == 2
        assert err.startswith(f"error: {path}:{COUNT + 1}:")
    assert not (place / "out").exists()


@pytest.mark.parametrize("jobs", [1, 2])
def test_all_mistakes_are_found_in_order_whatever_reads_them(
    place: Path, monkeypatch: pytest.MonkeyPatch, jobs: int
) -> None:
    """Two wrong cells far apart, rows read in pieces by several processes."""
    monkeypatch.setattr(runner, "CHUNK", 30)
    path = _plan(place, {COUNT - 1: "fast", 40: "slow"})
    with pytest.raises(UserError) as caught:
        prepare_all(read_plan(path).cases, apart=(), call_limit_s=CALL_LIMIT_S, jobs=jobs)
    found = (caught.value, *caught.value.further)
    assert [error.line for error in found] == [42, COUNT + 1]


@pytest.mark.long
def test_what_only_a_machine_shows_is_the_error_of_its_row(place: Path) -> None:
    """A bus too slow for its telegrams: its neighbours have good ones."""
    cases = read_plan(_plan(place, {3: "1000000", 90: "125000"})).cases
    prepare_all(cases, apart=(), call_limit_s=CALL_LIMIT_S)
    bad = run_case(cases[90], RunFiles())
    assert bad.verdict is Verdict.ERROR
    assert bad.error is not None
    assert "can1" in bad.error
    assert run_case(cases[COUNT - 1], RunFiles()).verdict is Verdict.PASS


@pytest.mark.long
def test_rigs_lists_and_programs_are_read_once_and_again_when_they_change(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    preparing.forget()
    read: list[Path] = []
    monkeypatch.setattr(preparing, "read_rig", _noting(read, preparing.read_rig))
    monkeypatch.setattr(preparing, "read_program", _noting(read, preparing.read_program))
    cases = read_plan(_plan(place, {})).cases
    for case in cases:
        preparing.read_case(case)
    assert [path.name for path in read] == ["rig.toml", "part.nc"]
    values = [preparing.read_case(case).settings.external["FEED"] for case in cases[:3]]
    assert values == [1000.0, 1001.0, 1002.0]
    for name in ("rig.toml", "part.nc"):
        text = (place / name).read_text(encoding="utf-8")
        (place / name).write_text(text.replace("kv = 40", "kv = 41") + "\n", encoding="utf-8")
        preparing.read_case(cases[0])
    assert [path.name for path in read[2:]] == ["rig.toml", "part.nc"]
    lists = place / "lists" / "axis-z.lst"
    lists.write_text(lists.read_text(encoding="utf-8") + "kenngr.nothing 1\n", encoding="utf-8")
    with pytest.raises(UserError, match="unknown axis parameter"):
        preparing.read_case(cases[0])


def _noting(read: list[Path], function: Callable[..., object]) -> Callable[..., object]:
    def noted(path: Path, *words: object) -> object:
        read.append(path)
        return function(path, *words)

    return noted
