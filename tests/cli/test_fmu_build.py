"""`axisrig fmu build`: options, several models at once, what is refused."""

import hashlib
import sys
from pathlib import Path

import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.cross_check.validate_vendor_repo import validate_test_fmu
from fmpy.util import read_csv

from axisrig.bench.tools.fmu import library, release
from axisrig.fmus import CATALOGUE, MODELS
from axisrig.kernel.errors import UserError

SOME = MODELS[-2:]  # those that build fastest


@pytest.fixture
def own_cache(tmp_path, monkeypatch):
    """A cache folder of this test alone."""
    monkeypatch.setattr("platformdirs.user_cache_dir", lambda name: str(tmp_path))
    return tmp_path / "fmus"


@pytest.fixture
def two_models(monkeypatch):
    """A library of two models."""
    monkeypatch.setattr(library, "MODELS", SOME)


@pytest.mark.long
@pytest.mark.usefixtures("two_models")
def test_all_models_are_built_in_their_order_and_then_taken_from_the_cache(own_cache):
    first = list(library.build_models(None))
    assert [built.model for built in first] == list(SOME)
    stamps = {path.name: path.stat().st_mtime_ns for path in own_cache.glob("*.fmu")}
    assert len(stamps) == len(SOME)
    assert list(library.build_models(None)) == first
    assert {path.name: path.stat().st_mtime_ns for path in own_cache.glob("*.fmu")} == stamps


@pytest.mark.usefixtures("two_models")
def test_a_model_may_be_called_by_its_last_name_as_everywhere():
    last_name = SOME[0].rpartition(".")[2]
    assert list(library.build_models(last_name)) == list(library.build_models(SOME[0]))


@pytest.mark.long  # the command below prints a path for each version
@pytest.mark.usefixtures("two_models")
def test_versions_lie_side_by_side(own_cache):
    three = list(library.build_models(SOME[0]))
    two = list(library.build_models(SOME[0], fmi=["2.0"]))
    assert three != two
    assert len(list(own_cache.glob("*.fmu"))) == 2


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("AxisRig.Drives.ServoAxs",), "AxisRig.Drives.ServoAxis"),
        ((None, ["2"]), "2.0"),
        ((None, ["3.0"], ["x86_64-linus"]), "x86_64-linux"),
        ((None, ["3.0"], (), "gcc"), "cc, zig, omc"),
    ],
)
def test_unknown_words_are_refused_with_the_nearest(arguments, text):
    with pytest.raises(UserError) as error:
        list(library.build_models(*arguments))
    assert text in str(error.value)


@pytest.mark.usefixtures("two_models", "own_cache")
def test_each_build_gets_version_platforms_and_compiler(monkeypatch):
    asked = []

    def run_apart(function, tasks, **_):
        assert function is library.ensure_built
        asked.extend(tasks)
        return iter(Path(name) for name, *_ in tasks)

    monkeypatch.setattr(library, "run_apart", run_apart)
    built = list(library.build_models(SOME[0], ["2.0", "3.0"], ["x86_64-linux"], "cc"))
    assert [(one.model, one.fmi) for one in built] == [(SOME[0], "2.0"), (SOME[0], "3.0")]
    assert [[*task] for task in asked] == [
        [SOME[0], None, fmi, ["x86_64-linux"], "cc"] for fmi in ("2.0", "3.0")
    ]


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="the compiler is a script with a first line")
@pytest.mark.usefixtures("two_models", "own_cache")
def test_failed_build_of_another_process_is_told(tmp_path, monkeypatch):
    compiler = tmp_path / "cc"
    compiler.write_text("""#!/bin/sh
case "$1" in
    --version|-dumpmachine) echo broken 1.0 ;;
    *) echo "x.c:1: error: no way" >&2; exit 1 ;;
esac
""")
    compiler.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UserError, match=f"{SOME[0]} cannot be built: .*: error: no way"):
        list(library.build_models(None))


def test_list_shows_every_model_with_its_step_and_title_and_where_fmus_lie(own_cache):
    *lines, empty, place = library.listing().splitlines()
    assert (empty, place) == ("", f"built FMUs are in {own_cache}")
    assert len(lines) == len(CATALOGUE)
    for line, row in zip(lines, CATALOGUE.values(), strict=True):
        name, rest = line.split(maxsplit=1)
        step, unit, built, title = rest.split(maxsplit=3)
        assert (name, title) == (row.name, row.title)
        assert (float(step) * 1e-6, unit, built) == (pytest.approx(row.step_s), "us", "-")


def test_command_takes_version_platform_and_compiler(axisrig):
    code, _, err = axisrig("fmu", "build", SOME[0], "--fmi", "1.0")
    assert (code, "no such FMI version" in err) == (2, True)
    code, _, err = axisrig("fmu", "build", SOME[0], "--platform", "amiga", "--compiler", "cc")
    assert (code, "no such platform" in err) == (2, True)
    for place in ((), ("--out", "releases")):
        code, _, err = axisrig("fmu", "build", SOME[0], "--compiler", "tcc", *place)
        assert (code, "no such compiler" in err, "'tcc'" in err) == (2, True, True)
    code, _, err = axisrig("fmu", "build", SOME[0], "--all")
    assert (code, "--all is every model" in err) == (2, True)


def test_command_prints_a_path_for_each_model_and_version(axisrig):
    code, out, err = axisrig("fmu", "build", SOME[0], "--fmi", "2.0", "--fmi", "3.0")
    assert (code, err) == (0, "")
    versions = [read_model_description(line).fmiVersion for line in out.splitlines()]
    assert versions == ["2.0", "3.0"]


# --- releases ----------------------------------------------------------------------------------


def sums(folder):
    """Checksums of the file SHA256SUMS by name."""
    lines = (folder / "SHA256SUMS").read_text(encoding="utf-8").splitlines()
    return {name: digest for digest, name in (line.split("  ") for line in lines)}


@pytest.mark.usefixtures("two_models")
@pytest.mark.long
def test_release_has_what_the_rules_of_the_cross_check_ask_for(tmp_path, axisrig):
    """Judged by fmpy's validation of FMUs for the FMI cross-check."""
    words = ("--all", "--fmi", "2.0", "--fmi", "3.0", "-o", tmp_path / "a")
    code, out, _ = axisrig("fmu", "build", *words)
    *fmus, last = map(Path, out.splitlines())
    assert (code, len(fmus), last.name) == (0, 2 * len(SOME), "SHA256SUMS")
    for fmu in fmus:
        assert validate_test_fmu(str(fmu.parent)) == []
        kinds = {path.name.removeprefix(fmu.stem) for path in fmu.parent.iterdir()}
        assert kinds == {".fmu", "_in.csv", "_ref.csv", "_ref.opt"}
    found = sums(tmp_path / "a")
    assert set(found) == {
        path.relative_to(tmp_path / "a").as_posix()
        for path in (tmp_path / "a").rglob("*.*")
        if path.is_file()
    }
    for name, digest in found.items():
        content = (tmp_path / "a" / name).read_bytes()
        assert hashlib.sha256(content).hexdigest() == digest
    again = list(release.release_models(tmp_path / "b", None, ["2.0", "3.0"]))
    assert len(again) == len(fmus) + 1
    assert sums(tmp_path / "b") == found


@pytest.mark.long
def test_importer_that_reads_the_inputs_of_a_release_gets_its_reference(tmp_path):
    """fmpy as the importer, with the inputs as they change during the run."""
    model = "AxisRig.Sensors.DigitalInput"
    fmu, _ = release.release_models(tmp_path, model, ["3.0"])
    reference = read_csv(f"{fmu.with_suffix('')}_ref.csv")
    names = list(reference.dtype.names[1:])
    found = simulate_fmu(
        str(fmu), stop_time=1.0, step_size=1e-3, output_interval=1e-3, output=names,
        input=read_csv(f"{fmu.with_suffix('')}_in.csv"),
    )  # fmt: skip
    assert len(found) == len(reference) == 1001
    assert reference["level"].any()
    for name in names:
        assert (found[name] == reference[name]).all(), name
