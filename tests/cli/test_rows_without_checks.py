"""What `axisrig check` says of a row that asks for nothing, or gives its program too little."""

from collections.abc import Callable
from pathlib import Path

Call = Callable[..., tuple[int, str, str]]


def _plan(place: Path, *rows: str, head: str = "case,program,rig") -> Path:
    path = place / "plan.csv"
    path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    return path


def test_a_row_without_a_check_is_named(place: Path, axisrig: Call) -> None:
    """Two rows, one of them with a check; the note is of the other one."""
    (place / "free.nc").write_text("N10 G1 Z120 F1000\nM30\n", encoding="utf-8")
    path = _plan(
        place, "a,free.nc,rig.toml,", "b,free.nc,rig.toml,<= 1", head="case,program,rig,check:x"
    )
    path.write_text(path.read_text("utf-8").replace("check:x", "check:lag_mm_max"), "utf-8")
    code, out, err = axisrig("check", path)
    assert code == 0, err
    notes = [line for line in out.splitlines() if "has no check" in line]
    assert notes == [f"note: {path}:2: case 'a' has no check: it passes unless an alarm comes up"]


def test_a_variable_that_no_column_gives_is_blamed_on_the_row_too(
    place: Path, axisrig: Call
) -> None:
    (place / "asks.nc").write_text("N10 G1 Z120 F=V.E.FEED\nM30\n", encoding="utf-8")
    code, _, err = axisrig("check", _plan(place, "a,asks.nc,rig.toml"))
    assert code == 2
    assert "V.E.FEED" in err
    assert "plan.csv:2 runs it (case 'a')" in err
