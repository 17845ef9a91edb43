"""Which files decide whether `--resume` keeps a run: each one that it reads, and no other."""

from pathlib import Path

import pytest

from axisrig.bench.campaign.resuming import depends_sha256, files_of_case
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan

HEAD = "case,program,rig,plc:program_start,check:alarms"
PROGRAM = "%L LOCAL\nN5 G1 Z131 F3000\nM29\n%MAIN\nN10 L sub.nc\nN20 LL LOCAL\nN30 M30\n"
FILES = {
    "part.nc": PROGRAM,
    "sub.nc": "N10 L deep.nc\nM29\n",
    "deep.nc": "N10 G90 G1 Z132 F3000\nM29\n",
    "started.nc": "N10 L far.nc\nN20 M30\n",
    "far.nc": "N10 G90 G1 Z133 F3000\nM29\n",
    "metrics.py": "",
    "beside.nc": "M30\n",
}
READ = (
    *("part.nc", "sub.nc", "deep.nc", "started.nc", "far.nc", "over.toml", "rig.toml"),
    *("lists/channel.lst", "lists/axis-z.lst"),
)


@pytest.fixture
def case(place: Path) -> Case:
    """A run with subprograms, a program that the PLC side starts, and a rig upon another one."""
    for name, text in FILES.items():
        (place / name).write_text(text, encoding="utf-8")
    (place / "over.toml").write_text('base = "rig.toml"\ntitle = "other"\n', encoding="utf-8")
    cell = "at=reset+100ms file=started.nc"
    (place / "plan.csv").write_text(f"{HEAD}\na,part.nc,over.toml,{cell},none\n", encoding="utf-8")
    (found,) = read_plan(place / "plan.csv").cases
    return found


def test_all_of_them_are_listed(place: Path, case: Case) -> None:
    found = {path.resolve().relative_to(place.resolve()).as_posix() for path in files_of_case(case)}
    assert {*READ} <= found
    assert not found & {"beside.nc", "plan.csv"}


@pytest.mark.parametrize("name", [*READ, "beside.nc"])
def test_a_file_that_a_run_reads_decides_whether_it_stays(
    place: Path, case: Case, name: str
) -> None:
    """Of a program also the subprograms that it can reach, of one that the PLC starts as well."""
    before = depends_sha256(case)
    path = place / name
    with path.open("a", encoding="utf-8") as file:
        file.write("# changed\n" if name.endswith((".toml", ".lst")) else "(changed)\n")
    now = depends_sha256(case)
    assert before
    assert now
    assert (now != before) == (name in READ)


@pytest.mark.parametrize("name", ["part.nc", "over.toml", "rig.toml", "sub.nc"])
def test_of_a_run_that_lacks_a_file_nothing_is_known(place: Path, case: Case, name: str) -> None:
    (place / name).unlink()
    assert depends_sha256(case) == ""
