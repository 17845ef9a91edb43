"""`axisrig drive --interface ecat` of a SERCOS rig under the service channel of SOEM, in C.

SOEM is of somebody else and not in this checkout: AXISRIG_SOEM names a checkout of its version
1.4.0 (2.0.0 breaks off in its own call that reads an ident). Skipped without it, without a C
compiler, and without network namespaces.
"""

import os
import shutil
import struct
import subprocess
from pathlib import Path

import pytest
from tests.ethercat.foreign import ROOT, has_namespace, with_drives

SOURCE = Path(__file__).parent / "masters" / "soe.c"
RIG = ROOT / "testplans" / "rigs" / "probe-z-sercos.toml"
PREOP, SAFEOP, SOE = 2, 4, 0x10
pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def master(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The few lines of C, linked with SOEM."""
    if not has_namespace():
        pytest.skip("no network namespaces here (unshare -n, ip, veth)")
    compiler, checkout = shutil.which("cc"), os.environ.get("AXISRIG_SOEM", "")
    if compiler is None:
        pytest.skip("no C compiler")
    if not (Path(checkout) / "soem" / "ethercatsoe.c").is_file():
        pytest.skip("AXISRIG_SOEM names no checkout of SOEM 1.4.0")
    folders = [Path(checkout) / folder for folder in ("soem", "osal", "osal/linux", "oshw/linux")]
    sources = [str(path) for folder in folders for path in sorted(folder.glob("*.c"))]
    built = tmp_path_factory.mktemp("soem") / "soe"
    words = [compiler, "-w", str(SOURCE), *sources, *(f"-I{folder}" for folder in folders)]
    words += ["-lpthread", "-lrt", "-o", str(built)]
    subprocess.run(words, check=True)
    return built


def test_soem_reads_and_writes_idents_and_makes_its_image(master: Path, tmp_path: Path) -> None:
    """Telegrams of the rig: MDT word and S-0-0047, AT word and S-0-0051, as at power on."""
    found, printed = with_drives(RIG, tmp_path / "out", [str(master), "v0"], 60)
    said: dict[str, list[list[str]]] = {}
    for line in found.stdout.splitlines():
        key, *values = line.split()
        said.setdefault(key, []).append(values)
    print(found.stdout, printed, sep="\n")
    assert said["slaves"] == [["1"]]
    assert int(said["mailbox"][0][0]) == SOE
    assert [int(said[key][0][0]) for key in ("preop", "safeop")] == [PREOP, SAFEOP]
    ((_, _, name),) = said["name"]
    assert bytes.fromhex(name)[4:] == b"Probe control"
    ((_, _, attribute),) = said["attribute"]
    (word,) = struct.unpack("<I", bytes.fromhex(attribute))
    assert word >> 16 & 3 == 1 + 1  # four bytes
    assert not word >> 18 & 1  # no list
    assert [row[1:] for row in said["probe"]] == [["4", "00000000"]] * 2
    assert [row[1:] for row in said["control"]] == [["2", "0000"], ["2", "0100"]]
    assert [int(said[key][0][0]) > 0 for key in ("write", "back", "refused")] == [True, True, False]
    assert said["before"] == said["between"] == [["0", "0000"]]
    # SOEM has the code of a refused read only: that of a write is a frame it did not expect (1)
    assert said["after"] == [["1", "0001"]]
    assert said["unknown"] == [["1", "1001"]]
    assert said["image"] == [["48", "48"]]
