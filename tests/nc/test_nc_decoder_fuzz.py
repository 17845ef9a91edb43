"""Whatever a program computes and wherever it jumps: commands, an alarm, or a user error."""

from contextlib import suppress
from itertools import islice
from unittest.mock import patch

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.decoder import Interpreter, interpreter
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")
HEAD = (
    "%L SUB\nP1=P1+1\n$IF P1>20\nM17\n$ENDIF\nLL SUB\n%MAIN\nF100 G0\n#VAR\nV.P.A[3] = [1,2,3]\n"
    'V.P.T : STRING[9] = "t"\nV.P.U : UNS08 = 7\n#ENDVAR\nP1=1 P2=2 V.P.V=1 V.S.S=1 V.L.L=1'
)
VALUES = st.sampled_from(
    (
        *("0", "1", "-2.5", "1000", "P1", "P2", "P[P1]", "V.P.V", "V.L.L", "V.S.S", "V.P.A[P1]"),
        *("V.P.U", "V.P.T", '"text"', "V.E.A", "V.A.ABS.X", "V.A.MERF.X", "V.A.MESS.X", "P1/P2"),
        *("V.G.FEEDRATE", "V.G.NP[1].V.X", "SIN[P1]", "SQRT[P1]", "EXP[P1*100]", "P1**P2"),
        *("P1 MOD P2", "P1 & P2", "P1==P2", "P1<=2 && P2>1", "NOT[P1]", "TRUE", "LN[P2]"),
    )
)
PLAIN = st.one_of(
    st.builds(
        "{}={}".format,
        st.sampled_from(["P1", "P2", "P[P1]", "V.P.V", "V.P.U", "V.P.T", "V.P.A[P2]", "V.E.A"]),
        VALUES,
    ),
    st.builds(
        "{}{}".format,
        st.sampled_from(["G0 X=", "G91 X=", "G90 Y=", "G100 X=", "G92 X=", "G101 X=", "G1 F="]),
        VALUES,
    ),
    st.builds('#MSG ["%f %s", {}, {}]'.format, VALUES, VALUES),
    st.builds("#CS ON[{}, {}, 0, {}]".format, VALUES, VALUES, VALUES),
    st.sampled_from(["#CS OFF", "LL SUB", "M17", "M30", "$GOTO [OUT]", "#MEAS MODE[P1]", "G102"]),
)


def _nested(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    body = st.lists(inner, max_size=3).map("\n".join)
    return st.one_of(
        st.builds("$IF {}\n{}\n$ELSE\n{}\n$ENDIF".format, VALUES, body, body),
        st.builds("$WHILE {}\n{}\n$ENDWHILE".format, VALUES, body),
        st.builds("$FOR P1={},{},{}\n{}\n$ENDFOR".format, VALUES, VALUES, VALUES, body),
        st.builds("$DO\n{}\n$BREAK\n$ENDDO {}".format, body, VALUES),
        st.builds("$REPEAT\n{}\n$CONTINUE\n$UNTIL {}".format, body, VALUES),
        st.builds("$SWITCH {}\n$CASE {}\n{}\n$DEFAULT\n$ENDSWITCH".format, VALUES, VALUES, body),
    )


PROGRAMS = st.lists(st.recursive(PLAIN, _nested, max_leaves=8), max_size=6)


@given(PROGRAMS)
@pytest.mark.long
def test_every_program_gives_commands_or_says_what_is_wrong(plane_machine, parts):
    text = "\n".join([HEAD, *parts, "[OUT] M30"])
    machine, external = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0)), {"A": 1.0}
    message = (Alarm, UserError)
    with suppress(*message), patch.object(interpreter, "IDLE_BLOCKS_MAX", 500):
        program = parse_program(text, axes=XYZ)
        commands = Interpreter(program, XYZ, machine, external=external).commands()
        for command in islice(commands, 100):
            machine.queue.append(command)
            if isinstance(command, canon.ExternalWrite):
                external[command.name] = command.value
            if isinstance(command, canon.Wait):
                machine.execute()
