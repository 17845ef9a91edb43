"""The tables of docs/coordinates.md are those of the kernel."""

from pathlib import Path

from kernel.nc.coordinates.lists import TOOLS, ZERO_OFFSETS, forms
from kernel.nc.coordinates.places import PLANES

PAGE = Path("docs/coordinates.md").read_text(encoding="utf-8")


def _rows(first: str) -> list[list[str]]:
    """The rows of the page whose first cell begins so."""
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in PAGE.splitlines()
        if line.startswith("|")
    ]
    return [row for row in rows if row[0].startswith(first)]


def test_every_name_of_the_lists_stands_in_the_page() -> None:
    acts = {"yes": "yes", "ignored": "no, ignored"}
    expected = [
        [
            form.number,
            f"`{form.path}`",
            form.unit,
            acts.get(form.acts, f"only {form.acts}"),
            form.meaning,
        ]
        for name in (ZERO_OFFSETS, TOOLS)
        for form in forms(name).values()
    ]
    assert _rows("P-") == expected


def test_the_planes_of_the_page() -> None:
    expected = [
        [
            plane.g,
            "XYZ"[plane.first],
            "XYZ"[plane.second],
            "XYZ"[plane.third],
            f"{'IJK'[plane.first]}, {'IJK'[plane.second]}",
        ]
        for plane in PLANES.values()
    ]
    assert _rows("G1") == expected
