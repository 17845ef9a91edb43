from axisrig.bench.campaign.pytest_plugin import pytest_addoption  # noqa: F401
