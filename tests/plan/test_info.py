"""What was tested: from a rig and from the command line to cases.csv, JUnit and heading."""

import csv
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import pytest

from axisrig.bench.campaign.pytest_plugin import CaseItem, Outcome, PlanFile
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter
from axisrig.bench.campaign.tested import with_tested
from axisrig.bench.cli.pytest_results import ResultsOfPytest
from axisrig.bench.plan.expanded import expanded_text
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


@pytest.mark.long
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


def test_a_plan_that_is_written_out_says_nothing_of_what_its_rigs_say(tmp_path: Path) -> None:
    """It is a plan again, with the same runs; the rig has the rest when it is run."""
    (tmp_path / "p.nc").write_text("N10 M30\n", encoding="utf-8")
    (tmp_path / "r.toml").write_text("[info]\ndevice = 'drill'\n", encoding="utf-8")
    text = "case,program,rig,note:part,check:alarms\na,p.nc,r.toml,17,none\n"
    (tmp_path / "plan.csv").write_text(text, encoding="utf-8")
    plan = with_tested(read_plan(tmp_path / "plan.csv"), {"serial": "7"})
    (case,) = plan.cases
    assert case.notes == {"note:part": "17", "info:device": "drill", "info:serial": "7"}
    (tmp_path / "again.csv").write_text(expanded_text(plan), encoding="utf-8")
    (again,) = with_tested(read_plan(tmp_path / "again.csv")).cases
    assert again.notes == {"note:part": "17", "info:device": "drill"}
    assert (again.case, again.seed, again.inputs) == (case.case, case.seed, case.inputs)


def test_a_case_without_it_stays_as_it_is() -> None:
    case = SimpleNamespace(notes={})
    assert with_info(case, {}) is case  # type: ignore[arg-type, comparison-overlap]
    run = SimpleNamespace(case={"info:a": "", "info:b": "1", "note:c": "2"})
    assert info_of(run.case) == {"b": "1"}


def test_rows_that_pytest_runs_say_what_their_rig_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in `axisrig run`, which goes on with their results; each row with its own rig."""
    (tmp_path / "p.nc").write_text("N10 M30\n", encoding="utf-8")
    for name in ("x", "y"):
        rig = f'[machine]\n[info]\ndevice = "{name}"\n'
        (tmp_path / f"{name}.toml").write_text(rig, encoding="utf-8")
    text = "case,program,rig,check:alarms\na,p.nc,x.toml,none\nb,p.nc,y.toml,none\n"
    (tmp_path / "plan.csv").write_text(text, encoding="utf-8")
    monkeypatch.setattr(
        CaseItem, "from_parent", classmethod(lambda _, __, **given: SimpleNamespace(**given))
    )
    file: Any = SimpleNamespace(path=tmp_path / "plan.csv")
    cases = [item.case for item in PlanFile.collect(file)]
    assert [case.notes for case in cases] == [{"info:device": "x"}, {"info:device": "y"}]

    found = ResultsOfPytest(SimpleNamespace(rootpath=tmp_path), tmp_path / "out")  # type: ignore[arg-type]
    found.pytest_xdist_node_collection_finished(["plan.csv::plan-a", "plan.csv::plan-b"])
    for case in cases:
        packed = Outcome(tmp_path, CaseResult(case, Verdict.PASS, []), {}).packed()
        found.pytest_runtest_logreport(SimpleNamespace(axisrig_outcome=packed))  # type: ignore[arg-type]
    rows = csv.DictReader((tmp_path / "out" / "cases.csv").read_text(encoding="utf-8").splitlines())
    assert [row["info:device"] for row in rows] == ["x", "y"]
