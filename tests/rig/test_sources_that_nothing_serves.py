"""`axisrig check` of a rig whose measuring signal (P-AXIS-00516) nothing can give."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.describe import describe_axes
from axisrig.bench.rig.settings import Settings

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
Read = Callable[..., Settings]


def _warnings(
    tmp_path: Path, settings_of: Read, base: str, source: str, more: str = ""
) -> list[str]:
    text = (RIGS / "lists/axis-z-fine.lst").read_text(encoding="utf-8")
    listed = text.replace(" DRIVE ", f" {source} ") + more
    (tmp_path / "z.lst").write_text(listed, encoding="utf-8")
    rig = tmp_path / "rig.toml"
    rig.write_text(
        f'base = "{(RIGS / base).as_posix()}"\ntitle = "a rig"\n[axis.Z]\nlist = "z.lst"\n',
        encoding="utf-8",
    )
    return [line for line in describe_axes(settings_of(rig)) if "measures with" in line]


@pytest.mark.parametrize(
    ("base", "source", "words"),
    [
        ("probe-z.toml", "PLC", "no PLC task: alarm 900400; plc:Z.probing_signal"),
        ("probe-z.toml", "PLC_TIMESTAMP", "no PLC task: alarm 900400"),
        ("probe-z.toml", "EXT_PROBE_WITH_DRIVE", "no PLC task: alarm 900400"),
        ("plc-io-node.toml", "PLC_TIMESTAMP", "no terminal with time stamps"),
        ("plc-radio.toml", "PLC_TIMESTAMP", "no terminal with time stamps"),
    ],
)
def test_a_source_that_nothing_serves_is_a_warning(
    tmp_path: Path, settings_of: Read, base: str, source: str, words: str
) -> None:
    (line,) = _warnings(tmp_path, settings_of, base, source)
    assert line.startswith(f"warning: axis Z measures with {source}")
    assert words in line


def test_what_is_served_or_not_used_is_none(tmp_path: Path, settings_of: Read) -> None:
    assert _warnings(tmp_path, settings_of, "plc-signal.toml", "PLC_TIMESTAMP") == []
    assert _warnings(tmp_path, settings_of, "probe-z.toml", "DRIVE") == []
    simulated = "meas_simu.meas_simu_mode 4\n"
    assert _warnings(tmp_path, settings_of, "probe-z.toml", "PLC", simulated) == []


@pytest.mark.long
@pytest.mark.parametrize("path", sorted(RIGS.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_rigs_serve_their_sources(settings_of: Read, path: Path) -> None:
    assert [line for line in describe_axes(settings_of(path)) if "measures with" in line] == []
