"""From the files of a machine to a green plan, as docs/rigs.md shows it."""

import gzip
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

pytestmark = pytest.mark.long
Call = Callable[..., tuple[int, str, str]]

AXIS = """/* as an editor of lists writes it */
kopf.achs_nr                        3
kopf.mds_ident                      1
kopf.log_achs_name                  Z
( measuring
kenngr.messachse                    1
getriebe[0].wegaufz                 1048576     ( P-AXIS-00234
getriebe[0].wegaufn                 100000      ( P-AXIS-00233
getriebe[0].dynamik.vb_max          200000
getriebe[0].dynamik.a_max           2000
getriebe[0].slep_ueberw_typ         4           ( P-AXIS-00172
getriebe[0].slep_max                100000
handbetrieb.hb.vb_max               60000
kenngr.swe_pos                      15000000
kenngr.swe_neg                      -10000000
Ende
"""
VENDOR = """
[2000]
ParameterName=Current loop gain
ObjectType=07
DataType=0x0003
AccessType=rw
DefaultValue=-7
"""
PROGRAM = "N10 G90 G1 Z105 F3000\nN20 G100 Z95 F600\nN30 G1 Z110 F3000\nN40 M30\n"
PLAN = (
    "case,program,rig,check:latch_error_um,check:alarms\ntouch,part.nc,machine.toml,-1 .. 1,none\n"
)


def test_a_machine_of_a_list_an_eds_and_a_program_comes_to_a_green_plan(
    place: Path, axisrig: Call
) -> None:
    (place / "axis-z.lst").write_text(AXIS, encoding="utf-8")
    eds = eds_text(DriveProfile()).replace("VendorName=axisrig", "VendorName=Müller Antriebe")
    (place / "drive.eds").write_bytes((eds + VENDOR).replace("\n", "\r\n").encode("cp1252"))
    (place / "part.nc").write_text(PROGRAM, encoding="utf-8")
    (place / "touch.csv").write_text(PLAN, encoding="utf-8")
    made = axisrig("rig", "from", "axis-z.lst", "--eds", "drive.eds", "-o", "machine.toml")
    assert made[:2] == (0, "machine.toml\n")
    code, out, err = axisrig("check", "machine.toml")
    assert code == 0
    said = out + err
    count = made[2].count("assumed: ")
    for words in (
        f"{count} assumptions of the rig not confirmed",
        "P-AXIS-00172) = 4 is accepted and does not act",
        "1 setting has no influence here (axis-z.lst)",  # the speed by hand; others are neutral
        "is read as cp1252",
    ):
        assert words in said, words
    code, out, err = axisrig("run", "touch.csv", "-o", "out", "--bus-log", "candump")
    assert code == 0, out + err
    # Somebody else's log of this machine: packed, and with the name that his interface has
    log = (place / "out" / "bus" / "touch-touch.log").read_text(encoding="utf-8")
    (place / "seen.log.gz").write_bytes(gzip.compress(log.replace(" can1 ", " vcan7 ").encode()))
    code, out, _ = axisrig("bus", "seen.log.gz", "--rig", "machine.toml", "--only", "Z.TPDO1")
    assert code == 0
    assert out.startswith("channel vcan7 of the log is taken for segment can1\n")
    assert "(operation enabled), Position actual value" in out
