"""Makes every table in this folder a plan that pytest runs: `pytest testplans/`."""

from pathlib import Path

import pytest

from axisrig.bench.campaign.pytest_plugin import PlanFile, collect_plan, pytest_addoption

__all__ = ["pytest_addoption"]


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> PlanFile | None:
    return collect_plan(file_path, parent, Path(__file__).parent)
