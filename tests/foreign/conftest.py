"""Stacks that nobody here wrote. Each is looked for and its tests are skipped where it is missing.

- the npm package `canopen` 6.2.1: `npm install --ignore-scripts canopen@6.2.1` in any folder, then
  NODE_PATH=<folder>/node_modules
- importers of FMUs: fmu_importers.py beside this file
- CANopenNode: AXISRIG_CANOPENNODE=<checkout of CANopenNode V4>, and a C compiler
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))  # the two folders beside this file are packages


@pytest.fixture(scope="session")
def node_js() -> str:
    """The program `node`, with the package in reach."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is missing")
    found = subprocess.run(
        [node, "-e", "require.resolve('canopen')"], check=False, capture_output=True
    )
    if found.returncode:
        pytest.skip("the npm package canopen is missing, see tests/foreign/conftest.py")
    return node


@pytest.fixture(scope="session")
def canopennode(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """CANopenNode as a shared library, with the drive of `canopennode/` around it."""
    checkout = os.environ.get("AXISRIG_CANOPENNODE", "")
    if not (Path(checkout) / "CANopen.c").is_file():
        pytest.skip("AXISRIG_CANOPENNODE names no checkout of CANopenNode")
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    from canopennode.slave import build  # noqa: PLC0415

    return build(Path(checkout), tmp_path_factory.mktemp("canopennode"), compiler)
