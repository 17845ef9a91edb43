"""A results folder of two runs, and the command line called inside this process."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.cli.main import main

ROOT = Path(__file__).parents[2]
HEAD = "case,program,rig,plc:V.E.FEED,plant:probe.pretravel_um,check:latch_error_um,check:msg:N30"
ROWS = (
    "slow,programs/probe-z.nc,rigs/probe-z.toml,600,,<= 1,== 1",
    "fast,programs/probe-z.nc,rigs/probe-z.toml,3000,5,>= -1,== 1",
)


@pytest.fixture(scope="session")
def folder_of_results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of two runs, of which one fails."""
    place: Path = tmp_path_factory.mktemp("loaded")
    for name in ("programs", "rigs"):
        shutil.copytree(ROOT / "testplans" / name, place / name)
    (place / "touch.csv").write_text("\n".join([HEAD, *ROWS, ""]), encoding="utf-8")
    with pytest.raises(SystemExit):
        main(["run", str(place / "touch.csv"), "-o", str(place / "out")])
    return place / "out"


@pytest.fixture
def axisrig(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    def call(*words: object) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as ended:
            main([str(word) for word in words])
        said = capsys.readouterr()
        return int(ended.value.code or 0), said.out, said.err

    return call
