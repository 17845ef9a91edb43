"""Plans as the tests of the command line write them."""

from pathlib import Path

HEADER = "case,program,rig,plc:V.E.FEED,check:msg:N30,check:alarms"


def write_plan(place: Path, *rows: str, name: str = "plan.csv") -> str:
    (place / name).write_text("\n".join([HEADER, *rows, ""]), encoding="utf-8")
    return name
