"""The compiled build does what the interpreted one does: every shipped run, and fault scenarios.

`make fast` makes the compiled build; without it, or when it is of other sources, these tests are
skipped. What they compare does not come from either: a run of one against the same run of the
other, byte by byte.
"""

import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PLANS = sorted((ROOT / "testplans").glob("*.csv"))
COMPILED = ROOT / ".venv-fast/bin/python"
SCENARIOS, BLOCK = 1000, 50
HASHES = Path(__file__).with_name("scenario_hashes.py")
POSES = Path(__file__).with_name("kinematics_hashes.py")

pytestmark = pytest.mark.long


def _output(python: Path, *words: object) -> str:
    ended = subprocess.run(
        [str(python), *map(str, words)], cwd=ROOT, capture_output=True, text=True, check=False,
        env={key: value for key, value in os.environ.items() if not key.startswith("PYTHON")},
    )  # fmt: skip
    assert ended.returncode in (0, 1), ended.stdout + ended.stderr  # 1: a row fails
    return ended.stdout


@cache
def _build(python: Path) -> tuple[bool, str]:
    """Whether a build is compiled, and the hash of its sources."""
    program = (
        "import json; from axisrig.bench.campaign.results import build_info as b;"
        " print(json.dumps([b.is_compiled(), b.sources_sha256()]))"
    )
    is_compiled, sources = json.loads(_output(python, "-c", program))
    return is_compiled, sources


@pytest.fixture(scope="module")
def builds() -> tuple[Path, Path]:
    """Return the interpreters of the interpreted and of the compiled build."""
    interpreted = Path(sys.executable)
    if not COMPILED.exists():
        pytest.skip("there is no compiled build: make fast")
    if _build(COMPILED)[1] != _build(interpreted)[1]:
        pytest.skip("the compiled build is of other sources: make fast")
    assert [_build(interpreted)[0], _build(COMPILED)[0]] == [False, True]
    return interpreted, COMPILED


def _files(folder: Path) -> dict[str, bytes]:
    """What a campaign leaves of its runs, without what contains wall time."""
    kept = [folder / "results.csv"]
    for room in ("bus", "runs", "traces"):
        kept += (folder / room).iterdir()
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(kept)}


@pytest.mark.parametrize("plan", PLANS, ids=lambda path: path.stem)
def test_every_shipped_run_leaves_the_same_bytes(
    builds: tuple[Path, Path], plan: Path, tmp_path: Path
) -> None:
    results = []
    for name, python in zip(("interpreted", "compiled"), builds, strict=True):
        folder = tmp_path / name
        _output(python, "-m", "axisrig.bench.cli", "run", plan, "-o", folder)
        results.append(_files(folder))
    interpreted, compiled = results
    assert len(interpreted) > 3
    assert interpreted.keys() == compiled.keys()
    assert [name for name in interpreted if interpreted[name] != compiled[name]] == []


@pytest.mark.parametrize("first", range(0, SCENARIOS, BLOCK))
def test_fault_scenarios_are_the_same(builds: tuple[Path, Path], first: int) -> None:
    interpreted, compiled = (_output(python, HASHES, first, BLOCK) for python in builds)
    assert len(interpreted.splitlines()) == BLOCK
    assert interpreted == compiled


def test_kinematics_give_the_same_bits(builds: tuple[Path, Path]) -> None:
    interpreted, compiled = (_output(python, POSES, 1000) for python in builds)
    assert len(interpreted.splitlines()) > 5
    assert interpreted == compiled
