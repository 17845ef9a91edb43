"""The table of homing methods in docs/homing.md is that of the drive."""

from pathlib import Path

from axisrig.bench.drive.cia402.functions.homing_methods import METHODS

PAGE = Path("docs/homing.md").read_text(encoding="utf-8")
WAYS = {1: "up", -1: "down", 0: "-"}


def test_every_method_stands_in_the_page_as_it_is() -> None:
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in PAGE.splitlines()
        if line.startswith("|") and line.strip("|").split("|")[0].strip().lstrip("-").isdigit()
    ]
    message = {int(row[0]): row[1:] for row in rows if len(row) == 7}
    assert list(message) == list(METHODS)
    for number, method in METHODS.items():
        has_edge = method.switch in ("negative", "positive", "home")
        level = ("on" if method.level else "off") if has_edge else "-"
        assert message[number] == [
            method.switch,
            WAYS[method.search],
            WAYS[method.approach],
            level,
            "yes" if method.zero_pulse else "no",
            method.home,
        ]
