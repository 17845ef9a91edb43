"""What a campaign does where the system lacks something: limits, drives of one tree, quotas."""

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign import cluster, worker
from axisrig.bench.campaign.older_packages import SIGNS, leftovers
from axisrig.bench.campaign.processes import usable_cores
from axisrig.bench.campaign.results import manifest
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import Limits
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.errors import UserError


@pytest.fixture
def case(write_plan: Callable[..., Path]) -> Case:
    (found,) = read_plan(write_plan("case,program,rig\na,probe.nc,machine.toml\n")).cases
    return found


def several_drives(*_: object) -> str:
    raise ValueError("Paths don't have the same drive")


def test_files_on_several_drives_are_none_for_a_cluster(
    case: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As Windows has them: there is no folder that has them all."""
    monkeypatch.setattr(cluster, "files_of_case", lambda one: [one.program, one.rig])
    monkeypatch.setattr(os.path, "commonpath", several_drives)
    with pytest.raises(UserError, match="the files of a run are on several drives") as caught:
        cluster._packed(case, RunFiles(), Limits(), None)  # type: ignore[arg-type]
    assert caught.value.file == str(case.file)
    assert caught.value.value == f"{os.path.abspath(case.program)}, {os.path.abspath(case.rig)}"  # noqa: PTH100


def test_a_file_on_another_drive_has_its_whole_name_in_a_manifest(
    case: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert set(manifest.file_hashes([case])) == {"probe.nc", "machine.toml"}
    rig = case.folder / "machine.toml"
    assert manifest._from_folder(rig, case.folder) == "machine.toml"
    assert manifest._from_folder(rig, case.folder / "below") == "../machine.toml"
    monkeypatch.setattr(os.path, "relpath", several_drives)
    assert manifest._from_folder(rig, case.folder) == rig.as_posix()


@pytest.mark.skipif(sys.platform == "win32", reason="has no resource")
def test_limits_of_a_process_are_those_that_the_system_knows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import resource  # noqa: PLC0415 - not on Windows

    names = {name for name in dir(resource) if name.startswith("RLIMIT_")}
    limits = {getattr(resource, name): number for number, name in enumerate(sorted(names), 1)}
    none = resource.RLIMIT_CORE

    def getrlimit(kind: int) -> tuple[int, int]:
        return (resource.RLIM_INFINITY if kind == none else limits[kind], 1 << 40)

    monkeypatch.setattr(resource, "getrlimit", getrlimit)
    found = dict(worker._limits())
    assert found.keys() == names
    assert found.pop("RLIMIT_CORE") == sys.maxsize
    assert all(found[name] == limits[getattr(resource, name)] for name in found)
    monkeypatch.setitem(sys.modules, "resource", None)
    assert worker._limits() == {}


@pytest.mark.parametrize(("count", "cores"), [(6, 6), (1, 1), (None, 1)])
def test_without_affinity_all_cores_count(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, count: int | None, cores: int
) -> None:
    """As on macOS and Windows; one where the system does not say how many there are."""
    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.setattr(os, "cpu_count", lambda: count)
    assert usable_cores(tmp_path / "missing") == cores


@pytest.mark.parametrize("text", ["", "max", "1 2 3", "many 100000", "100000 0", "100000 many"])
@pytest.mark.skipif(sys.platform != "linux", reason="affinity is of Linux")
def test_a_quota_that_cannot_be_read_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str
) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1, 2})
    (tmp_path / "cpu.max").write_text(text, encoding="ascii")
    assert usable_cores(tmp_path / "cpu.max") == 3


def test_a_folder_that_may_not_be_read_has_no_leftovers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    closed, open_ = tmp_path / "closed", tmp_path / "open"
    for folder in (closed, open_):
        (folder / "bench/rig").mkdir(parents=True)
        (folder / "bench" / "rig" / "machine.py").touch()
    is_file = Path.is_file

    def may_be_read(path: Path) -> bool:
        if closed in path.parents:
            raise PermissionError(13, "Permission denied", str(path))
        return is_file(path)

    monkeypatch.setattr(Path, "is_file", may_be_read)
    (text,) = leftovers([str(closed), str(open_)])
    assert text.startswith(f"{open_}: bench of an older axisrig")
    assert SIGNS["bench"] == "rig/machine.py"


def test_a_tree_that_another_worker_has_just_made_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two workers of one machine: the second one's copy goes, and what is there stays."""
    monkeypatch.setattr("platformdirs.user_cache_dir", lambda name: str(tmp_path / name))
    parcel: Any = type("Parcel", (), {"names": {"deep/a.nc": ("key", "/here/a.nc")}})
    replace = Path.replace

    def late(made: Path, tree: Path) -> Path:
        (tree / "deep").mkdir(parents=True)
        (tree / "deep" / "a.nc").write_bytes(b"of the first one")
        return replace(made, tree)  # a folder that is not empty is not replaced

    monkeypatch.setattr(Path, "replace", late)
    tree = cluster._tree(parcel, {"key": b"of the second one"})
    assert (tree / "deep" / "a.nc").read_bytes() == b"of the first one"
    assert [path.name for path in tree.parent.iterdir()] == [tree.name]
