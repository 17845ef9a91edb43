"""FMUs by OpenModelica: what it is asked, what comes of its answers. The compiler is a stand-in."""

import subprocess
import zipfile
from pathlib import Path

import pytest

from axisrig.fmus import openmodelica
from axisrig.fmus.openmodelica import build_with_omc, omc_identity
from axisrig.fmus.reading.errors import BuildError


class Omc:
    """Writes what it is to write; notes its words and its script."""

    def __init__(self, patch, code=0, printed="", content="archive"):
        self.code, self.printed, self.content = code, printed, content
        self.commands, self.script = [], ""
        patch.setattr(openmodelica.shutil, "which", lambda name: f"/bin/{name}")
        patch.setattr(openmodelica.subprocess, "run", self.run)

    def run(self, command, *, cwd, **_):
        self.commands.append(command)
        if cwd is not None:
            self.script = (cwd / "build.mos").read_text(encoding="utf-8")
            name = self.script.split('fileNamePrefix="')[1].split('"')[0]
            if self.content == "archive":
                with zipfile.ZipFile(cwd / f"{name}.fmu", "w") as made:
                    made.writestr("modelDescription.xml", "<x/>")
            elif self.content:
                (cwd / f"{name}.fmu").write_text(self.content, encoding="utf-8")
        return subprocess.CompletedProcess(command, self.code, self.printed, "")


@pytest.mark.parametrize("is_folder", [True, False])
def test_a_model_is_built_from_its_library_or_its_file(is_folder, tmp_path, monkeypatch):
    omc = Omc(monkeypatch)
    library = tmp_path / "Lib" if is_folder else tmp_path / "Own.mo"
    if is_folder:
        library.mkdir()
    else:
        library.touch()
    path = tmp_path / "cache" / "own.fmu"
    assert build_with_omc("Lib.Own", path, library, "2.0") == path
    assert zipfile.is_zipfile(path)
    assert omc.commands == [["/bin/omc", "build.mos"]]
    entry = library / "package.mo" if is_folder else library
    assert f'loadFile("{entry.as_posix()}")' in omc.script
    assert 'buildModelFMU(Lib.Own, version="2.0", fmuType="cs"' in omc.script
    assert list(path.parent.iterdir()) == [path]  # nothing beside it


@pytest.mark.parametrize(
    ("code", "printed", "content", "message"),
    [
        (1, 'true\n"[a.mo:3:1-3:4:writable] Error: no class X\n"', "archive", "no class X"),
        (0, '"Error: first\nError: second"', "", "first"),
        (0, "one\nthe last\n\n", "no archive", "the last"),
        (0, "", "no archive", "no FMU and no message"),
    ],
)
def test_what_is_no_fmu_is_an_error_and_the_one_of_before_stays(
    code, printed, content, message, tmp_path, monkeypatch
):
    Omc(monkeypatch, code, printed, content)
    path = tmp_path / "own.fmu"
    path.write_text("before", encoding="utf-8")
    with pytest.raises(BuildError, match=f"OpenModelica says: {message}$") as caught:
        build_with_omc("Own", path, Path("Own.mo"), "3.0")
    assert caught.value.file == "Own.mo"
    assert path.read_text(encoding="utf-8") == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_without_the_compiler_its_name_is_in_the_error(monkeypatch):
    omc = Omc(monkeypatch, printed=" OpenModelica 1.24\n")
    assert omc_identity() == "OpenModelica 1.24"
    assert omc.commands == [["/bin/omc", "--version"]]
    monkeypatch.setattr(openmodelica.shutil, "which", lambda _: None)
    with pytest.raises(BuildError, match="omc is not on the PATH"):
        omc_identity()
