"""Types of #VAR: what each can hold, at its limits and beside them, and what is cut off."""

import pytest
from tests.nc.test_indices_of_variables import printed
from tests.nc.test_nc_variables import alarm_of

WHOLE = {
    "BOOLEAN": (0, 1),
    "SGN08": (-128, 127), "UNS08": (0, 255),
    "SGN16": (-32768, 32767), "UNS16": (0, 65535),
    "SGN32": (-2147483648, 2147483647), "UNS32": (0, 4294967295),
}  # fmt: skip
"""Whole numbers of 8, 16 and 32 bits, with and without a sign."""
KINDS = pytest.mark.parametrize("name", ["V.P.A", "V.L.A", "V.S.A"])
PLACES = pytest.mark.parametrize(
    ("declared", "used"), [("", ""), ("[3]", "[1]"), ("[2][2]", "[1][0]")]
)


def shown(run, declaration, assignment, read):
    return printed(run, f'#VAR\n{declaration}\n#ENDVAR\n{assignment}\n#MSG ["%.3f", {read}]')[0]


@PLACES
@pytest.mark.parametrize("kind", WHOLE)
def test_a_type_holds_its_limits_and_nothing_beside_them(run, kind, declared, used):
    """One more, one less, and in the declaration too."""
    name = "V.P.A"
    lower, upper = WHOLE[kind]
    for value in (lower, upper):
        text = f"{name}{declared} : {kind}"
        assert shown(run, text, f"{name}{used}={value}", f"{name}{used}") == f"{value}.000"
    for value in (lower - 1, upper + 1):
        alarm = alarm_of(run, f"#VAR\n{name}{declared} : {kind}\n#ENDVAR\n{name}{used}={value}")
        assert (alarm.id, alarm.values["value"]) == (20847, f"{value}")
        assert (alarm.values["name"], alarm.values["lower"], alarm.values["upper"]) == (
            f"{name}{used}", lower, upper,
        )  # fmt: skip
        assert alarm.place.startswith("test.nc line 4")


@pytest.mark.parametrize("kind", WHOLE)
def test_a_fraction_is_cut_off_towards_0(run, kind):
    """So -0.9 is a 0 of a type without a sign, and 255.9 are 255 of 8 bits."""
    lower, upper = WHOLE[kind]
    assert shown(run, f"V.P.A : {kind}", f"V.P.A={upper}.9", "V.P.A") == f"{upper}.000"
    assert shown(run, f"V.P.A : {kind}", "V.P.A=0.999", "V.P.A") == "0.000"
    assert float(shown(run, f"V.P.A : {kind}", "V.P.A=-0.9", "V.P.A")) == 0.0
    if lower:
        assert shown(run, f"V.P.A : {kind}", "V.P.A=-2.9", "V.P.A") == "-2.000"
        assert shown(run, f"V.P.A : {kind}", f"V.P.A={lower}.9", "V.P.A") == f"{lower}.000"


@KINDS
def test_a_floating_point_number_keeps_its_fraction(run, name):
    """And has no limits."""
    assert shown(run, f"{name} : REAL64", f"{name}=-2.75", name) == "-2.750"
    assert shown(run, f"{name} : REAL64", f"{name}=1000000000000.5", name) == "1000000000000.500"


@KINDS
def test_without_a_type_a_variable_takes_a_text_after_a_number(run, name):
    assert printed(run, f'{name}=1\n{name}="two"\n#MSG ["%s", {name}]') == ["two"]


@KINDS
@pytest.mark.parametrize("kind", [*WHOLE, "REAL64"])
def test_a_type_of_numbers_takes_no_text(run, name, kind):
    """Neither in the declaration nor later."""
    for text in (
        f'#VAR\n{name} : {kind} = "one"\n#ENDVAR',
        f'#VAR\n{name} : {kind}\n#ENDVAR\n{name}="one"',
    ):
        alarm = alarm_of(run, text)
        assert alarm.id == 900122
        assert alarm.values == {"name": name, "kind": kind, "value": "one"}


@KINDS
def test_a_text_takes_no_number(run, name):
    for text in (
        f"#VAR\n{name} : STRING[9] = 1\n#ENDVAR",
        f"#VAR\n{name} : STRING[9]\n#ENDVAR\n{name}=1",
    ):
        alarm = alarm_of(run, text)
        assert (alarm.id, alarm.values["name"], alarm.values["kind"]) == (900122, name, "STRING")


@KINDS
def test_what_is_declared_without_a_value_is_0_or_an_empty_text(run, name):
    assert shown(run, f"{name} : SGN16", "", name) == "0.000"
    text = f'#VAR\n{name} : STRING[9]\n#ENDVAR\n#MSG ["<%s>", {name}]'
    assert printed(run, text) == ["<>"]


@pytest.mark.parametrize(("name", "kept"), [("V.P.A", "7"), ("V.L.A", "7"), ("V.S.A", "5")])
def test_what_is_declared_again_is_made_anew_but_for_the_session(run, name, kept):
    text = f"#VAR\n{name} = 7\n#ENDVAR"
    assert printed(run, f'{text}\n{name}=5\n{text}\n#MSG ["%d", {name}]') == [kept]


def test_a_declaration_in_a_subprogram_hides_that_of_its_caller(run):
    """V.L: it ends with the call, and the caller has its own value again; V.P is one for all."""
    for name, after in (("V.L.A", "1"), ("V.P.A", "3")):
        text = (
            f'%L SUB\n#VAR\n{name} = 2\n#ENDVAR\n#MSG ["%d", {name}]\n{name}=3\n%MAIN\n{name}=1\n'
            f'LL SUB\n#MSG ["%d", {name}]'
        )
        assert printed(run, text) == ["2", after]


@pytest.mark.parametrize("target", ["V.E.A", "V.E.A[2]", "P[2]", "P1"])
def test_what_is_not_the_programs_own_cannot_be_declared(run, target):
    external = {"A": 0.0, "A[2]": 0.0}
    alarm = alarm_of(run, f"#VAR\n{target}\n#ENDVAR", external=external)
    assert alarm.id == 900121


@pytest.mark.parametrize(
    ("text", "given", "places"),
    [("[2] = [1,2,3]", 3, 2), ("[2][2] = [1,2,3,4,5]", 5, 4), ("[1] = [1,2]", 2, 1)],
)
def test_more_values_than_places_are_refused_with_both(run, text, given, places):
    alarm = alarm_of(run, f"#VAR\nV.P.A{text}\n#ENDVAR")
    assert alarm.id == 900124
    assert (alarm.values["given"], alarm.values["places"]) == (given, places)
    fitting = text.rpartition(",")[0] + "]"
    run(f"#VAR\nV.P.A{fitting}\n#ENDVAR")
