"""Indices and sizes of arrays as a program computes them: the rounding of a computation is none."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Message
from axisrig.kernel.nc.decoder.base.cells import whole_index
from axisrig.kernel.nc.decoder.variables import own

FOUR = "#VAR\nV.P.A[4] = [10,11,12,13]\nV.L.A[4] = [20,21,22,23]\nV.S.A[4] = [30,31,32,33]\n#ENDVAR"
ARRAYS = {"V.P.A": 10, "V.L.A": 20, "V.S.A": 30}
"""And the value of the first element."""
ROUNDED = [("1.9999999999", 2), ("2.0000000001", 2), ("0.9999999", 1), ("1.0000001", 1),
           ("-0.0000001", 0), ("3.0000001", 3), ("2.9999991", 3)]  # fmt: skip
REFUSED = ["1.99999", "2.00001", "0.5", "-0.5", "-0.001", "-1", "3.00001", "2.9999989"]


def printed(run, text):
    """What the messages of a program print."""
    return [command.text for command in run(text) if isinstance(command, Message)]


def alarm_of(run, text):
    with pytest.raises(Alarm) as caught:
        run(text)
    return caught.value


@pytest.mark.parametrize(("value", "index"), ROUNDED)
def test_a_computed_index_is_the_whole_number_that_it_is_near(run, value, index):
    for name, first in ARRAYS.items():
        read = f'{FOUR}\nP1={value}\n#MSG ["%d", {name}[P1]]'
        assert printed(run, read) == [str(first + index)]
        shown = "%d " * 4
        elements = ", ".join(f"{name}[{place}]" for place in range(4))
        wanted = [first, first + 1, first + 2, first + 3]
        wanted[index] = 99
        written = f'{FOUR}\nP1={value}\n{name}[P1]=99\n#MSG ["{shown}", {elements}]'
        assert printed(run, written)[0].split() == [str(each) for each in wanted]


@pytest.mark.parametrize("value", REFUSED)
def test_what_is_further_from_a_whole_number_is_no_index(run, value):
    """The alarm shows as much of it as shows why, and the line."""
    for block in ('#MSG ["%d", V.P.A[P1]]', "V.P.A[P1]=1", "P[P1]=1", "V.G.NP[P1].V.X=1"):
        alarm = alarm_of(run, f"{FOUR}\nP1={value}\n{block}")
        assert (alarm.id, alarm.values["value"]) == (20403, value)
        assert alarm.place.startswith("test.nc line 7")


@pytest.mark.parametrize(("value", "index"), [("2.9999999999", 3), ("3.0000000001", 3)])
def test_numbers_of_parameters_and_tables_are_rounded_too(run, value, index):
    for one, other in (
        ("P[P1]", f"P{index}"),
        (f"P{index}", "P[P1]"),
        ("V.G.NP[P1].V.X", f"V.G.NP[{index}].V.X"),
        ("V.G.WZ[P1].L", f"V.G.WZ[{index}].L"),
    ):
        assert printed(run, f'P1={value}\n{one}=5\n#MSG ["%d", {other}]') == ["5"]


@pytest.mark.parametrize("which", [0, 1])
def test_each_of_two_indices_counts(run, which):
    """Both are rounded, and either is refused: 3 rows of 2, filled row by row."""
    made = "#VAR\nV.P.A[3][2] = [0,1,10,11,20,21]\n#ENDVAR\nP1=1.9999999999 P2=0.0000000001"
    assert printed(run, f'{made}\n#MSG ["%d", V.P.A[P1][P2]]') == ["20"]
    assert printed(run, f'{made}\n#MSG ["%d", V.P.A[P2][P1-1]]') == ["1"]
    indices = ["1", "1"]
    indices[which] = "0.5"
    assert alarm_of(run, f"{made}\nX=V.P.A[{indices[0]}][{indices[1]}]").id == 20403
    indices[which] = ("3", "2")[which]
    alarm = alarm_of(run, f"{made}\nX=V.P.A[{indices[0]}][{indices[1]}]")
    assert (alarm.id, alarm.values["upper"]) == (20403, (2, 1)[which])
    assert alarm.values["name"] == f"V.P.A[{indices[0]}][{indices[1]}]"


# Sizes


@pytest.mark.parametrize(
    ("size", "elements"),
    [("3", 3), ("2.9999999999", 3), ("3.0000000001", 3), ("1", 1), ("0.9999999", 1)],
)
def test_a_size_is_the_whole_number_that_it_is_near(run, size, elements):
    text = f"P1={size}\n#VAR\nV.P.A[P1]\n#ENDVAR\n"
    run(f"{text}V.P.A[{elements - 1}]=1")
    alarm = alarm_of(run, f"{text}V.P.A[{elements}]=1")
    assert (alarm.id, alarm.values["upper"]) == (20403, elements - 1)


@pytest.mark.parametrize("size", ["0", "-1", "-3", "2.5", "0.5", "2.99999", "-0.5"])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_what_is_no_number_of_elements_is_no_size(run, size, place):
    """Of a single dimension, and of either of two; two negative ones make no positive product."""
    sizes = [["{}"], ["{}", "2"], ["-2", "{}"]][place]
    text = "".join(f"[{each}]" for each in sizes).format(size)
    alarm = alarm_of(run, f"#VAR\nV.P.A{text}\n#ENDVAR")
    assert (alarm.id, alarm.values["name"]) == (900123, f"V.P.A{text}")
    assert alarm.place.startswith("test.nc line 2")


@pytest.mark.parametrize(("sizes", "is_made"), [((10, 50), True), ((1_000_001,), False),
                                                ((1000, 1001), False)])  # fmt: skip
def test_an_array_has_a_million_elements_at_most(run, sizes, is_made):
    text = "".join(f"[{size}]" for size in sizes)
    if is_made:
        run(f"#VAR\nV.P.A{text}\n#ENDVAR")
    else:
        alarm = alarm_of(run, f"#VAR\nV.P.A{text}\n#ENDVAR")
        assert (alarm.id, alarm.values["name"]) == (900123, f"V.P.A{text}")


def test_a_millionth_is_rounding_and_more_is_not():
    """On both sides."""
    for whole in (0, 1, 7, 200):
        for part in (0.0, 5e-7, 0.9e-6):
            assert whole_index(whole + part) == whole
            assert whole_index(whole - part) == whole
        for part in (1.1e-6, 1e-3, 0.49, 0.5):
            assert whole_index(whole + part) is None
            assert whole_index(whole - part) is None
    assert whole_index(-1.0) is None


@pytest.mark.parametrize(
    ("sizes", "fits"),
    [("[6]", True), ("[7]", False), ("[2][3]", True), ("[3][3]", False), ("[1][7]", False)],
)
def test_an_array_has_so_many_elements_in_all_and_no_more(
    run, monkeypatch: pytest.MonkeyPatch, sizes: str, fits: bool
) -> None:
    monkeypatch.setattr(own, "ELEMENTS_MAX", 6)
    text = f"#VAR\nV.P.A{sizes}\n#ENDVAR"
    if fits:
        run(text)
    else:
        alarm = alarm_of(run, text)
        assert (alarm.id, alarm.values) == (900123, {"name": f"V.P.A{sizes}", "maximum": 6})
