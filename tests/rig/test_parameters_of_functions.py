"""Drive functions of a PROFIdrive axis: the parameter that is written, and the one that is read.

Parameters of the drive (SINAMICS list): 660, 881, 922, 925 and 1230 of 16 bits, 880 of 32 bits,
all without a sign.
"""

from collections.abc import Callable

import pytest

from axisrig.bench.rig.profidrive.checks import check_profidrive
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

RigAbove = Callable[..., Settings]
NO_PARAMETER = "the drive has no such parameter (P-AXIS-00398)"
OTHER_TYPE = "has another data type (P-AXIS-00399)"


def functions(*rows: str, first: int = 0) -> list[str]:
    """Assignments of functions; a row: written, read (- = none), data type, communication."""
    found = []
    for at, row in enumerate(rows, first):
        written, read, data_type, communication = row.split()
        keys = {"id": f"F{at}", "wr_ident[0]": written, "data_type": data_type,
                "commu": communication}  # fmt: skip
        if read != "-":
            keys["rd_ident"] = read
        found += [f"set:Z.antr.function[{at}].{key}={value}" for key, value in keys.items()]
    return found


def refused(rig_above: RigAbove, assignments: list[str]) -> UserError | None:
    settings = rig_above("probe-z-profidrive.toml", "", *assignments)
    try:
        check_profidrive(settings, "Z", 4 * MS)
    except UserError as error:
        return error
    return None


@pytest.mark.parametrize(
    "rows",
    [
        ("1230 - UNS16 ACYCLIC",),
        ("1230 1230 UNS16 ACYCLIC",),
        ("1230 881 UNS16 ACYCLIC",),  # reads another one of the same type
        ("880 - UNS32 ACYCLIC",),
        ("1230 881 UNS16 IGNORE",),
        ("660 - UNS16 ACYCLIC", "925 922 UNS16 ACYCLIC"),
    ],
)
def test_a_function_of_parameters_that_the_drive_has_is_good(
    rig_above: RigAbove, rows: tuple[str, ...]
) -> None:
    assert refused(rig_above, functions(*rows)) is None


@pytest.mark.parametrize("first", [0, 9])  # ten functions: 0 to 9
@pytest.mark.parametrize(
    ("row", "words", "value", "allowed"),
    [
        ("1230 9999 UNS16 ACYCLIC", NO_PARAMETER, "9999", "660, 880"),
        ("9999 1230 UNS16 ACYCLIC", NO_PARAMETER, "9999", "660, 880"),
        ("1231 - UNS16 ACYCLIC", NO_PARAMETER, "1231", "660, 880"),
        ("1230 880 UNS16 ACYCLIC", f"parameter 880 {OTHER_TYPE}", "UNS16", "UNS32"),
        ("880 1230 UNS16 ACYCLIC", f"parameter 880 {OTHER_TYPE}", "UNS16", "UNS32"),
        ("880 1230 UNS32 ACYCLIC", f"parameter 1230 {OTHER_TYPE}", "UNS32", "UNS16"),
        ("1230 - SGN16 ACYCLIC", f"parameter 1230 {OTHER_TYPE}", "SGN16", "UNS16"),
        ("1230 - UNS08 ACYCLIC", f"parameter 1230 {OTHER_TYPE}", "UNS08", "UNS16"),
        ("1230 - UNS16 CYCLIC", "no word of the telegram", "CYCLIC", "ACYCLIC, IGNORE"),
        ("1230 9999 UNS16 IGNORE", NO_PARAMETER, "9999", "660, 880"),
    ],
)
def test_a_function_says_which_of_its_two_parameters_is_wrong(
    rig_above: RigAbove, row: str, words: str, value: str, allowed: str, first: int
) -> None:
    error = refused(rig_above, functions(row, first=first))
    assert error is not None
    assert f"axis Z: drive function F{first}: {words}" in error.message
    assert str(error.value) == value
    assert (error.allowed or "").startswith(allowed)
    assert error.file


def test_a_good_function_before_a_wrong_one_does_not_hide_it(rig_above: RigAbove) -> None:
    rows = ("1230 - UNS16 ACYCLIC", "881 880 UNS16 ACYCLIC")
    error = refused(rig_above, functions(*rows))
    assert error is not None
    assert "drive function F1: parameter 880" in error.message
    rows = rows[::-1]
    error = refused(rig_above, functions(*rows))
    assert error is not None
    assert "drive function F0: parameter 880" in error.message
