"""Readers of other makers and our EDS: the objects that they see are those of our tables.

Skipped where a reader is not installed (pip install canmatrix, dcf-tools).
"""

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from axisrig.bench.drive.cia402.dictionary.eds import default_text, eds_text
from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.canopen.dictionary import read_eds

pytestmark = pytest.mark.long
NODE = 3
CANMATRIX = """
import json, sys, canmatrix.formats
(matrix,) = canmatrix.formats.loadp(sys.argv[1]).values()
print(json.dumps({frame.arbitration_id.id: frame.size for frame in matrix.frames}))
"""


@pytest.fixture
def eds(tmp_path: Path) -> Path:
    path = tmp_path / "drive.eds"
    path.write_text(eds_text(DriveProfile()), encoding="ascii", newline="\r\n")
    return path


def test_dcfchk_finds_nothing(eds: Path) -> None:
    if find_spec("dcf") is None:
        pytest.skip("dcf-tools is not installed (pip install dcf-tools)")
    run = "import sys; from dcf.cli import main; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-c", run, "-n", str(NODE), str(eds)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_canmatrix_sees_the_default_pdos(eds: Path) -> None:
    """Identifiers of the pre-defined connection set, lengths of the mappings (CiA 301)."""
    if find_spec("canmatrix") is None:
        pytest.skip("canmatrix is not installed (pip install canmatrix)")
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", CANMATRIX, str(eds)],
        capture_output=True,
        text=True,
        check=True,
    )
    found = {int(number): size for number, size in json.loads(done.stdout).items()}
    values = {key: default_text(row, DriveProfile()) for key, row in variables().items()}
    for mapping, base in ((0x1600, 0x200), (0x1A00, 0x180), (0x1A01, 0x280), (0x1A02, 0x380)):
        entries = [int(values[mapping, n], 0) for n in range(1, int(values[mapping, 0], 0) + 1)]
        assert found[base] == sum(entry & 0xFF for entry in entries) // 8


def test_our_own_reader_sees_every_object_of_the_tables(eds: Path) -> None:
    od = read_eds(str(eds), NODE)
    for (index, sub), row in variables().items():
        item = od.get_variable(index, sub)
        assert item is not None
        assert (item.data_type, item.access_type[:2]) == (row.data_type.code, row.access[:2])
