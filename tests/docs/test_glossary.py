"""One table of words for the report, the page and the README; what it names exists."""

import csv
import importlib.util
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from axisrig.bench.drive.cia402.dictionary.objects import object_rows
from axisrig.bench.drive.ethercat.objects import rows as ethercat_rows
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError
from axisrig.reports import glossary as module
from axisrig.reports.glossary import glossary

ROOT = Path(__file__).parents[2]
TABLE = ROOT / "docs" / "glossary.csv"
ROWS = list(csv.DictReader(TABLE.read_text("utf-8").splitlines()))
NAMES = [name for row in ROWS for name in row["term"].split(", ")]
TABLES = ROOT / "kernel" / "axisrig" / "kernel" / "parameters" / "tables"
# Words that the report prints beside plots, bars and tables
SHOWN = {"set", "actual", "truth", "offset", "CNC lag", "drive lag", "uncertainty", "closed form"}


def test_the_report_reads_this_table() -> None:
    assert glossary() == ROWS


def test_a_wheel_has_its_own_copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The packaged table comes first; a broken installation is one clear message."""
    monkeypatch.setattr(module.resources, "files", lambda _: tmp_path)
    monkeypatch.setattr(module, "CHECKOUT", tmp_path / "none")
    with pytest.raises(UserError, match=r"glossary\.csv is missing"):
        glossary()
    (tmp_path / "documents").mkdir()
    (tmp_path / "documents/glossary.csv").write_text(
        "term,meaning\nlatch,stored\n", encoding="utf-8"
    )
    assert glossary() == [{"term": "latch", "meaning": "stored"}]


@pytest.mark.long
def test_the_wheel_gets_the_table(tmp_path: Path) -> None:
    if importlib.util.find_spec("hatchling") is None:
        pytest.skip("hatchling not installed: make installs it")
    words = ["-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    done = subprocess.run(
        [sys.executable, *words], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        assert archive.read("axisrig/reports/documents/glossary.csv") == TABLE.read_bytes()
        names = {name.partition("/")[0] for name in archive.namelist()}
    assert {name for name in names if not name.endswith(".dist-info")} == {"axisrig"}


def test_every_term_is_there_once_and_in_order() -> None:
    assert sorted({name.lower() for name in NAMES}) == sorted(name.lower() for name in NAMES)
    terms = [row["term"] for row in ROWS]
    assert terms == sorted(terms, key=str.lower)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["term"])
def test_every_term_is_explained_in_both_languages(row: dict[str, str]) -> None:
    assert row["meaning"].endswith(".")
    assert row["german"].strip()


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["term"])
def test_objects_and_parameters_exist(row: dict[str, str]) -> None:
    entries = (*object_rows(), *ethercat_rows())
    objects = {f"{entry.index:04X}" for entry in entries} | {
        f"{entry.index:04X}:{entry.sub}" for entry in entries if entry.sub is not None
    }
    texts = "".join(path.read_text("utf-8") for path in TABLES.glob("*.csv"))
    known = objects | set(re.findall(r"^P-\w+-\d+", texts, re.MULTILINE))
    assert set(row["object"].split()) <= known


def test_the_words_of_the_report_are_terms() -> None:
    kinds = set(re.findall(r"`([a-z]+)`", Event.__doc__ or "")) - {"mark", "pdo"} | {"PDO"}
    verdicts = {verdict.word for verdict in Verdict} - {"pass", "fail"}
    assert (kinds | verdicts | SHOWN) - set(NAMES) == set()


def test_the_page_is_fresh() -> None:
    """Else: python docs/site/glossary_page.py."""
    path = ROOT / "docs" / "site" / "glossary_page.py"
    spec = importlib.util.spec_from_file_location("glossary_page", path)
    assert spec
    assert spec.loader
    maker = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(maker)
    assert (ROOT / "docs" / "glossary.md").read_text("utf-8") == maker.page()
