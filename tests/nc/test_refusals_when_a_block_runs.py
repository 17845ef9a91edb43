"""What only the run can refuse: values of variables, indices, kinds; ID, block and every value."""

import pytest
from tests.nc.conftest import of, texts

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import ExternalWrite

FIELD = {"F[1]": 1.5, "Height": 2.0}
PLACES = {"lower": 0, "upper": 96}


def refused(run, blocks, **more):
    with pytest.raises(Alarm) as caught:
        run(blocks, **more)
    alarm = caught.value
    assert alarm.place == f"test.nc line {len(blocks.splitlines())}"
    return alarm.id, alarm.values


def shown(run, text, **more):
    return texts(run(text, **more))


# ---- the PLC side


@pytest.mark.parametrize("block", ["P1=V.E.F[2]", "V.E.F[2]=3", "P2=2\nP1=V.E.F[P2]"])
def test_900113_for_a_place_that_a_field_of_the_plc_side_has_not(run, block):
    near = "the nearest with one: V.E.F[1]"
    assert refused(run, block, external=FIELD) == (900113, {"name": "V.E.F[2]", "near": near})


@pytest.mark.parametrize(("name", "block"), [("F[1]", "V.E.F[1]"), ("Height", "V.E.HEIGHT")])
def test_900122_for_a_text_to_the_plc_side(run, name, block):
    wanted = {"name": f"V.E.{name}", "kind": "a number", "value": "high"}
    assert refused(run, f'X=V.E.F[1] F1\n{block}="high"', external=FIELD) == (900122, wanted)


def test_the_plc_side_gets_the_name_as_it_spells_it(run):
    commands = run("V.E.HEIGHT=4\nv.e.f[1]=V.E.height+1", external=FIELD)
    written = [(each.name, each.value) for each in of(commands, ExternalWrite)]
    # nothing takes what was given out: the second block reads 2
    assert written == [("Height", 4.0), ("F[1]", 3.0)]


# ---- zero offsets and tools


@pytest.mark.parametrize("group", [0, 1, 96])
def test_the_default_group_is_read_as_it_was_written(run, group):
    assert shown(run, f'V.G.NP_DEFAULT={group}\n#MSG ["%d", V.G.NP_DEFAULT]') == [str(group)]


@pytest.mark.parametrize("group", [-1, 97])
def test_20403_for_a_default_group_that_no_list_has(run, group):
    wanted = {"name": "V.G.NP_DEFAULT", "value": group, **PLACES}
    assert refused(run, f"X1 F1\nV.G.NP_DEFAULT={group}") == (20403, wanted)


@pytest.mark.parametrize(
    ("block", "name", "index", "upper"),
    [
        ("V.G.NP[97].V.X=1", "V.G.NP[]", 97, 96),
        ("P1=V.G.NP[97].V.X", "V.G.NP[]", 97, 96),
        ("G159=97", "G159", 97, 96),
        ("P1=V.G.NP[1].V[3]", "V[]", 3, 2),
        ("V.G.NP_AKT.V[3]=1", "V[]", 3, 2),
        ("P1=V.G.WZ[201].L", "V.G.WZ[]", 201, 200),
        ("V.G.WZ[201].OK=1", "V.G.WZ[]", 201, 200),
        ("V.G.WZ[1].V[4]=1", "V[]", 4, 2),
        ("P1=V.G.WZ_AKT.V[3]", "V[]", 3, 2),
        ("P1=V.G.KIN_STEP[2].ID[9].PARAM[0]", "V.G.KIN_STEP[].ID[].PARAM[]", 2, 1),
        ("V.G.KIN_STEP[0].ID[9].PARAM[74]=1", "V.G.KIN_STEP[].ID[].PARAM[]", 74, 73),
    ],
)
def test_20403_names_the_index_that_is_too_large(run, block, name, index, upper):
    wanted = {"name": name, "value": index, "lower": 0, "upper": upper}
    assert refused(run, f"X1 F1\n{block}") == (20403, wanted)


def test_20403_for_an_index_that_is_no_whole_number(run):
    wanted = {"name": "V.G.WZ[].L", "value": "0.5", "lower": 0, "upper": "the last element"}
    assert refused(run, "P1=V.G.WZ[0.5].L") == (20403, wanted)


@pytest.mark.parametrize(
    "name",
    [
        "V.G.NP_DEFAULT",
        "V.G.NP[1].V.X",
        "V.G.NP_AKT.V.X",
        "V.G.WZ_AKT.L",
        "V.G.WZ_AKT.V.X",
        "V.G.WZ[3].R",
        "V.G.WZ[3].OK",
        "V.G.KIN_STEP[0].ID[9].PARAM[0]",
    ],
)
def test_900105_for_a_text_where_a_number_is_kept(run, name):
    assert refused(run, f'X1 F1\n{name}="two"') == (900105, {"reason": "'two' is no number"})


def test_each_tool_is_valid_by_itself(run):
    text = '#MSG ["%d%d%d", V.G.WZ[5].OK, V.G.WZ[6].OK, V.G.WZ[7].OK]'
    assert shown(run, f"V.G.WZ[5].OK=1\n{text}\nV.G.WZ[7].OK=2\nV.G.WZ[5].OK=0\n{text}") == [
        "100",
        "001",
    ]


def test_a_group_is_a_whole_number(run):
    assert refused(run, "G159=1.5") == (900105, {"reason": "G159 = 1.5 is no group"})


# ---- values


@pytest.mark.parametrize(
    ("operand", "expression", "reason"),
    [
        ('"a"', 'P1<"b"', "< of texts"),
        ('"a"', 'P1>="b"', ">= of texts"),
        ('"a"', 'P1-"b"', "- of texts"),
        ('"a"', "P1+1", "a text is no number"),
        ('"a"', "-P1", "a text is no number"),
        ('"a"', "1 AND P1", "a text is no number"),
        (-4, "SQRT[P1]", "square root of -4"),
        (1.5, "ASIN[P1]", "arc sine of 1.5"),
        (-2, "ACOS[P1]", "arc cosine of -2"),
        (0, "LN[P1]", "natural logarithm of 0"),
        (-1, "LOG[P1]", "logarithm of -1"),
        (270, "TAN[P1]", "tangent of 270 degrees"),
        (180, "COT[P1]", "cotangent of 180 degrees"),
        (-8, "P1**0.5", "power 0.5 of -8"),
        (1.5, "P1&1", "bits of 1.5, which is no whole number"),
        (1.5, "INV[P1]", "bits of 1.5, which is no whole number"),
        (1000, "EXP[P1]", "number too large"),
        (400, "10**P1", "number too large"),
        (400, "DEXP[P1]", "number too large"),
        ("DEXP[99]", "P1*P1*P1*P1", "number too large"),
    ],
)
def test_900105_says_why_there_is_no_value(run, operand, expression, reason):
    blocks = f"P1={operand}\nG1 F1\nP2={expression}"
    assert refused(run, blocks) == (900105, {"reason": reason})


@pytest.mark.parametrize(
    ("expression", "dividend"),
    [("10/P1", "10"), ("-2.5/P1", "-2.5"), ("7 MOD P1", "7"), ("P1**[-1]", "1"), ("0/P1", "0")],
)
def test_20396_shows_what_was_to_be_divided(run, expression, dividend):
    assert refused(run, f"P1=0\nX={expression}") == (20396, {"value": dividend})


@pytest.mark.parametrize(
    ("value", "case", "holds"),
    [('"b"', '"b"', True), ('"b"', '"B"', False), ('"1"', "1", False), ("1", '"1"', False)],
)
def test_a_text_chooses_the_case_that_is_the_same_text(run, value, case, holds):
    text = f"P1={value}\n$SWITCH P1\n$CASE {case}\nP2=1\n$BREAK\n$DEFAULT\nP2=2\n$ENDSWITCH\n"
    assert shown(run, f'{text}#MSG ["%d", P2]') == ["1" if holds else "2"]


@pytest.mark.parametrize("angle", [0, 180, -180, 540])
def test_the_tangent_of_half_a_turn_is_exactly_0(run, angle):
    assert shown(run, f'P1={angle}\n#MSG ["%.20f", TAN[P1]]') == ["0.00000000000000000000"]


@pytest.mark.parametrize("word", ["M17", "M29", "M2", "M30"])
def test_the_main_program_ends_at_the_end_of_a_subprogram_too(run, word):
    assert shown(run, f'#MSG ["before"]\n{word}\n#MSG ["after"]') == ["before"]


# ---- coordinate systems


@pytest.mark.parametrize(
    ("blocks", "alarm_id", "values"),
    [
        ("#CS ON [1.5][1,2,3]", 20820, {"value": "1.5"}),
        ("#CS DEF [0][1,2,3]", 20820, {"value": "0"}),
        ("#CS ON [-1]", 20820, {"value": "-1"}),
        ("#CS ON", 20821, {"word": "#CS ON"}),
        ("#CS ON [3]", 20821, {"word": "#CS ON[3]"}),
        ("#CS DEF [3][1]\n#CS ON [4]", 20821, {"word": "#CS ON[4]"}),
        ("#CS OFF", 900108, {}),
        ("#CS ON [1,2]\n#CS OFF\n#CS OFF", 900108, {}),
        ("#CS ON [1,2]\n#CS OFF ALL\n#CS OFF", 900108, {}),
        ("#CS ADD[A][1]\n#CS ADD[A][2]", 21599, {"name": "A"}),
        ("#CS ADD[ABCDEFGHI][1]", 21599, {"name": "ABCDEFGHI"}),
        ("#CS ADD[ACS][1]", 21599, {"name": "ACS"}),
        ("#CS ADD[IMCS][1]", 21599, {"name": "IMCS"}),
        ("#CS SELECT[B]", 21601, {"name": "B", "known": "none"}),
        ("#CS ADD[A][1]\n#CS ADD[2][1]\n#CS SELECT[C]", 21601, {"name": "C", "known": "A 2"}),
        ("#CS ADD[A][1]\n#CS SET[C][1]", 21601, {"name": "C", "known": "A"}),
        ("#CS SELECT[MCS]", 900100,
         {"word": "#CS SELECT[MCS]", "what": "system of a kinematic"}),
        ("\n".join(f"#CS DEF[{n}][1]" for n in range(1, 7)), 21234,
         {"word": "#CS", "value": 6, "upper": 5}),
        ("\n".join(["#CS ON[1,0]"] * 6), 21234, {"word": "#CS", "value": 6, "upper": 5}),
        ("#CS DEF[1][1]\n#CS DEF[2][1]\n#CS DEF[3][1]\n#CS ON[1,0]\n#CS ON[1,0]\n#CS ON[1,0]",
         21234, {"word": "#CS", "value": 6, "upper": 5}),
        ("\n".join(f"#CS ADD[{n}][1]" for n in range(1, 7)), 21234,
         {"word": "#CS ADD", "value": 6, "upper": 5}),
    ],
)  # fmt: skip
def test_a_coordinate_system_that_there_cannot_be(run, blocks, alarm_id, values):
    """TF5200 programming manual 208480907, 1037259147 (five), 1086442763 (names)."""
    assert refused(run, blocks) == (alarm_id, values)


@pytest.mark.parametrize(
    "blocks",
    [
        "\n".join(f"#CS DEF[{n}][1]" for n in (1, 2, 3, 4, 5, 5)),
        "\n".join(["#CS ON[1,0]"] * 5),
        "\n".join(["#CS ON[1,0]", "#CS OFF"] * 6),
        "\n".join(f"#CS ADD[{n}][1]" for n in range(1, 6)),
        "#CS ADD[ABCDEFGH][1]\n#CS SELECT[ABCDEFGH]",
    ],
)
def test_five_systems_and_a_name_of_eight_letters_can_be(run, blocks):
    assert shown(run, f'{blocks}\n#MSG ["on"]') == ["on"]
