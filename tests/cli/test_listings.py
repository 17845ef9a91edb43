"""What `metrics`, `language`, `oracles`, `doctor`, `params` and `perf --against` print."""

import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.plan.checks import known_metrics
from axisrig.bench.plan.statistic_checks import known_statistics
from axisrig.bench.tools.listings import alarms, doctor
from axisrig.bench.tools.listings import language as words
from axisrig.bench.tools.listings import oracles as closed_forms
from axisrig.bench.tools.listings.alarms import alarm_listing
from axisrig.bench.tools.listings.language import language_listing
from axisrig.bench.tools.listings.metrics import metrics_table
from axisrig.bench.tools.listings.oracles import oracle_listing, oracles
from axisrig.bench.tools.params.effective import difference_text, written_lists
from axisrig.bench.tools.perf.gains import gain, gains, gains_table, read_result, show_gains
from axisrig.bench.tools.project.new import new_project
from axisrig.kernel.errors import UserError, catalogue
from axisrig.kernel.nc.text.published import published
from axisrig.kernel.nc.text.words import commands, examples

# Metrics


def message(text: str) -> dict[str, str]:
    """Each first line with what is indented below it, in one line."""
    found: dict[str, str] = {}
    for line in text.splitlines():
        if line and not line.startswith(" "):
            found[last := line] = ""
        elif line:
            found[last] = f"{found[last]} {line.strip()}".strip()
            assert line.startswith("    ") is not line.startswith("     ")
    return found


def without_spaces(text: str) -> str:
    """A line may end after a hyphen."""
    return "".join(text.split())


def test_each_metric_has_its_form_its_unit_and_which_run_it_judges() -> None:
    shown = message(metrics_table())
    assert "latch_mm[:AXIS]  mm" in shown
    assert "alarms" in shown
    for metric in known_metrics().values():
        form = {"axis": "[:AXIS]", "block": ":N<number>[.<k>]"}.get(metric.scope, "")
        judged = {"last": ". Of several runs: the last", "every": ". Of several runs: the worst",
                  "": ""}[metric.judged]  # fmt: skip
        judged += " of the axis" if metric.judged and metric.scope == "axis" else ""
        found = shown[f"{metric.name}{form}  {metric.unit}".rstrip()]
        assert without_spaces(found) == without_spaces(metric.meaning + judged)
    for row in known_statistics().values():
        unit = {"metric": "[unit of the metric]", "": ""}.get(row.unit, f"[{row.unit}]")
        text = f"{row.meaning}. {row.formula}; uncertainty {row.uncertainty}. {row.source}"
        found = shown[f"{row.form}  {unit}".rstrip()]
        assert without_spaces(found) == without_spaces(text)


# Words of the language


def test_a_word_by_its_name_comes_alone_with_its_keywords_and_its_example() -> None:
    """`#MEAS MODE` has it in its name too."""
    lines = language_listing("meas").splitlines()
    assert language_listing("#Meas").splitlines() == lines
    assert lines[0].startswith("#MEAS  ")
    own = [line.split()[0].partition("=")[0] for line in lines[1:]]
    table = {key: row for key, row in commands()["MEAS"].items() if key}
    assert own[: len(table)] == list(table)
    assert {"TYPE", "TRIGGER"} <= set(own)  # one that acts and one that does not
    for line, row in zip(lines[1:], table.values(), strict=False):
        assert ("(-) " in line) is not bool(row.acts)
        assert line.endswith(row.meaning)
    text, page = examples()["#MEAS"]
    first, *others = text.splitlines()
    rest = [f"    example: {first}", *(f"             {line}" for line in others)]
    assert lines[1 + len(table) :] == [*rest, f"    see {page}"]


@pytest.mark.parametrize(("most", "has_keywords"), [(2, True), (1, False)])
def test_of_many_words_each_has_one_line(
    most: int, has_keywords: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(words, "_lines", lambda: [("#A X", True, "one"), ("#A Y", False, "two")])
    monkeypatch.setattr(words, "_keyword_lines", lambda name: [f"    of {name}"])
    monkeypatch.setattr(words, "_example_lines", lambda name: [f"    as {name}"])
    monkeypatch.setattr(words, "_FEW", most)
    found = [line.strip() for line in language_listing("a").splitlines()]
    beside = {name: [f"of {name}", f"as {name}"] * has_keywords for name in ("#A X", "#A Y")}
    assert found == [
        f"{'#A X':<32} one", *beside["#A X"], f"{'#A Y':<32} (-) two", *beside["#A Y"],
    ]  # fmt: skip
    assert language_listing("#a x").splitlines()[0] == f"{'#A X':<32} one"
    assert len(language_listing("#a x").splitlines()) == 3


def test_the_example_of_a_word_with_two_rows_comes_once(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [("G4", True, "first"), ("G4", True, "second"), ("G40", True, "third")]
    monkeypatch.setattr(words, "_lines", lambda: rows)
    monkeypatch.setattr(words, "_keyword_lines", lambda _: [])
    monkeypatch.setattr(words, "_example_lines", lambda name: [f"example of {name}"])
    assert [line.split()[-1] for line in language_listing("g4").splitlines()] == [
        "first", "second", "G4",
    ]  # fmt: skip
    with pytest.raises(UserError) as caught:
        language_listing("G41")
    assert "G4" in str(caught.value.allowed)


def test_a_published_word_says_whether_it_may_be_passed_over() -> None:
    lines = language_listing().splitlines()
    for name, known in published().items():
        end = "; may be passed over" if known.passed_over else ""
        assert f"{name:<32} (-) {known.meaning}{end}" in lines
        assert language_listing(name).splitlines()[0] in lines
    assert {bool(known.passed_over) for known in published().values()} == {True, False}


def test_a_keyword_is_shown_with_its_choices_its_kind_or_alone() -> None:
    kinds = set()
    for name, table in commands().items():
        shown = name if name.startswith("L ") else f"#{name}"
        if name.startswith("<axis>"):
            shown = f"<axis>[{name[6:]}]"
        own = [row for keyword, row in table.items() if keyword]
        lines = [line[4:].split()[0] for line in language_listing(shown).splitlines()[1:]]
        assert len(lines) >= len(own), name
        for row, line in zip(own, lines, strict=False):  # examples come after the keywords
            what = "|".join(row.allowed.split()) if row.kind == "name" and row.allowed else row.kind
            assert line == (row.keyword if row.kind == "flag" else f"{row.keyword}={what}")
            kinds.add(row.kind)
    assert {"flag", "name"} < kinds


# Closed forms


def test_all_closed_forms_have_a_line_with_their_first_words() -> None:
    lines = oracle_listing().splitlines()
    assert "distance.acting" in lines
    for one in oracles():
        first = " ".join(one.text.partition("\n\n")[0].split())
        assert f"  {one.name:<28} {first}" in lines
    for place in {one.place for one in oracles()}:
        assert place in lines


def test_a_closed_form_by_its_name_comes_alone_and_names_its_origin_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    every = oracles()
    monkeypatch.setattr(closed_forms, "oracles", lambda: every)
    assert {one.origin in one.text for one in every} == {True, False}
    for one in every:
        shown = oracle_listing(f"{one.place}.{one.name}")
        blocks = shown.count(f"{one.place}.{one.name}\n\n")
        assert blocks == 1, one.name
        assert one.text in shown
        if one.origin in one.text:
            assert shown == f"{one.place}.{one.name}\n\n{one.text}"
        else:
            assert shown == f"{one.place}.{one.name}\n\n{one.text}\n\n{one.origin}"


# Alarms


def test_ids_that_are_near_are_few_and_say_what_they_are() -> None:
    ids = sorted(catalogue())
    gap = next(i for i in range(ids[0] + 1, ids[-1]) if i not in catalogue() and i + 1 in ids)
    with pytest.raises(UserError) as caught:
        alarm_listing(str(gap))
    near = str(caught.value.allowed)
    assert f"{gap + 1} (" in near
    assert 1 <= sum(f"{i} (" in near for i in ids) <= 4


def test_of_ids_beside_one_the_two_nearest_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = {i: SimpleNamespace(text=f"says {i}") for i in (10_000, 10_003, 10_004, 10_006, 50_000)}
    monkeypatch.setattr(alarms, "catalogue", lambda: texts)
    monkeypatch.setattr(alarms, "nearest", lambda *_: [])
    assert list(alarms._near(10_005)) == ["10004 (says 10004)", "10006 (says 10006)"]
    assert list(alarms._near(50_001)) == ["50000 (says 50000)"]  # the other one is far away
    assert list(alarms._near(90_000)) == []
    assert list(alarms._near(9_500)) == ["10000 (says 10000)"]  # 500 are near, 501 are not
    assert list(alarms._near(9_499)) == []
    # Those that look alike come first, four at most, each once
    alike = ["50000", "10000", "10006"]
    monkeypatch.setattr(alarms, "nearest", lambda *_: alike)
    assert [text.split()[0] for text in alarms._near(10_005)] == [*alike, "10004"]
    alike.insert(0, "10003")
    assert [text.split()[0] for text in alarms._near(10_005)] == alike


def test_a_legend_counts_what_is_listed() -> None:
    lines = alarm_listing(reaction_class=5).splitlines()
    rows = [line for line in lines if line[:6].strip().isdigit()]
    assert rows
    assert len(rows) == sum(entry.reaction_class == 5 for entry in catalogue().values())
    assert f"{len(rows)} of {len(catalogue())}." in lines[-2]
    for row in rows:
        assert row[8] == "5"


# What is here


@pytest.mark.parametrize(
    ("cc", "zig", "is_well", "begins"),
    [
        ("/bin/cc", True, True, ["ok    C compiler /bin/cc", "ok    C compiler ziglang 1.2"]),
        (None, True, True, ["ok    C compiler ziglang 1.2"]),
        ("/bin/cc", False, True,
         ["ok    C compiler /bin/cc", "info  FMUs for other platforms need ziglang: pip install"]),
        (None, False, False, ["LACKS C compiler: install a system cc, or pip install"]),
    ],
)  # fmt: skip
def test_one_compiler_is_enough(
    cc: str | None, zig: bool, is_well: bool, begins: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for omc in (None, "/bin/omc"):
        here = {"cc": cc, "omc": omc}
        monkeypatch.setattr(doctor, "shutil", SimpleNamespace(which=here.get))
        monkeypatch.setattr(doctor, "find_spec", lambda _: zig or None)
        monkeypatch.setattr(doctor, "metadata", SimpleNamespace(version=lambda _: "1.2"))
        lines = doctor._compilers(is_needed=True)
        assert any(line.startswith(doctor.LACK) for line in lines) is not is_well
        also = ["info  OpenModelica /bin/omc (fmu build --compiler omc)"] if omc else []
        assert len(lines) == len(begins) + len(also)
        for line, begin in zip(lines, [*begins, *also], strict=True):
            assert line.startswith(begin)


def test_each_can_interface_is_here_or_says_what_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = (("a", "one", "x"), ("b", "b", ""), ("c", "c", "a driver"))
    about = {name: SimpleNamespace(about=of, needs=needs) for name, of, needs in rows}
    lacks = {"b": "no module", "c": "no library", "e": "no"}
    monkeypatch.setattr(doctor, "known_interfaces", lambda: about)
    monkeypatch.setattr(doctor, "usable", lacks.get)
    monkeypatch.setattr(doctor, "interface_names", lambda: ["a", "c", "d", "e", doctor.SIMULATED])
    assert doctor._interfaces() == [
        "ok    CAN interface a: one",
        "info  CAN interface b not here: no module",
        "info  CAN interface c not here: no library; needs: a driver",
        "info  further CAN interfaces, drivers not looked for: d",
    ]
    monkeypatch.setattr(doctor, "interface_names", lambda: ["a"])
    assert doctor._interfaces()[-1].endswith("not looked for: none")


@pytest.mark.parametrize("lack", ["", "package", "model"])
def test_a_part_that_is_missing_is_named_and_leftovers_are_no_lack(
    lack: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def version(name: str) -> str:
        if lack == "package" and name == "canopen":
            raise doctor.metadata.PackageNotFoundError(name)
        return "1.2"

    def built(model: str) -> Path:
        if lack == "model" and model == doctor.MODELS[0]:
            raise doctor.BuildError(None, None, "no compiler")
        return Path(f"/x/{model}.fmu")

    monkeypatch.setattr(doctor.metadata, "version", version)
    monkeypatch.setattr(doctor, "ensure_built", built)
    monkeypatch.setattr(doctor, "_compilers", lambda *, is_needed: ["ok    C compiler"])
    monkeypatch.setattr(doctor, "_interfaces", lambda: ["ok    CAN interface"])
    monkeypatch.setattr(doctor, "leftovers", lambda: ["an older one"])
    lines = list(doctor.examine(is_building=True))
    assert sum(line.startswith(doctor.LACK) for line in lines) == bool(lack)
    assert {"ok    C compiler", "ok    CAN interface", "OLD   an older one"} <= set(lines)
    assert len([line for line in lines if line.startswith("ok    ")]) == (
        3 + len(doctor.PACKAGES) + len(doctor.MODELS) - bool(lack)
    )


# Parameters


RIG = Path(__file__).parents[2] / "testplans" / "rigs"


def test_two_rigs_differ_in_keys_of_either_and_files_count_by_their_content(
    tmp_path: Path,
) -> None:
    for name in ("a", "b"):
        shutil.copytree(RIG / "lists", tmp_path / name / "lists")
        text = (RIG / "probe-z.toml").read_text(encoding="utf-8")
        (tmp_path / name / "r.toml").write_text(text, encoding="utf-8")
    left, right = (tmp_path / name / "r.toml" for name in ("a", "b"))
    assert difference_text(left, right) == ("no difference", False)
    text = left.read_text(encoding="utf-8").replace("surface_mm = 100 ", "surface_mm = 101 ")
    left.write_text(text.replace("[cycle]", "[realtime]\nlate_us = 7.0\n[cycle]"), encoding="utf-8")
    for pair, surface, late in (((left, right), "101 -> 100", "7.0 -> 100.0"),
                                ((right, left), "100 -> 101", "100.0 -> 7.0")):  # fmt: skip
        found, differs = difference_text(*pair)
        assert differs is True
        assert found.splitlines()[2:] == [
            f"plant.probe.start.surface_mm: {surface}", f"realtime.late_us: {late}",
        ]  # fmt: skip


def test_a_key_of_one_rig_alone_and_a_list_of_another_content_are_differences(
    tmp_path: Path,
) -> None:
    """Lists of parameters are compared by their values, those of tools by their bytes."""
    for name, tool in (("a", "1"), ("b", "2")):
        shutil.copytree(RIG / "lists", tmp_path / name / "lists")
        (tmp_path / name / "t.lst").write_text(f"wz[{tool}].gueltig 1\n", encoding="utf-8")
        text = (RIG / "probe-z.toml").read_text(encoding="utf-8")
        text = text.replace("[channel]", '[channel]\ntools = "t.lst"')
        (tmp_path / name / "r.toml").write_text(text, encoding="utf-8")
    left, right = (tmp_path / name / "r.toml" for name in ("a", "b"))
    (line,) = difference_text(left, right)[0].splitlines()[2:]
    assert line.startswith("channel.tools: t.lst (SHA-256 ")
    (tmp_path / "b" / "t.lst").write_text("wz[1].gueltig 1\n", encoding="utf-8")
    assert difference_text(left, right) == ("no difference", False)
    text = right.read_text(encoding="utf-8").replace('tools = "t.lst"', "")
    right.write_text(text, encoding="utf-8")
    found = [difference_text(*pair)[0].splitlines()[2:] for pair in ((left, right), (right, left))]
    assert [line for (line,) in found if line.endswith(" -> not set")]
    assert [line for (line,) in found if line.startswith("channel.tools: not set -> t.lst")]


def test_lists_of_a_rig_name_the_axis_that_a_list_does_not(tmp_path: Path) -> None:
    rig = RIG / "probe-z.toml"
    text = written_lists(rig, None, [])
    assert text.count("kopf.log_achs_name") == 1
    assert "kopf.log_achs_name" in written_lists(rig, "Z", [])
    assert "kopf.log_achs_name" not in written_lists(rig, "channel", [])
    named = written_lists(rig, "Z", ["set:Z.kopf.log_achs_name=W"])
    assert [line.split()[1] for line in named.splitlines() if "log_achs_name" in line] == ["W"]


# A measurement beside an earlier one


@pytest.mark.parametrize(
    ("now", "before", "more", "less"),
    [(20.0, 10.0, 2.0, 0.5), (10.0, 20.0, 0.5, 2.0), (0.0, 10.0, None, None),
     (10.0, 0.0, None, None), (None, 1.0, None, None), (1.0, None, None, None),
     (-1.0, 1.0, None, None)],
)  # fmt: skip
def test_a_gain_above_1_is_better(
    now: float | None, before: float | None, more: float | None, less: float | None
) -> None:
    assert gain(now, before, is_more_better=True) == more
    assert gain(now, before, is_more_better=False) == less


def test_gains_are_of_one_row_and_each_number_has_its_direction() -> None:
    now: Any = {"case": "a", "real_time_factor": 20.0, "cpu_factor": 6.0, "cpu_s": 2.0,
                "beyond_simulation_ms": 50.0, "frame_log_sha256": "1"}  # fmt: skip
    before = {**now, "real_time_factor": 10.0, "cpu_factor": 3.0, "cpu_s": 1.0,
              "beyond_simulation_ms": 100.0}  # fmt: skip
    assert gains(now, before) == {
        "real_time_factor": 2.0, "cpu_factor": 2.0, "cpu_s": 0.5, "beyond_simulation_ms": 2.0,
    }  # fmt: skip
    with pytest.raises(UserError, match="not the same row"):
        gains(now, {**before, "case": "b"})
    assert "frames differ" not in show_gains(now, before)
    assert show_gains(now, {**before, "frame_log_sha256": "2"}).endswith("frames differ: a")
    assert "frames differ" not in show_gains(
        now, {key: value for key, value in before.items() if key != "frame_log_sha256"}
    )
    for word in ("compiled", "interpreted"):
        build = {"compiled": word == "compiled", "sources_sha256": "cd"}
        message = show_gains(now, {**before, **build})
        assert f"the file: axisrig {word}, sources cd" in message.splitlines()
    assert "the file" not in show_gains(now, before).partition("\n")[2]  # of an older release
    lines = gains_table({"long name": 2.0, "x": None}, {}, ["r"]).splitlines()
    assert lines[1:3] == ["  long name  2.00", "  x          -"]
    assert lines[-1] == "frames differ: r"


@pytest.mark.parametrize("text", ["", "[]", '"real_time_factor"', "{}", '["real_time_factor"]'])
def test_what_is_no_result_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match="no result of axisrig perf"):
        read_result(path)


def test_a_new_project_is_written_into_what_is_empty(tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    made = new_project(empty)
    assert sorted(made) == sorted(path for path in empty.rglob("*") if path.is_file())
    assert [path.relative_to(empty) for path in made] == [
        path.relative_to(tmp_path / "new") for path in new_project(tmp_path / "new")
    ]
    file = tmp_path / "file"
    file.touch()
    for place in (file, empty):
        with pytest.raises(UserError, match="the folder is not empty"):
            new_project(place)


def test_elements_and_parameters_that_one_list_alone_sets_are_differences(tmp_path: Path) -> None:
    """Whichever of them is the first, in the order of the page; beside one that both have set."""
    left, right = (tmp_path / f"{name}.lst" for name in "ab")
    shared = "kopf.achs_nr 1\nkopf.log_achs_name Z\ngetriebe[0].vb_eilgang 60000\n"
    left.write_text(f"{shared}getriebe[2].window 70\n", encoding="utf-8")
    own = {
        "getriebe[1].vb_eilgang": 40000, "getriebe[2].vb_eilgang": 50000,
        "getriebe[2].window": 80, "kenngr.messachse": 1,
    }  # fmt: skip
    lines = "".join(f"{key} {value}\n" for key, value in own.items())
    right.write_text(shared + lines, encoding="utf-8")
    for pair, turn in (((left, right), 1), ((right, left), -1)):
        text, differs = difference_text(*pair)
        found = [line.removeprefix("Z: ").split(": ") for line in text.splitlines()[2:]]
        assert differs
        assert [key for key, _ in found] == [*own]
        for key, values in found:
            other, shown = values.split(" -> ")[::turn]
            assert shown.split()[0] == str(own[key])
            assert key != "getriebe[2].window" or other.split()[0] == "70"
