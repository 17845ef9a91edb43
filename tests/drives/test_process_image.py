"""Where the values of each slave are in the process image of a segment."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.ethercat.image import Image, bytes_of, codec_of, objects_of
from axisrig.kernel.drives.ethercat.settings import Pdo, RegisterInputs
from axisrig.kernel.drives.mapped import MappedObject


def pdo(*bits: int) -> Pdo:
    return Pdo(0x1600, tuple(MappedObject(0x2000 + n, 0, b, False, "") for n, b in enumerate(bits)))


def slave(outputs: list[Pdo], inputs: list[Pdo]) -> Any:
    return SimpleNamespace(outputs=outputs, inputs=inputs)


@pytest.mark.parametrize(
    ("pdos", "size"),
    [
        ([], 0),
        ([pdo(1)], 1),
        ([pdo(8)], 1),
        ([pdo(9)], 2),
        ([pdo(16, 32)], 6),
        ([pdo(16, 32, 3)], 7),
        ([pdo(4), pdo(4)], 1),  # they lie bit behind bit
        ([pdo(4), pdo(5)], 2),
    ],
)
def test_a_started_byte_counts_and_the_codec_takes_as_many(pdos: list[Pdo], size: int) -> None:
    assert bytes_of(pdos) == size
    assert codec_of(objects_of(pdos)).size == size


def test_outputs_then_inputs_then_mailboxes_then_registers() -> None:
    """Two drives and a wire terminal: each part begins where the one before ends."""
    image = Image(
        [slave([pdo(16, 32)], [pdo(16, 32, 4)]), slave([pdo(12)], [pdo(8), pdo(1)])],
        [RegisterInputs(axis="X", node_id=3, first=0x9B0, size=8),
         RegisterInputs(axis="Y", node_id=4, first=0x9B0, size=4)],
    )  # fmt: skip
    first, second = image.places
    assert (first.outputs, first.output_bytes) == (0, 6)
    assert (second.outputs, second.output_bytes) == (6, 2)
    assert (first.inputs, first.input_bytes) == (8, 7)
    assert (second.inputs, second.input_bytes) == (15, 2)
    assert (first.mailbox, second.mailbox) == (17, 18)
    assert image.registers == [19, 27]
    assert image.size == 31
    assert image.counter == 2 * 3 + 2 * 1  # LRW: 3 for outputs and inputs, 1 for inputs alone
