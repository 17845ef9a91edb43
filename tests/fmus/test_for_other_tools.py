"""What other tools take from an FMU: references, types, units, documents, terminals, sources."""

import shutil
import struct
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
import zlib
from pathlib import Path

import fmpy
import numpy as np
import pytest
from lxml import etree
from tests.small_fmus import small_fmu

from axisrig.bench.tools.fmu.release import courses, walk
from axisrig.fmus import CATALOGUE, FMI_VERSIONS, MODELS, ensure_built
from axisrig.kernel.cosim.fmi.archive import unpack
from axisrig.kernel.cosim.fmi.library import Capabilities, longest_internal_step_s

ROOT = Path(__file__).parents[2]
SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"
SMALL = """// A comment before everything
package Small
  connector WayInput = input Way "Of a type" annotation(Icon(graphics={Line()}));
  type Way = Real(quantity="Length", unit="m", displayUnit="mm", nominal=0.1);
  type Short = Way(min=0);
  model Plant "A model of somebody else"
    extends Drawn;
    WayInput u "Input";
    input Real w(unit="m") "Of no type";
    input Short s(unit="mm") "Of another unit than its type";
    output Short y "Output";
  equation
    y = abs(u + w) + s;
    annotation(experiment(StopTime=2, Interval=0.5, Tolerance=1e-5),
      Documentation(info="<html><p>Says \\"u\\" &amp; <b>y</b>.</p></html>"));
  end Plant;
  partial model Drawn
    annotation(Icon(graphics={
      Rectangle(extent={{-100,100},{100,-100}}, fillColor={255,0,0}, fillPattern=FillPattern.Solid),
      Ellipse(extent={{-50,50},{50,-50}}, fillColor={0,0,255}, fillPattern=FillPattern.Solid),
      Line(points={{-100,0},{100,0}}, color={0,255,0})}));
  end Drawn;
  annotation(version="7.1");
end Small;
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """An FMU of a library that is not ours, for each version."""
    folder = tmp_path_factory.mktemp("others") / "Small"
    folder.mkdir()
    (folder / "package.mo").write_text(SMALL, encoding="utf-8")
    return {fmi: small_fmu("Small.Plant", folder, fmi=fmi) for fmi in FMI_VERSIONS}


def root(fmu: Path) -> ET.Element:
    return ET.fromstring(zipfile.ZipFile(fmu).read("modelDescription.xml"))


every_model = pytest.mark.parametrize("model", MODELS)
both = pytest.mark.parametrize("fmi", FMI_VERSIONS)


@pytest.mark.long(but=1)
@both
@every_model
def test_references_count_from_1_in_the_order_of_the_variables(model: str, fmi: str) -> None:
    """Read as an index from 1 or as a reference, a number in the structure names one variable.

    OMSimulator reads dependencies of FMI 3.0 as indices.
    """
    described = root(ensure_built(model, fmi=fmi))
    variables = described.findall("ModelVariables/*")
    references = [int(v.attrib["valueReference"]) for v in variables]
    if fmi == "2.0":
        variables = described.findall("ModelVariables/ScalarVariable")
    assert references == list(range(1, len(variables) + 1))
    word = "index" if fmi == "2.0" else "valueReference"
    unknowns = described.findall(".//Unknown" if fmi == "2.0" else ".//Output")
    assert unknowns
    for unknown in unknowns:
        variable = variables[int(unknown.attrib[word]) - 1]
        assert variable.get("valueReference") == unknown.attrib[word]
        for number in map(int, unknown.get("dependencies", "").split()):
            assert variables[number - 1].get("causality") in ("input", "independent")


@every_model
def test_internal_step_is_no_promise_but_the_bench_knows_it(model: str) -> None:
    """The solver cuts its steps: importers took `fixedInternalStepSize` for an output grid."""
    for fmi in FMI_VERSIONS:
        fmu = ensure_built(model, fmi=fmi)
        assert "fixedInternalStepSize" not in root(fmu).find("CoSimulation").attrib
        folder = unpack(fmu)
        assert longest_internal_step_s(folder) == CATALOGUE[model].step_s
        description = fmpy.read_model_description(str(folder))
        assert Capabilities.of(description, folder).fixed_step_s == CATALOGUE[model].step_s


@every_model
def test_experiment_has_stop_step_and_tolerance(model: str) -> None:
    experiment = root(ensure_built(model)).find("DefaultExperiment").attrib
    assert float(experiment["stopTime"]) > float(experiment["startTime"])
    assert float(experiment["stepSize"]) >= 1e-4
    assert 0 < float(experiment["tolerance"]) <= 1e-4


@pytest.mark.long(but=1)
@both
@every_model
def test_every_variable_says_what_it_is(model: str, fmi: str) -> None:
    described = root(ensure_built(model, fmi=fmi))
    silent = [v.get("name") for v in described.find("ModelVariables") if not v.get("description")]
    assert silent == []


@both
def test_types_of_the_library_arrive_with_quantity_display_unit_and_nominal(fmi: str) -> None:
    description = fmpy.read_model_description(str(ensure_built(MODELS[1], fmi=fmi)))
    types = {t.name.rpartition(".")[2]: t for t in description.typeDefinitions}
    assert types["Velocity"].name == "AxisRig.Units.Velocity"
    for name, quantity, unit, shown in (
        ("Position", "Length", "m", "mm"),
        ("Velocity", "Velocity", "m/s", "mm/min"),
    ):
        found = types[name]
        assert (found.quantity, found.unit, found.displayUnit) == (quantity, unit, shown)
    assert float(types["Force"].nominal) == 1000
    units = {u.name: u for u in description.unitDefinitions}
    shown = {d.name: float(d.factor) for u in units.values() for d in u.displayUnits}
    assert shown["mm"] == 1000
    assert shown["mm/min"] == 60_000
    real = [v for v in description.modelVariables if v.type in ("Real", "Float64")]
    typed = {v.name: v.declaredType.name for v in real if v.declaredType}
    assert typed["reference_velocity"] == "AxisRig.Units.Velocity"
    assert len(typed) > 0.8 * len(real)


@both
def test_type_that_is_made_from_another_has_its_attributes(
    small: dict[str, Path], fmi: str
) -> None:
    description = fmpy.read_model_description(str(small[fmi]))
    variables = {v.name: v for v in description.modelVariables}
    assert variables["y"].declaredType.name == "Small.Short"
    assert variables["y"].declaredType.displayUnit == "mm"
    assert float(variables["y"].declaredType.nominal) == 0.1
    assert variables["u"].declaredType.name == "Small.Way"
    assert variables["w"].declaredType is None
    assert variables["s"].declaredType is None
    assert variables["s"].unit == "mm"


@both
def test_licence_is_inside_and_named(small: dict[str, Path], fmi: str) -> None:
    fmu = ensure_built(MODELS[0], fmi=fmi)
    attributes = root(fmu).attrib
    assert attributes["license"] == "Apache-2.0"
    assert {"author", "copyright", "version"} <= set(attributes)
    with zipfile.ZipFile(fmu) as archive:
        licences = "documentation/licenses/"
        assert archive.read(f"{licences}Apache-2.0.txt") == (ROOT / "LICENSE").read_bytes()
        assert b"Apache-2.0" in archive.read(f"{licences}license.txt")
        for name in archive.namelist():
            is_header = name.startswith("sources/fmi") and name.endswith(".h")
            if name.startswith("sources/") and not is_header and not name.endswith(".xml"):
                assert b"SPDX-License-Identifier: Apache-2.0" in archive.read(name)[:60], name
    with zipfile.ZipFile(small[fmi]) as archive:  # what somebody else wrote is not ours to license
        assert not {"license", "author", "copyright"} & set(root(small[fmi]).attrib)
        assert root(small[fmi]).get("version") == "7.1"
        assert b"SPDX" not in archive.read("sources/Small_Plant.c")
        assert b"its author" in archive.read(f"{licences}license.txt")


@every_model
def test_page_has_the_documentation_of_the_class_and_all_that_can_be_set(model: str) -> None:
    fmu = ensure_built(model)
    page = zipfile.ZipFile(fmu).read("documentation/index.html").decode()
    text = " ".join(etree.fromstring(page, etree.HTMLParser()).itertext())
    assert "Source:" in text
    for variable in root(fmu).find("ModelVariables"):
        if variable.get("causality") in ("input", "output", "parameter"):
            assert f"<td>{variable.get('name')}</td>" in page


def test_page_escapes_names_and_keeps_the_html_of_the_class(small: dict[str, Path]) -> None:
    page = zipfile.ZipFile(small["3.0"]).read("documentation/index.html").decode()
    assert '<p>Says "u" &amp; <b>y</b>.</p>' in page
    assert "<h1>Small.Plant</h1>\n<p>A model of somebody else</p>" in page


def pixels(png: bytes) -> np.ndarray:
    """Red, green, blue and cover of an 8-bit picture, shape (height, width, 4)."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    chunks, at = {}, 8
    while at < len(png):
        (size,) = struct.unpack_from(">I", png, at)
        kind, body = png[at + 4 : at + 8], png[at + 8 : at + 8 + size]
        assert struct.unpack_from(">I", png, at + 8 + size)[0] == zlib.crc32(kind + body)
        chunks[kind], at = body, at + 12 + size
    width, height = struct.unpack_from(">II", chunks[b"IHDR"])
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, 4 * width + 1)
    assert not rows[:, 0].any()
    return rows[:, 1:].reshape(height, width, 4)


@both
def test_icon_is_the_one_that_the_classes_draw(small: dict[str, Path], fmi: str) -> None:
    name = "model.png" if fmi == "2.0" else "terminalsAndIcons/icon.png"
    picture = pixels(zipfile.ZipFile(small[fmi]).read(name))
    height, width, _ = picture.shape
    assert list(picture[height // 8, width // 8]) == [255, 0, 0, 255]
    assert list(picture[height // 2 - height // 8, width // 2]) == [0, 0, 255, 255]
    red, green, _, _ = picture[height // 2, width // 8]
    assert green > red  # the line
    own = pixels(zipfile.ZipFile(ensure_built(MODELS[0], fmi=fmi)).read(name))
    assert len(np.unique(own.reshape(-1, 4), axis=0)) > 1


@every_model
def test_terminals_follow_the_schema_and_name_variables(model: str) -> None:
    with zipfile.ZipFile(ensure_built(model)) as archive:
        found = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        etree.XMLSchema(file=str(SCHEMAS / "fmi3TerminalsAndIcons.xsd")).assertValid(found)
        description = etree.fromstring(archive.read("sources/buildDescription.xml"))
        etree.XMLSchema(file=str(SCHEMAS / "fmi3BuildDescription.xsd")).assertValid(description)
    names = {v.get("name") for v in root(ensure_built(model)).find("ModelVariables")}
    members = found.findall(".//TerminalMemberVariable")
    assert members
    assert {member.get("variableName") for member in members} <= names


def test_edges_of_a_probe_fit_the_terminal_that_stamps_them() -> None:
    def members(model: str) -> set[str]:
        with zipfile.ZipFile(ensure_built(model)) as archive:
            found = ET.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        (edges,) = found.findall(".//Terminal[@name='edges']")
        assert edges.get("matchingRule") == "plug"
        return {member.attrib["memberName"] for member in edges}

    probe = members("AxisRig.Sensors.TouchProbe")
    assert probe == members("AxisRig.Sensors.DigitalInput")
    assert len(probe) == 5


@pytest.mark.long(but=1)
@pytest.mark.skipif(sys.platform != "linux", reason="the plain call of cc is that of Linux")
@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no system cc")
@both
@every_model
def test_library_that_a_user_compiles_from_the_sources_gives_the_same_numbers(
    model: str, fmi: str, tmp_path: Path
) -> None:
    fmu = ensure_built(model, fmi=fmi)
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(tmp_path / "unpacked")
    (library,) = (tmp_path / "unpacked" / "binaries").rglob("*.so")
    built = tmp_path / "self.so"
    command = f"cc -shared -fPIC -o {built} *.c -lm"
    subprocess.run(["sh", "-c", command], cwd=tmp_path / "unpacked" / "sources", check=True)
    assert built.read_bytes() != library.read_bytes()
    built.replace(library)
    own = shutil.make_archive(str(tmp_path / "self"), "zip", tmp_path / "unpacked")
    foreign = Path(own).rename(tmp_path / "self.fmu")
    results = [np.array(walk(p, courses()[model], 1_000_000, 1000)[1]) for p in (fmu, foreign)]
    span = np.ptp(results[0], axis=0)
    assert (np.abs(results[1] - results[0]) <= 1e-12 * span).all()
