"""CAN identifiers have one home: `kernel/profiles/canopen/identifiers.csv`."""

import io
import tokenize

import pytest
from tests.architecture.sources import MODULES

from axisrig.kernel.profiles.canopen.identifiers import services

HOMES = ("axisrig.kernel.profiles.canopen", "axisrig.bench.bus.can")
# Identifiers that a scenario lets an intruder use; a flag of ZIP files
ELSEWHERE = {
    "axisrig.bench.tools.scenarios.scenario": {0x081, 0x182, 0x300, 0x7FF, 0x001, 0x07F},
    "axisrig.kernel.cosim.fmi.archive": {0x400},
}


def hexadecimal(text: str) -> set[int]:
    """Return the numbers of three digits that a module writes; 0x80 is a byte."""
    words = tokenize.generate_tokens(io.StringIO(text).readline)
    found = [word.string.lower() for word in words if word.type == tokenize.NUMBER]
    return {int(word, 16) for word in found if word.startswith("0x") and len(word) == 5}


@pytest.mark.long
def test_no_identifier_is_written_elsewhere() -> None:
    known = {number for s in services() for number in (s.first, s.node_base) if number}
    for module, path in MODULES.items():
        if not f"{module}.".startswith(tuple(f"{home}." for home in HOMES)):
            numbers = hexadecimal(path.read_text(encoding="utf-8"))
            wrong = {f"{n:#05x}" for n in numbers & known - ELSEWHERE.get(module, set())}
            assert wrong == set(), module


def test_a_number_in_a_comment_or_text_is_none() -> None:
    assert hexadecimal('X = 0x180  # 0x200\nY = "0x280", 0x80, 0x1000\n') == {0x180}
