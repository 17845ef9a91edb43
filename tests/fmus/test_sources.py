"""The hash of files that an FMU depends on follows their names and contents, and nothing else."""

import shutil

import pytest

from axisrig.fmus.sources import files_below, files_named, hash_of


@pytest.fixture
def folder(tmp_path):
    """Two files that count, one beside them, one that was compiled."""
    root = tmp_path / "library"
    for name in ("package.mo", "inside/Axis.mo", "inside/readme.txt", "__pycache__/Axis.mo"):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(f"text of {name}", encoding="utf-8")
    return root


def key(folder):
    return hash_of(files_below(folder, (".mo",)))


def test_only_files_with_the_endings_count(folder):
    assert [name for name, *_ in files_below(folder, (".mo",))] == ["inside/Axis.mo", "package.mo"]
    before = key(folder)
    (folder / "inside" / "readme.txt").write_text("longer than before, and longer", "utf-8")
    assert key(folder) == before


@pytest.mark.parametrize("change", ["longer", "renamed", "moved", "deleted", "new"])
def test_every_change_gives_another_hash(folder, change):
    before, file = key(folder), folder / "inside" / "Axis.mo"
    if change == "longer":
        file.write_text("another text that is longer", encoding="utf-8")
    elif change == "renamed":
        file.rename(file.with_name("Bxis.mo"))
    elif change == "moved":
        file.rename(folder / "Axis.mo")
    elif change == "deleted":
        file.unlink()
    else:
        (folder / "New.mo").write_text("", encoding="utf-8")
    assert key(folder) != before


def test_the_place_of_the_folder_does_not_count(folder, tmp_path):
    other = tmp_path / "other"
    shutil.copytree(folder, other)
    assert key(other) == key(folder)


def test_single_files_count_by_name_and_content(folder):
    paths = [folder / "package.mo", folder / "inside" / "Axis.mo"]
    assert [name for name, *_ in files_named(paths)] == ["package.mo", "Axis.mo"]
    assert hash_of(files_named(paths)) != hash_of(files_named(paths[:1]))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ({"a": "bc", "d": ""}, {"a": "b", "cd": ""}),
        ({"a": "bc"}, {"ab": "c"}),
        ({"a": "1", "b": "2"}, {"a": "2", "b": "1"}),
        ({"a": "1", "b": ""}, {"a": "1"}),
    ],
)
def test_names_and_contents_do_not_run_into_one_another(tmp_path, one, other):
    """The same letters in other places are other files."""
    found = []
    for place, files in (("one", one), ("other", other)):
        (tmp_path / place).mkdir()
        for name, text in files.items():
            (tmp_path / place / name).write_text(text, encoding="utf-8")
        found.append(hash_of(files_named([tmp_path / place / name for name in files])))
    assert found[0] != found[1]
    assert len(found[0]) == 32
