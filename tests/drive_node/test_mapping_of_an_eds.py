"""Which objects of the model a PDO carries where the EDS of a maker says otherwise."""

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.drive_node.test_drive_by_eds import NODE, OFF, aborted, foreign
from tests.eds_changes import changed

from axisrig.bench.drive.canopen.node import Document
from axisrig.kernel.drives.canopen.dictionary import read_eds

NOT_MAPPABLE = 0x06040041


def mapped(
    make: Callable[..., Any], folder: Path, entry: int, communication: int, **keys: str
) -> int:
    """Map an object of a file with these keys of its section; return the abort code, 0 for none."""
    path = folder / "foreign.eds"
    path.write_text(changed(foreign(), f"{entry >> 16:04X}", **keys), encoding="ascii")
    bench = make(document=Document(read_eds(str(path), NODE), path.read_bytes()))
    sdo = bench.remote.sdo
    cob_id = (0x380 if communication >= 0x1800 else 0x300) + NODE
    sdo.download(communication, 1, struct.pack("<I", OFF | cob_id))
    sdo.download(communication + 0x200, 0, b"\x00")
    data = struct.pack("<I", entry)
    if keys.get("PDOMapping") == "0" or entry >> 16 < 0x2000:
        return aborted(lambda: sdo.download(communication + 0x200, 1, data))
    sdo.download(communication + 0x200, 1, data)
    return 0


@pytest.mark.parametrize(("mapping", "code"), [("0", NOT_MAPPABLE), ("1", 0)])
@pytest.mark.parametrize(
    ("entry", "communication"),
    [(0x6064_0020, 0x1802), (0x6041_0010, 0x1802), (0x607A_0020, 0x1401)],
)
def test_an_object_is_in_pdos_where_its_file_says_so(
    drive_bench: Any, tmp_path: Path, entry: int, communication: int, mapping: str, code: int
) -> None:
    """PDOMapping of the file, though the model could carry it."""
    assert mapped(drive_bench, tmp_path, entry, communication, PDOMapping=mapping) == code


def test_a_telegram_carries_nothing_that_the_model_has_no_place_for(
    drive_bench: Any, tmp_path: Path
) -> None:
    """1000, the type of the device, is a number of the dictionary alone."""
    keys = {"PDOMapping": "1", "AccessType": "rwr"}
    assert mapped(drive_bench, tmp_path, 0x1000_0020, 0x1802, **keys) == NOT_MAPPABLE
