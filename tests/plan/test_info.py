"""What was tested: from a rig and from the command line to cases.csv, JUnit and heading."""

from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest

from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter
from axisrig.bench.plan.info import info_of, parse_info, with_info
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.rig.reading.sources import info_of_rig
from axisrig.kernel.errors import UserError
from axisrig.reports.build import build_report


def test_words_of_the_command_line() -> None:
    assert parse_info(["serial=0042", "order= A=1 "]) == {
        "serial": "0042",
        "order": "A=1",
    }
    for wrong in ("serial", "=1", "Serial=1", "a b=1", "x= "):
        with pytest.raises(UserError, match="--info is key=value"):
            parse_info([wrong])


def test_a_rig_gives_its_table_with_that_of_its_base(tmp_path: Path) -> None:
    (tmp_path / "base.toml").write_text('[info]\ndevice = "A"\nserial = 1\n', encoding="utf-8")
    rig = tmp_path / "rig.toml"
    rig.write_text('base = "base.toml"\n[info]\nserial = 2\n', encoding="utf-8")
    assert info_of_rig(rig) == {"device": "A", "serial": 2}
    rig.write_text("no toml", encoding="utf-8")
    assert info_of_rig(rig) == {}


def test_it_is_in_every_result(tmp_path: Path) -> None:
    """Two rows with one device and different serial numbers; one of the columns is of both."""
    for name in ("p.nc", "r.toml"):
        (tmp_path / name).write_text("title = 'x'\n", encoding="utf-8")
    rows = "case,program,rig,check:alarms\na,p.nc,r.toml,none\nb,p.nc,r.toml,none\n"
    (tmp_path / "plan.csv").write_text(rows, encoding="utf-8")
    found = iter([{"device": "X", "serial": "1"}, {"device": "X", "serial": "2"}])
    plan = read_plan(tmp_path / "plan.csv").with_cases(lambda case: with_info(case, next(found)))
    manifest = build_manifest([plan], command=["axisrig"], started="", output="out")
    with ResultsWriter(tmp_path / "out", [plan], manifest) as writer:
        for case in plan.cases:
            writer.add(CaseResult(case, Verdict.PASS, []))
    runs = read_results(tmp_path / "out").runs
    assert [info_of(run.case) for run in runs] == [
        {"device": "X", "serial": "1"},
        {"device": "X", "serial": "2"},
    ]
    root = ElementTree.parse(tmp_path / "out" / "junit.xml").getroot()
    properties = [(p.get("name"), p.get("value")) for p in root.iter("property")]
    assert [pair for pair in properties if pair[0] in ("device", "serial")] == [
        *(("device", "X"), ("serial", "1")),
        *(("device", "X"), ("serial", "2")),
    ]
    page = build_report(tmp_path / "out").read_text(encoding="utf-8")
    assert "device: X<br>" in page
    assert "serial: 1 (1 run), 2 (1 run)<br>" in page


def test_a_case_without_it_stays_as_it_is() -> None:
    case = SimpleNamespace(notes={})
    assert with_info(case, {}) is case  # type: ignore[arg-type, comparison-overlap]
    run = SimpleNamespace(case={"info:a": "", "info:b": "1", "note:c": "2"})
    assert info_of(run.case) == {"b": "1"}
