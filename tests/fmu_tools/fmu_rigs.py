"""A rig around an FMU that is an axis, and a plan with several of them."""

from pathlib import Path

LISTS = Path(__file__).parents[2] / "testplans" / "rigs" / "lists"
RIG = """\
title = "one axis without a probe"

[channel]
list = "lists/channel.lst"

[segment.can1]
bitrate = 1_000_000

[drive.servo]
encoder_increments = 1_048_576
lead_mm = 10.0

[axis.Z]
list = "lists/axis-z.lst"
segment = "can1"
node = 3
drive = "servo"
plant = "z"

[plant.z]
fmu = "{fmu}"
"""
PROGRAM = "N10 G90 G1 Z131 F6000\nN20 M30\n"


def write_rig(place: Path, name: str, fmu: Path) -> str:
    """Write a rig with one axis without a probe into a folder that has its lists."""
    (place / name).write_text(RIG.format(fmu=fmu.as_posix()), encoding="utf-8")
    return name


def write_plan(place: Path, *rigs: str) -> str:
    """Write a plan with a row for each rig: `<name of the rig><number>`."""
    rows = [f"{Path(rig).stem}{number},move.nc,{rig},none" for number, rig in enumerate(rigs)]
    text = "\n".join(["case,program,rig,check:alarms", *rows, ""])
    (place / "plan.csv").write_text(text, encoding="utf-8")
    return "plan.csv"
