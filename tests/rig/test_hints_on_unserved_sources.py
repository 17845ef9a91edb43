"""What is advised for a measuring signal that nothing of a rig gives, and whom it concerns."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.describe import describe_axes
from axisrig.bench.rig.settings import Settings

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z.toml"
Read = Callable[..., Settings]


@pytest.mark.parametrize(
    ("source", "has_columns"),
    [
        ("PLC", True),
        ("PLC_FIRST_EVENT", True),
        ("PLC_TIMESTAMP", False),
        ("PLC_EXT_LATCH_CONTROL", False),
        ("EXT_PROBE_WITH_DRIVE", False),
    ],
)
@pytest.mark.parametrize("measures", [1, 0])
def test_a_column_serves_a_signal_and_no_hardware(
    settings_of: Read, source: str, has_columns: bool, measures: int
) -> None:
    """An axis that may not measure (P-AXIS-00118) needs no signal."""
    settings = settings_of(
        RIG, f"set:Z.kenngr.measure.signal={source}", f"set:Z.kenngr.messachse={measures}"
    )
    hint = "; plc:Z.probing_signal of a plan serves it" if has_columns else ""
    expected = f"warning: axis Z measures with {source} and the rig has no PLC task: alarm 900400"
    found = [line for line in describe_axes(settings) if "measures with" in line]
    assert found == ([f"{expected}{hint}"] if measures else [])
