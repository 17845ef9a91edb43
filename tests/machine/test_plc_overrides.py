"""Overrides that a PLC program gives and takes back, of the path and of an axis on it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

MS = 1_000_000
BODY = """class Program:
    def cycle(self, inputs, hli):
        self.since = getattr(self, "since", None)
        if hli.ve.get("GO", 0) and self.since is None:
            self.since = inputs.time_ns
        age_ms = 0 if self.since is None else (inputs.time_ns - self.since) // 1_000_000
        path, axis = hli.ch.override, hli.ax["Z"].lr_mc_control.override
        path.enable_w = 100 <= age_ms < 200 or 500 <= age_ms < 600
        path.command_w = 500 if age_ms < 300 else 250
        axis.enable_w = 300 <= age_ms < 400 or 700 <= age_ms < 800
        axis.command_w = 500 if age_ms < 500 else 250
"""


@pytest.mark.long
def test_an_override_that_is_not_enabled_any_more_is_given_back(
    tmp_path: Path, run_nc: Callable[..., Any]
) -> None:
    """Path, axis, path, axis: each 100 ms at 1/2 and 100 ms at 1/4, which cost 50 and 75 ms.

    What a ramp down gains the ramp up after it loses; an instant of the PLC, each 2 ms, acts in the
    next NC cycle.
    """
    (tmp_path / "plc.py").write_text(BODY, encoding="utf-8")
    took_ms = []
    for keys in ("", '[plc]\nprogram = "plc.py"\nperiod_us = 2000\n'):
        out = run_nc("N10 V.E.GO = 1\nN20 G1 Z116 F1200", keys, "plc:V.E.GO=0", base="probe-z.toml")
        assert out.alarms == []
        took_ms.append((out.facts.end_ns - out.facts.start_ns) / MS)
    assert took_ms[1] - took_ms[0] == pytest.approx(2 * (50 + 75), abs=2)
