"""Cycles (L CYCLE) with their parameters, errors of a program (#ERROR)."""

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.canon import LinearMove, Warn
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import read_program

XYZ = ("X", "Y", "Z")


@pytest.fixture
def files(tmp_path, plane_machine):
    """Write files and give the commands of the one that is called main.nc."""

    def run_files(main, **cycles):
        (tmp_path / "main.nc").write_text(main, encoding="utf-8")
        for name, text in cycles.items():
            (tmp_path / f"{name}.cyc").write_text(text, encoding="utf-8")
        program = read_program(tmp_path / "main.nc", XYZ)
        machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
        return list(Interpreter(program, XYZ, machine, external={}).commands())

    return run_files


def path(commands):
    return [each.target_mm["X"] for each in commands if isinstance(each, LinearMove)]


def refusal(files, main, **cycles):
    with pytest.raises(Alarm) as caught:
        files(main, **cycles)
    return caught.value


def test_a_cycle_gets_its_parameters_and_comes_back(files):
    """Programming manual 206859019."""
    main = "G0 P1=4\nL CYCLE [NAME=go.cyc @P1=P1*2 @P30=1]\nX1"
    assert path(files(main, go="X=@P1 + @P30\nM17")) == [9, 1]


def test_a_cycle_may_write_its_parameters_and_its_own_subprograms_see_them(files):
    cycle = "%L INNER\nX=@P2\nM17\n%go\n@P2=@P1 + 1\nLL INNER\nM17"
    assert path(files("G0\nL CYCLE [NAME=go.cyc @P1=2]", go=cycle)) == [3]


def test_each_call_has_parameters_of_its_own(files):
    outer = "L CYCLE [NAME=inner.cyc @P1=@P1 + 10]\nX=@P1"
    main = "G0\nL CYCLE [NAME=outer.cyc @P1=1]\nL CYCLE [NAME=outer.cyc @P1=2]"
    assert path(files(main, outer=outer, inner="X=@P1")) == [11, 1, 12, 2]


def test_parameters_are_computed_before_the_call(files):
    main = "G0 P1=5\nL CYCLE [NAME=go.cyc @P1=P1 @P2=P1+1]"
    assert path(files(main, go="P1=7\nX=@P1\nX=@P2")) == [5, 6]


@pytest.mark.provokes(21382, 2, name="@P1")
@pytest.mark.parametrize("main", ["G0 X=@P1", "@P1=3", "L CYCLE [NAME=go.cyc @P1=@P1]"])
def test_21382_outside_a_cycle(files, main):
    """Diagnosis 254440587."""
    alarm = refusal(files, main, go="M17")
    assert (alarm.id, alarm.values["name"]) == (21382, "@P1")


def test_21382_in_a_subprogram_that_is_a_file_of_its_own(files, tmp_path):
    (tmp_path / "plain.nc").write_text("X=@P1", encoding="utf-8")
    alarm = refusal(files, "G0\nL CYCLE [NAME=go.cyc @P1=1]", go="L plain.nc")
    assert alarm.id == 21382


def test_a_parameter_that_the_call_does_not_give_has_no_value(files):
    alarm = refusal(files, "G0\nL CYCLE [NAME=go.cyc @P1=1]", go="X=@P2")
    assert (alarm.id, alarm.values["name"]) == (900113, "@P2")
    assert "@P1" in alarm.values["near"]


def test_modal_calls_do_not_act(files):
    alarm = refusal(files, "G0\nL CYCLE [NAME=go.cyc MODAL @P1=1]", go="M17")
    assert alarm.id == 900100


def test_the_file_of_a_cycle_must_be_there(files):
    with pytest.raises(UserError, match="is not there") as caught:
        files("G0\nL CYCLE [NAME=gone.cyc @P1=1]")
    assert (caught.value.line, caught.value.value) == (2, "gone.cyc")


@pytest.mark.provokes(900130, 1, number=7, details="MID 3, PV1 5")
def test_900130_is_a_warning_and_the_program_goes_on(run):
    """Error management 207457163: RC 0."""
    commands = run("G0 X1\n#ERROR [ID=7 RC=0 MID=3 PV1=5]\nX2")
    assert path(commands) == [1, 2]
    (warning,) = (each.alarm for each in commands if isinstance(each, Warn))
    assert (warning.id, warning.values["number"], warning.values["details"]) == (
        900130,
        7,
        "MID 3, PV1 5",
    )


@pytest.mark.provokes(900131, 3, number=8, details="without values")
@pytest.mark.parametrize("text", ["#ERROR [ID=8 RC=2]", "#ERROR [ID=8]"])
def test_900131_ends_the_program(run, text):
    """Error management 207457163: RC 2, which is what an error without RC has."""
    with pytest.raises(Alarm) as caught:
        run(f"G0 X1\n{text}\nX2")
    assert (caught.value.id, caught.value.values["number"]) == (900131, 8)


@pytest.mark.provokes(900132, 7, number=9, details="PV1 low, PM1 2")
def test_900132_is_fatal(run):
    with pytest.raises(Alarm) as caught:
        run('#ERROR [ID=9 RC=7 PV1="low" PM1=2]')
    assert (caught.value.id, caught.value.values["details"]) == (900132, "PV1 low, PM1 2")


@pytest.mark.provokes(900133, 2)
@pytest.mark.parametrize(
    ("text", "keyword"), [("ID=8 RC=3", "RC"), ("ID=1001 RC=2", "ID"), ("ID=1.5", "ID")]
)
def test_900133_for_another_number(run, text, keyword):
    with pytest.raises(Alarm) as caught:
        run(f"#ERROR [{text}]")
    assert (caught.value.id, caught.value.values["keyword"]) == (900133, keyword)
