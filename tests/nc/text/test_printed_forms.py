"""Every form of a statement that the manuals print, with each optional word there and left out.

In a form `<x>` may be left out and `(a|b)` is one of both; the values are examples. Sources:
FCT-M3 distance control, syntax of the axis command and of the command of 3D; FCT-C4 measurement.
"""

import re
from collections.abc import Iterator

import pytest

from axisrig.kernel.nc.text.parser import parse_program

FORMS = (
    "Z[DIST_CTRL (ON|DRYRUN) <SET_POS=30>]",
    "Z[DIST_CTRL (ON|DRYRUN) CONST_DIST <SET_DIST=2.5>]",
    "Z[DIST_CTRL <OFF <NO_MOVE>>]",
    "Z[DIST_CTRL FREEZE]",
    "Z[DIST_CTRL (CHECK_POS|REF)]",
    "Z[DIST_CTRL <SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.GAP> <VAL1=1> <VAL5=2>]",
    "Z[DIST_CTRL <KP=0.3> <I_TN=0> <D_TV=0.01>]",
    "Z[DIST_CTRL <FILTER_TYPE=KALMAN_MA> <N_CYCLES=30> <FG_F0=10> <ORDER=2> <SMOOTH_FACT=0.5>"
    " <KALMAN_SIGMA=1000>]",
    "#DIST CTRL <WAIT> (ON|DRYRUN) [SURFACE <SET_POS=3>]",
    "#DIST CTRL <WAIT> (ON|DRYRUN) [CONST_DIST <SET_DIST=3>]",
    "#DIST CTRL <WAIT> OFF <NO_MOVE>",
    "#DIST CTRL <WAIT> FREEZE",
    "#DIST CTRL <WAIT> (CHECK_POS|REF)",
    "#DIST CTRL [<MODE=ACS> <DIRECTION=Z> <KP=0.3> <I_TN=0> <D_TV=0.01> <N_CYCLES=30>]",
    "#DIST CTRL [<FILTER_TYPE=KALMAN_MA FILTER_TIME=10> <FG_F0=10> <ORDER=2> <SMOOTH_FACT=0.5>"
    " <KALMAN_SIGMA=1000> <SENSOR_SOURCE=VARIABLE> <SENSOR_VAR=V.E.GAP> <VAL1=1> <VAL5=2>]",
    "#MEAS MODE <[<2>]>",
    "G101 X1 <Y1> <Z1>",
    "G102 <X1 <Z1>>",
)
_INNERMOST = re.compile(r"<([^<>()]*)>|\(([^()<>|]*)\|([^()<>|]*)\)")


def written(form: str) -> Iterator[str]:
    """Yield the form with all that may be there, and with each optional part left out in turn."""
    found = _INNERMOST.search(form)
    if found is None:
        yield re.sub(r" +", " ", form).replace(" ]", "]").replace("[ ", "[").strip()
        return
    before, after = form[: found.start()], form[found.end() :]
    choices = [found[1], ""] if found[1] is not None else [found[2], found[3]]
    for choice in choices:
        yield from written(f"{before}{choice}{after}")


BLOCKS = sorted({text for form in FORMS for text in written(form)})


def test_there_are_as_many_as_the_forms_have() -> None:
    assert len(BLOCKS) > 500
    shortest = {"Z[DIST_CTRL]", "#DIST CTRL []", "#DIST CTRL WAIT CHECK_POS", "#DIST CTRL REF"}
    assert shortest <= set(BLOCKS)


@pytest.mark.long(but=1)
@pytest.mark.parametrize("part", range(4))
def test_every_printed_form_is_read(part: int) -> None:
    """In one program for each part, so that reading costs little."""
    blocks = BLOCKS[part::4]
    text = "\n".join(f"N{number} {block}" for number, block in enumerate(blocks, 1))
    program = parse_program(f"{text}\nM30\n", axes=("X", "Y", "Z"))
    assert len(program.blocks) >= len(blocks)
