"""Readers of other makers and what we write for them: JUnit, packages (SSP) and FMUs.

Each is skipped where its reader is not installed, with the line that installs it.
"""

import zipfile
from pathlib import Path

import pytest
from fmpy.ssp.ssd import read_ssv

from axisrig.bench.campaign.results.junit import write_junit
from axisrig.bench.campaign.results.stored import Said, StoredRun
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.rig_export.package import export_rig

pytestmark = pytest.mark.long
RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z.toml"


def stored(run: str, verdict: str, value: str, line: str) -> StoredRun:
    case = {
        **{"plan": "touch", "case": run, "run": run, "verdict": verdict, "sim_s": "1"},
        **{"wall_s": "0.25", "seed": "1", "alarms": "", "frame_log_sha256": run},
        **{"line": line},
    }
    check = {
        **{"metric": "latch_mm", "value": value, "unit": "mm", "check": "<= 2", "note": ""},
        **{"lower": "", "upper": "2", "uncertainty": "0", "verdict": verdict},
    }
    return StoredRun(case, [check], None, None, Said(None, (), ()))


def test_junitparser_sees_counts_times_and_values(tmp_path: Path) -> None:
    reader = pytest.importorskip("junitparser", reason="pip install junitparser==5.0.3")
    runs = [
        *(stored("a", "pass", "1.5", "2"), stored("b", "fail", "2.5", "3")),
        *(stored("c & <d>", "pass", "-0.0", "4"), stored("e", "error", "", "5")),
    ]
    found = reader.JUnitXml.fromfile(str(write_junit(tmp_path, runs)))
    assert (found.tests, found.failures, found.errors, found.skipped) == (4, 1, 1, 0)
    assert found.time == 1.0
    (suite,) = found
    cases = {case.name: case for case in suite}
    assert list(cases) == ["a", "b", "c & <d>", "e"]
    values = {
        name: {one.name: one.value for one in case.child(reader.Properties)}
        for name, case in cases.items()
    }
    assert [values[name]["latch_mm.value"] for name in "ab"] == ["1.5", "2.5"]
    assert values["b"]["latch_mm.upper"] == "2"
    assert "0.5 mm above" in cases["b"].result[0].message


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("ssp") / "probe-z.ssp"
    export_rig(settings_of(RIG, []), target, "2.0")
    return target


def test_pyssp_standard_sees_the_element_and_its_connectors(package: Path, tmp_path: Path) -> None:
    """It writes a package anew when it closes it: a copy is what it gets."""
    pyssp = pytest.importorskip("pyssp_standard", reason="pip install pyssp_standard==0.9.1")
    copy = tmp_path / "copy.ssp"
    copy.write_bytes(package.read_bytes())
    with pyssp.SSP(str(copy)) as read, read.system_structure as structure:
        (element,) = structure.system.elements
        assert (element.name, element.source) == ("z", "resources/z.fmu")
        kinds = {one.name: one.kind for one in element.connectors}
        resources = set(read.resources)
    assert kinds["z_reference_position"] == "input"
    assert set(kinds.values()) == {"input", "output"}
    assert resources == {"z.fmu", "z.ssv"}


def test_pyssp_standard_sees_the_start_values(package: Path, tmp_path: Path) -> None:
    pyssp = pytest.importorskip("pyssp_standard", reason="pip install pyssp_standard==0.9.1")
    with zipfile.ZipFile(package) as opened:
        opened.extract("resources/z.ssv", tmp_path)
    path = tmp_path / "resources" / "z.ssv"
    with pyssp.SSV(str(path)) as values:
        names = {one["name"] for one in values.parameters}
    assert names == {one.name for one in read_ssv(str(path)).parameters}
    assert names


def test_fmureader_sees_every_variable_of_an_exported_fmu(package: Path, tmp_path: Path) -> None:
    reader = pytest.importorskip("fmureader.fmi", reason="pip install fmureader==0.1.2")
    import fmpy  # noqa: PLC0415  the other reader of the same file

    with zipfile.ZipFile(package) as opened:
        opened.extract("resources/z.fmu", tmp_path)
    path = tmp_path / "resources" / "z.fmu"
    read = reader.read_model_description(str(path))
    other = fmpy.read_model_description(str(path))
    assert {one.name for one in read.model_variables} == {one.name for one in other.modelVariables}
