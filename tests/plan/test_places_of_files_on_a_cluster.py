"""Where a worker of a cluster puts the files of a case: by their names and what is in them."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import platformdirs
import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import cluster
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import Limits, no_stopwatch

CONTENTS = {"k1": b"one", "k2": b"two"}


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(platformdirs, "user_cache_dir", lambda _: str(tmp_path / "cache"))
    return tmp_path / "cache"


def tree(**keys: str) -> Path:
    parcel: Any = SimpleNamespace(names={name: (key, f"/x/{name}") for name, key in keys.items()})
    return cluster._tree(parcel, CONTENTS)


@pytest.mark.parametrize(
    "other",
    [{"a": "k2", "b": "k1"}, {"a": "k1", "c": "k2"}, {"a": "k1"}, {"a": "k1", "b": "k1"}],
)
def test_files_with_other_names_or_contents_are_in_a_folder_of_their_own(
    cache: Path, other: dict[str, str]
) -> None:
    """Also where two files have changed their places."""
    first, second = tree(a="k1", b="k2"), tree(**other)
    assert first != second
    for folder, keys in ((first, {"a": "k1", "b": "k2"}), (second, other)):
        assert folder.is_relative_to(cache)
        found = {path.name: path.read_bytes() for path in folder.iterdir()}
        assert found == {name: CONTENTS[key] for name, key in keys.items()}


def test_the_order_of_the_names_does_not_matter(cache: Path) -> None:
    assert tree(a="k1", b="k2") == tree(b="k2", a="k1")
    assert len(list((cache / "cluster").iterdir())) == 1


@pytest.mark.parametrize(
    ("folder", "program"),
    [("plans", "programs/part.nc"), ("plans/deep", "plans/part.nc"), (".", "part.nc")],
)
def test_nothing_of_a_case_is_outside_of_what_travels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: str, program: str
) -> None:
    """Also the folder of a plan with none of the files in it."""
    path = tmp_path / program
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()
    monkeypatch.setattr(cluster, "files_of_case", lambda _: [path])
    case = case_of("a", path, program=path)
    case = replace(case, file=tmp_path / folder / "p.csv", folder=tmp_path / folder)
    parcel, _ = cluster._packed(case, RunFiles(), Limits(), no_stopwatch)
    moved = (parcel.case.program, parcel.case.rig, parcel.case.file, parcel.case.folder)
    assert not [one for one in moved if ".." in one.parts or one.is_absolute()]
    assert list(parcel.names) == [str(parcel.case.program)]
