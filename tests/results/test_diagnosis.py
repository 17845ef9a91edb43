"""`axisrig export --diagnosis`: the sections of FCT-M3 12.10."""

from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAM = """%d
N10 V.G.WZ_AKT.L = 80
N20 #TRAFO ON
N30 #DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]
N40 #DIST CTRL DRYRUN [MODE=MCS]
N50 M30
"""


@pytest.mark.long
def test_the_diagnosis_data_begin_with_what_releases_the_control(
    tmp_path: Path, axisrig: Callable[..., tuple[int, str, str]]
) -> None:
    """Figure 55, then figure 56 at each change and at the end."""
    (tmp_path / "d.nc").write_text(PROGRAM, encoding="utf-8")
    rig = (ROOT / "testplans/rigs/distance-5axis.toml").as_posix()
    plan = f"case,program,rig,check:alarms\none,d.nc,{rig},none\n"
    (tmp_path / "d.csv").write_text(plan, encoding="utf-8")
    out = tmp_path / "out"
    assert axisrig("run", tmp_path / "d.csv", "-o", out)[0] == 0
    assert axisrig("export", out, "--diagnosis")[0] == 0
    (path,) = (out / "export").glob("*.diag_data.txt")
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "DECODER : CONFIGURATION CHANNEL-NO.: 1"
    assert lines[1].split() == ["configuration.decoder.function", "FCT_3D_DIST_CTRL"]
    assert lines[2].startswith("# SYNC ")
    assert lines[3] == "Distance Control:"
    assert lines[4].split() == ["zstd:", "INACTIVE(0)"]
    assert sum(line == "Dist-Ctrl Interface:" for line in lines) >= 3
    assert "  new_mode:               MCS(3)" in lines
