"""Files that decide whether `--resume` keeps a run and `judge` its recording: all that it reads."""

from pathlib import Path

import pytest

from axisrig.bench.campaign import rejudge
from axisrig.bench.campaign.results.case_files import files_of_case
from axisrig.bench.campaign.results.manifest import file_hashes, file_texts
from axisrig.bench.campaign.resuming import depends_sha256
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.errors import UserError

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


def test_the_manifest_has_hash_and_text_of_each_of_them(place: Path, case: Case) -> None:
    for found in (file_hashes([case]), file_texts([case])):
        assert {*READ} <= {*found}
        assert not {*found} & {"beside.nc", "plan.csv"}
    assert file_texts([case])["deep.nc"] == FILES["deep.nc"]


def test_a_program_that_cannot_be_read_is_in_the_manifest_without_what_it_calls(
    place: Path, case: Case
) -> None:
    """Its run says why; the manifest of the others is written all the same."""
    (place / "part.nc").write_text("N10 L sub.nc\nN20 G1 Z[\n", encoding="utf-8")
    found = file_hashes([case])
    assert {"part.nc", "started.nc", "rig.toml", "lists/axis-z.lst"} <= {*found}
    assert "sub.nc" not in found


@pytest.mark.parametrize("name", ["sub.nc", "deep.nc", "far.nc", "started.nc"])
def test_a_recording_is_that_of_the_subprograms_as_they_were(
    place: Path, case: Case, name: str
) -> None:
    """Where the plan lies does not count; folders of before have no hashes of subprograms."""
    row, hashes = {"program": "part.nc", "rig": "over.toml"}, file_hashes([case])
    moved = {at if at in row.values() else f"old/{at}": one for at, one in hashes.items()}
    of_before = {at: one for at, one in hashes.items() if at not in ("sub.nc", "deep.nc", "far.nc")}
    for known in (hashes, moved, of_before):
        rejudge._check_files(row, case, known)
    with (place / name).open("a", encoding="utf-8") as file:
        file.write("(changed)\n")
    for known in (hashes, moved):
        with pytest.raises(UserError, match=f"{name} has other content"):
            rejudge._check_files(row, case, known)
