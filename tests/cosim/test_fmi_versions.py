"""Which releases of FMI are which version."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.fmu import fmi_version


@pytest.mark.parametrize(
    ("written", "version"),
    [
        ("2.0", "2.0"),
        ("2.0.4", "2.0"),
        ("2.1", "2.0"),
        ("3.0", "3.0"),
        ("3.0-beta.2", "3.0"),
        ("3.0.2", "3.0"),
        ("3.1", "3.0"),
        ("1.0", "1.0"),
        ("4.0", "4.0"),
        ("30.0", "30.0"),
    ],
)
def test_a_release_counts_as_the_first_of_its_major_number(written: str, version: str) -> None:
    description: Any = SimpleNamespace(fmiVersion=written)
    assert fmi_version(description) == version
