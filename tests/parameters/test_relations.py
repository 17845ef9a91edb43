"""Limits between parameters: what the pages print as the range of one is another one."""

import pytest

from axisrig.kernel.parameters import Origin, ParameterSet, start_up
from axisrig.kernel.parameters.relations import AT_MOST, noted, relations

VB_MAX, A_MAX = "getriebe[0].dynamik.vb_max", "getriebe[0].dynamik.a_max"


def axis(**settings):
    parameters = ParameterSet("axis")
    for path, value in settings.items():
        parameters.set(path, str(value), "list")
    return parameters


def settings_of(row, by):
    """A list in which a value is off its limit by so much, inside (below 0) or outside."""
    limit = 4000
    return {row.limit: limit, row.path: limit + (by if row.relation == AT_MOST else -by)}


@pytest.mark.provokes(
    900522,
    1,
    axis="Z",
    setting="kenngr.vb_messen (P-AXIS-00215) = 600000 um/s",
    relation="at most",
    limit="getriebe[0].dynamik.vb_max (P-AXIS-00212) = 500000 um/s",
)
def test_900522_for_a_measuring_speed_above_that_of_the_axis():
    """FCT-C4 8.2.2: 1 to P-AXIS-00212."""
    parameters = axis(**{"kenngr.vb_messen": 600_000, VB_MAX: 500_000})
    assert [warning.id for warning in start_up(parameters, "Z")] == [900522]
    assert parameters.integer("kenngr.vb_messen") == 500_000


def test_a_speed_counts_against_the_default_of_its_limit():
    parameters = axis(**{"kenngr.vb_messen": 200_001})
    assert [warning.id for warning in start_up(parameters, "Z")] == [900522]
    assert start_up(axis(**{"kenngr.vb_messen": 200_000}), "Z") == []


@pytest.mark.parametrize("row", relations(), ids=lambda row: row.path)
def test_each_relation_holds_at_its_limit_and_not_past_it(row):
    for by, is_broken in ((-1, False), (0, False), (1, True)):
        parameters = axis(**settings_of(row, by))
        value = parameters.integer(row.path)
        assert row.is_broken(parameters) is is_broken
        assert bool(noted(parameters)) is (is_broken and not row.is_corrected)
        warnings = start_up(parameters, "Z")
        assert bool(warnings) is (is_broken and row.is_corrected)
        assert parameters.integer(row.path) == (4000 if warnings else value)


def test_what_nobody_set_is_not_judged():
    """Accelerations above the default of P-AXIS-00008, which does not act; a default speed."""
    high = axis(**{"getriebe[0].lslope_profil.a_stufe_1": 5000})
    assert noted(high) == []
    assert start_up(high, "Z") == []
    slow = axis(**{VB_MAX: 100})
    assert start_up(slow, "Z") == []


def test_one_line_for_each_limit():
    ramp = "getriebe[0].lslope_profil.a_stufe_"
    (line,) = noted(axis(**{f"{ramp}1": 900, f"{ramp}2": 800, A_MAX: 500}))
    assert "P-AXIS-00011) = 900 mm/s2, " in line
    assert "P-AXIS-00012) = 800 mm/s2: to be at most" in line


def test_900522_has_the_place_of_the_setting():
    """File and line of a list; what a plan has set has no line, and is named whole."""
    for origin, place in (
        (Origin("/lists/z.lst", 7, 3), "z.lst:7"),
        (Origin("set:Z.kenngr.vb_messen"), "set:Z.kenngr.vb_messen"),
        (Origin("plans/a.csv: set:Z"), "plans/a.csv: set:Z"),
    ):
        parameters = ParameterSet("axis")
        parameters.set(VB_MAX, "500000", "list")
        parameters.set("kenngr.vb_messen", "600000", origin)
        (warning,) = start_up(parameters, "Z")
        assert (warning.id, warning.place) == (900522, place)


@pytest.mark.parametrize("kind", ["channel", "external", "startup"])
def test_other_lists_have_no_relations(kind):
    assert noted(ParameterSet(kind)) == []
