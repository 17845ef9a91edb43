"""Which axisrig runs: interpreted or compiled, and the hash of its sources."""

import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from axisrig.bench.campaign.results import build_info
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.plan.plan import read_plan

PLAN = Path(__file__).parents[2] / "testplans/latch_accuracy.csv"


@pytest.mark.parametrize(
    ("file", "word"),
    [
        ("a/clock.py", "interpreted"),
        ("a/clock.cpython-311-x86_64-linux-gnu.so", "compiled"),
    ],
)
def test_the_kernel_says_what_it_runs_as(
    file: str, word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(build_info, "clock", SimpleNamespace(__file__=file))
    assert build_info.build_word() == word
    assert build_info.is_compiled() is (word == "compiled")


def test_both_builds_have_one_hash(tmp_path: Path) -> None:
    """Several roots as in a checkout, one as installed, there with what a compiler made."""
    checkout, installed = tmp_path / "checkout", tmp_path / "installed/axisrig"
    for root in (checkout / "kernel/axisrig", checkout / "bench/axisrig", installed):
        for name in ("kernel/time.py", "bench/table.csv"):
            if root == installed or name.startswith(root.parent.name):
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(name, encoding="utf-8")
    for name in (
        "kernel/time.cpython-311.so",
        "kernel/__pycache__/time.pyc",
        "reports/documents/glossary.csv",
    ):
        (installed / name).parent.mkdir(parents=True, exist_ok=True)
        (installed / name).write_text("made", encoding="utf-8")
    roots = [checkout / "kernel/axisrig", checkout / "bench/axisrig"]
    whole = build_info.hash_of_sources(roots)
    assert re.fullmatch("[0-9a-f]{64}", whole)
    assert build_info.hash_of_sources([installed]) == whole
    (installed / "kernel/time.py").write_text("edited", encoding="utf-8")
    assert build_info.hash_of_sources([installed]) != whole


def test_the_manifest_says_what_made_a_campaign() -> None:
    manifest = build_manifest([read_plan(PLAN)], command=[], started="", output="")
    assert manifest["compiled"] is build_info.is_compiled()
    assert manifest["sources_sha256"] == build_info.sources_sha256()
