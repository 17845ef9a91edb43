"""What the tests of two processes share: `both_sides.py` and two adapters on one line."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parent))

PAIR = Path(__file__).parents[3] / "tests" / "tools" / "slcan_pair.py"
LIMIT_S = 120.0


@pytest.fixture
def slcan_pair() -> Iterator[tuple[str, str, Any]]:
    """Two adapters on one bus: the names of their devices, and the process that plays them."""
    pytest.importorskip("serial")
    if not hasattr(os, "openpty"):
        pytest.skip("no pseudo-terminals here")
    process = subprocess.Popen(
        [sys.executable, str(PAIR)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    left, right = process.stdout.readline().split()
    yield left, right, process
    process.communicate(timeout=LIMIT_S)
