"""FMUs to hand on, and findings on descriptions and libraries: from stand-ins."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.fmu import examine, release
from axisrig.bench.tools.fmu.binaries import Binary
from axisrig.bench.tools.fmu.findings import fail, ok, show_findings, warn
from axisrig.bench.tools.fmu.release import Change
from axisrig.fmus import PLATFORMS
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS


def variable(name: str, **given: Any) -> Any:
    known = {"type": "Float64", "causality": "output", "start": "0", "dimensions": [],
             "clocks": [], "min": None, "max": None, "shape": (), "unit": None,
             "declaredType": None}  # fmt: skip
    return SimpleNamespace(name=name, **{**known, **given})


# To hand on


class Slave:
    """y is x at the begin of the step, the count of steps is whole."""

    def __init__(self, ends_at: int | None = None) -> None:
        self.news: list[str] = []
        self.values = {"x": 0.5, "y": 0.0, "n": 0}
        self._variables = [variable("x", causality="input"), variable("y"),
                           variable("n", type="Int32"), variable("a", dimensions=[1])]  # fmt: skip
        self._ends_at = ends_at

    def names(self, causality: str) -> list[str]:
        return [one.name for one in self._variables if one.causality == causality]

    def variable(self, name: str) -> Any:
        return next(one for one in self._variables if one.name == name)

    def set_start(self, name: str, value: float) -> None:
        self.values[name] = value

    def initialize(self, _time_ns: int) -> None:
        self.news.append("initialized")
        self.values["y"] = self.values["x"]

    def step_to(self, time_ns: int) -> None:
        if time_ns == self._ends_at:
            raise RuntimeError("odd")
        self.news.append(f"{time_ns // MS}")
        self.values["y"], self.values["n"] = self.values["x"], self.values["n"] + 1

    def close(self) -> None:
        self.news.append("closed")


class Exchange:
    def __init__(self, slave: Slave, names: list[str]) -> None:
        self._slave, self._names = slave, names
        self.values: list[float] = []

    def read(self) -> None:
        self.values = [self._slave.values[name] for name in self._names]


def test_a_walk_steps_as_the_bench_does_and_an_input_acts_in_the_step_after_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    slave = Slave()
    monkeypatch.setattr(release, "load_fmu", lambda *_: slave)
    monkeypatch.setattr(release, "Exchange", Exchange)
    course = [Change(0.0, "x", 1.0), Change(0.001, "x", 2.0), Change(0.0021, "x", 3.0)]
    names, rows = release.walk(Path("a.fmu"), course, MS, 4)
    assert names == ["time", "y", "n"]  # arrays are left out
    assert [row[1:] for row in rows] == [[1.0, 0], [1.0, 1], [2.0, 2], [2.0, 3], [3.0, 4]]
    assert [row[0] for row in rows] == pytest.approx([0.0, 0.001, 0.002, 0.003, 0.004])
    assert slave.news == ["initialized", "1", "2", "3", "4", "closed"]
    both = Slave()
    monkeypatch.setattr(release, "load_fmu", lambda *_: both)
    twice = [Change(0.0, "x", 7.0), Change(0.0, "x", 1.0), Change(0.001, "n", 10.0)]
    course = [
        *twice,
        *(Change(at_s, "x", x) for at_s, x in ((1e-3, 2.0), (2e-3, 3.0), (25e-4, 4.0))),
    ]
    _, rows = release.walk(Path("a.fmu"), course, MS, 4)
    assert [row[1:] for row in rows] == [[1.0, 0], [1.0, 1], [2.0, 11], [3.0, 12], [4.0, 13]]
    odd = Slave(2 * MS)
    monkeypatch.setattr(release, "load_fmu", lambda *_: odd)
    with pytest.raises(RuntimeError, match="odd"):
        release.walk(Path("a.fmu"), [], MS, 4)
    assert odd.news[-1] == "closed"


EVERY = [one.name for one in PLATFORMS.values() if one.in_all]


@pytest.mark.parametrize(
    ("platforms", "folder", "runs_here"),
    [(EVERY, "all", True), (EVERY[:1], EVERY[0], True), (EVERY[:2], "+".join(EVERY[:2]), False)],
)
def test_an_fmu_is_released_with_what_belongs_beside_it(
    platforms: list[str], folder: str, runs_here: bool, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    walked: list[Any] = []

    def walk(*given: Any) -> Any:
        walked.append(given)
        return ["time", "y"], [[0.0, 1.5]]

    experiment = SimpleNamespace(startTime="0.5", stopTime="2.5", stepSize="0.01", tolerance=None)
    description = SimpleNamespace(
        defaultExperiment=experiment,
        modelVariables=[variable("x", causality="input", start="0.25"), variable("y")],
    )
    monkeypatch.setattr(release, "walk", walk)
    monkeypatch.setattr(release, "load_description", lambda path: (description, path))
    monkeypatch.setattr(release, "ensure_built", lambda model, fmi: Path(f"/{fmi}/{model}"))
    monkeypatch.setattr(release, "courses", lambda: {"L.Own": [Change(1.0, "x", 3.0)]})
    monkeypatch.setattr(release.importlib.metadata, "version", lambda _: "1.2")
    (tmp_path / "built.fmu").write_bytes(b"fmu")
    path = release.release(
        tmp_path / "out", "L.Own", "3.0", platforms, tmp_path / "built.fmu", runs_here=runs_here
    )
    place = tmp_path / "out" / "3.0" / "cs" / folder / "axisrig" / "1.2" / "Own"
    assert (path, path.read_bytes()) == (place / "Own.fmu", b"fmu")
    ((ran, course, step_ns, count),) = walked
    assert ran == (path if runs_here else Path("/3.0/L.Own"))
    assert (course, step_ns, count) == ([Change(1.0, "x", 3.0)], 10 * MS, 200)
    assert (place / "Own_ref.csv").read_text() == '"time","y"\n0.0,1.5\n'
    assert (place / "Own_in.csv").read_text() == (
        '"time","x"\n0.5,0.25\n1.0,0.25\n1.0,3.0\n2.5,3.0\n'
    )
    assert (place / "Own_ref.opt").read_text() == (
        "StartTime, 0.5\nStopTime, 2.5\nStepSize, 0.01\nRelTol, 1e-09\n"
    )


def test_all_models_are_released_and_the_sums_come_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []

    def made(folder: Path, model: str, fmi: str, platforms: Any, fmu: Path, **more: Any) -> Path:
        asked.append((model, fmi, list(platforms), more["runs_here"]))
        return folder / model

    built = [SimpleNamespace(model=name, fmi="3.0", path=Path("x")) for name in ("L.a", "L.b")]
    monkeypatch.setattr(release, "build_models", lambda *_: built)
    monkeypatch.setattr(release, "release", made)
    monkeypatch.setattr(release, "write_sums", lambda folder: folder / "SUMS")
    here = SimpleNamespace(name=EVERY[0])
    monkeypatch.setattr(release, "this_platform", lambda: here)
    for platforms, names, runs_here in (
        ((), [EVERY[0]], True), ((EVERY[0],), [EVERY[0]], True), ((EVERY[1],), [EVERY[1]], False),
        (("all",), EVERY, True),
    ):  # fmt: skip
        asked.clear()
        found = list(release.release_models(tmp_path, None, ["3.0"], platforms))
        assert found == [tmp_path / "L.a", tmp_path / "L.b", tmp_path / "SUMS"]
        assert asked == [(name, "3.0", names, runs_here) for name in ("L.a", "L.b")]


# Descriptions and libraries


@pytest.mark.parametrize(("twice", "odd"), [(0, 0), (2, 0), (0, 2), (8, 9), (1, 1)])
@pytest.mark.parametrize("is_strict", [False, True])
def test_problems_of_a_description_are_counted_by_their_rule(
    twice: int, odd: int, is_strict: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    bad = [f'The variable name "v{n}" (line {n}) is not unique.' for n in range(twice)]
    doubts = [f"odd {n}" for n in range(odd)]
    own = SimpleNamespace(
        generationTool=None, fmiVersion="3.0", modelName="M", modelVariables=[],
        variableNamingConvention="flat",
    )  # fmt: skip
    monkeypatch.setattr(examine, "_version", lambda _: "3.0")
    monkeypatch.setattr(examine, "_read", lambda _: (own, [*bad, *doubts]))
    found = list(examine._description(Path("a"), is_strict=is_strict))
    more = {0: "", 1: "", 2: " (and 1 more)", 8: " (and 7 more)", 9: " (and 8 more)"}
    names = [("FAIL", f"unique-names: {bad[0]}{more[twice]}")] if bad else []
    others = [("FAIL" if is_strict else "warn", f"other: odd 0{more[odd]}")] if odd else []
    tool = "FMI 3.0, model M, by a tool that it does not name"
    end = "" if bad or odd else "; valid"
    assert [(one.level, one.text) for one in found] == [*names, *others, ("ok", tool + end)]


@pytest.mark.parametrize("version", ["", "1.0", "2.0", "3.0", "30"])
def test_versions_two_and_three_are_read(version: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(examine, "_version", lambda _: version)
    own = SimpleNamespace(
        modelVariables=[], variableNamingConvention="flat", generationTool="t", fmiVersion=version,
        modelName="M",
    )  # fmt: skip
    monkeypatch.setattr(examine, "_read", lambda _: (own, ["a problem"]))
    (found, *_) = examine._description(Path("a"), is_strict=False)
    is_known = version in ("2.0", "3.0")
    assert (found.text == "other: a problem") is is_known
    if not is_known:
        assert found.text == f"FMI version {version or 'missing'}"


def test_a_library_in_a_wrong_folder_fails_only_where_it_would_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    good = Binary("x86_64-linux", "m.so", "linux", ("x86_64",))
    wrong = Binary("x86_64-windows", "m.dll", "linux", ("x86_64",))
    own = SimpleNamespace(coSimulation=SimpleNamespace(modelIdentifier="m"), fmiVersion="3.0")

    def found(here: str, *binaries: Binary) -> list[tuple[str, bool]]:
        monkeypatch.setattr(examine, "find_binaries", lambda *_: list(binaries))
        monkeypatch.setattr(examine, "_folder_here", lambda _: here)
        given = examine._binaries(own, Path("a"))  # type: ignore[arg-type]
        return [(one.level, "holds no library" in one.text) for one in given]

    assert found("x86_64-linux", good) == [("ok", False)]
    assert found("x86_64-linux", good, wrong) == [("warn", False), ("ok", False)]
    assert found("x86_64-windows", good, wrong) == [("FAIL", False), ("ok", False)]
    assert found("aarch64-linux", good) == [("FAIL", True), ("ok", False)]
    assert found("aarch64-linux") == [("FAIL", True), ("ok", False)]


def test_clocks_are_named_and_an_fmu_without_outputs_too() -> None:
    kinds: Any = [variable("x", causality="input"), variable("c", causality="input", type="Clock"),
                  variable("d", causality="local", clocks=["c"])]  # fmt: skip
    own: Any = SimpleNamespace(modelVariables=kinds, coSimulation=None)
    found = [one.text for one in examine._variables(own) if one.area == "variables"]
    assert found == [
        "2 inputs, 0 outputs, 0 parameters, 1 locals", "it has no outputs",
        "it needs event mode, which is not there: clocks are not ticked: c, d",
    ]  # fmt: skip
    kinds = [*kinds[:1], variable("y", start="2", max="1")]
    own = SimpleNamespace(modelVariables=kinds, coSimulation=None)
    found = [one.text for one in examine._variables(own) if one.area == "variables"]
    assert found == [
        "1 inputs, 1 outputs, 0 parameters, 0 locals",
        "start outside min .. max: y = 2 (-inf .. 1)",
    ]


def test_an_error_is_a_finding_in_its_own_words(monkeypatch: pytest.MonkeyPatch) -> None:
    error = UserError("odd", value="x", allowed="y", hint="mend it")
    found = examine._failure("archive", error)
    assert (found.text, found.remedy, found.level) == (
        "odd; found x; allowed: y", "mend it", "FAIL",
    )  # fmt: skip
    plain = examine._failure("archive", UserError("odd"))
    assert (plain.text, plain.remedy) == ("odd", "")
    there = Path(__file__)

    def refuse(_: Path) -> None:
        raise error

    monkeypatch.setattr(examine, "inspect", refuse)
    whole = examine.examine(there)
    assert ([one.text for one in whole.findings], whole.sha256, whole.can_run) == (
        ["odd; found x; allowed: y"], "", False,
    )  # fmt: skip


def test_signs_that_steer_a_terminal_are_shown_and_not_sent_at_any_level() -> None:
    """What an FMU says of itself may have them; a colour would hide a FAIL."""
    for make, word in ((ok, "ok"), (warn, "warn"), (fail, "FAIL")):
        found = make("messages", "a\x1b[2Jb\x07c")
        assert found.level == word
        assert found.text.isprintable()
        assert found.text[0] + found.text[-1] == "ac"
        assert "[2Jb" in found.text


def test_text_of_others_stays_a_text_in_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    show_findings([ok("a", "[bold]x[/bold] :smile:"), warn("b", "y", "mend it")], "a.fmu")
    out = capsys.readouterr().out
    lines = out.splitlines()
    assert lines[0].rstrip() == "a.fmu"
    assert "[bold]x[/bold] :smile:" in out
    row = next(line for line in lines if "mend it" in line)
    assert [cell.strip() for cell in row.strip("\u2502").split("\u2502")] == [
        "b", "warn", "y", "mend it",
    ]  # fmt: skip
