"""A bus log in words: logs written out by hand, and what an engineer reads of them."""

from collections.abc import Callable
from pathlib import Path

import pytest

Call = Callable[..., tuple[int, str, str]]
Tell = Callable[..., list[str]]


@pytest.fixture
def tell(place: Path, axisrig: Call) -> Tell:
    """Write frames `ms id#data` of can1 as a candump log and have them told."""

    def told(frames: str, *options: str) -> list[str]:
        lines = [
            f"({float(ms) / 1e3:.6f}) can1 {frame} R"
            for ms, frame in (line.split() for line in frames.split("\n") if line.strip())
        ]
        (place / "some.log").write_text("\n".join(lines) + "\n", encoding="utf-8")
        code, out, err = axisrig("bus", "some.log", *options)
        assert (code, err) == (0, "")
        return out.splitlines()

    return told


def test_every_boot_up_and_every_new_nmt_state_is_told(tell: Tell) -> None:
    """The second boot-up is a reset in the middle; a toggle bit of node guarding is no news."""
    lines = tell("""
        0.1 703#00
        5 703#05
        6 703#85
        7 703#05
        8 703#7F
        9 703#00
        10 703#00
        11 704#00
    """)
    assert [line.split(maxsplit=4)[-1] for line in lines] == [
        "boot-up", "operational", "pre-operational", "boot-up", "boot-up", "boot-up",
    ]  # fmt: skip
