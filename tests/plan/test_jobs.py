"""How many processes a campaign takes when nobody says so."""

import os
import sys
from pathlib import Path

import pytest

from axisrig.bench.campaign.processes import usable_cores

QUOTAS = [("max 100000", 8), ("150000 100000", 1), ("300000 100000", 3), ("50000 100000", 1),
          ("1600000 100000", 8)]  # fmt: skip


@pytest.mark.skipif(sys.platform != "linux", reason="affinity and cgroups are of Linux")
@pytest.mark.parametrize(("text", "cores"), QUOTAS)
def test_cores_are_bound_by_affinity_and_quota(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, cores: int
) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)))
    file = tmp_path / "cpu.max"
    file.write_text(f"{text}\n")
    assert usable_cores(file) == cores


@pytest.mark.skipif(sys.platform != "linux", reason="affinity and cgroups are of Linux")
def test_without_a_quota_the_affinity_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 5})
    assert usable_cores(tmp_path / "missing") == 2
