"""Numbers and indices of parameters: older names, the order of what was set, what is near."""

from collections.abc import Callable

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import Kind, Origin, ParameterSet, start_up, table

Listed = Callable[..., ParameterSet]
Refused = Callable[..., UserError]
HERE = Origin("list.lst", 1)


def holding(kind: Kind, *paths: str) -> ParameterSet:
    parameters = ParameterSet(kind)
    for path in paths:
        parameters.load(path, "1", HERE)
    return parameters


@pytest.mark.parametrize(
    ("older", "present"),
    [
        ("trafo[3].id", "kin_step[0].trafo[3].id"),
        ("trafo[2].param[5]", "kin_step[0].trafo[2].param[5]"),
        ("trafo[1].axis[2].point[0]", "kin_step[0].trafo[1].axis[2].point[0]"),
        ("kin_step[1].trafo[3].id", "kin_step[1].trafo[3].id"),
    ],
)
def test_the_index_that_an_older_name_lacks_is_the_first_one(older: str, present: str) -> None:
    assert [path for path, _ in holding("channel", older).items()] == [present]


def test_what_was_set_is_listed_one_function_after_the_other() -> None:
    """In whatever order it was set: the function counts before the column, 10 comes after 9."""
    names = ("id", "wr_ident[0]", "wr_ident[1]", "rd_ident")
    paths = [f"antr.function[{at}].{name}" for at in (0, 2, 9) for name in names]
    for order in (paths, paths[::-1], sorted(paths, key=lambda path: path[::-1])):
        assert [path for path, _ in holding("axis", *order).items()] == paths


def test_what_has_no_index_is_in_the_order_of_the_table() -> None:
    paths = [row.path for row in table("axis").parameters
             if "[" not in row.path and not row.values][:12]  # fmt: skip
    assert [path for path, _ in holding("axis", *paths[::-1]).items()] == paths


@pytest.mark.parametrize(
    ("number", "path"),
    [
        ("P-AXIS-00118", "kenngr.messachse"), ("p-axis-00118", "kenngr.messachse"),
        ("P-AXIS-118", "kenngr.messachse"), ("p-axis-118", "kenngr.messachse"),
        ("P-CHAN-57", None), ("P-AXIS-99999", None), ("P-AXIS-", None), ("P-AXIS-001180", None),
        ("X P-AXIS-00118", None), ("kenngr.messachse", None),
    ],
)  # fmt: skip
def test_a_number_is_known_in_either_case_and_without_its_zeros(
    number: str, path: str | None
) -> None:
    row = table("axis").numbered(number)
    assert (None if row is None else row.path) == path


@pytest.mark.parametrize(
    ("kind", "number", "name"),
    [
        ("axis", "P-AXIS-00118", "`kenngr.messachse`"),
        ("axis", "p-axis-118", "`kenngr.messachse`"),
        ("axis", "P-CHAN-00057", "`messtyp`, a parameter of the channel"),
        ("channel", "P-CHAN-00057", "`messtyp`"),
        ("channel", "P-AXIS-00118", "`kenngr.messachse`, a parameter of the axis"),
        ("axis", "P-EXTV-00010",
         "`number_used_variables`, a parameter of the list of external variables"),
        ("axis", "P-STUP-00005", "`mds_time_slots`, a parameter of the start-up list"),
    ],
)  # fmt: skip
def test_a_number_in_place_of_a_name_says_whose_it_is(
    refused: Refused, kind: Kind, number: str, name: str
) -> None:
    error = refused(f"{number} 1\n", kind)
    assert error.hint == f"it is the number of {name}; lists and plans take the name"
    assert (error.value, error.message) == (number, f"unknown {kind} parameter")


def test_a_number_that_no_parameter_has_is_refused_as_such(refused: Refused) -> None:
    hint = "no parameter of this number is known; `axisrig params` lists them"
    assert refused("P-AXIS-99999 1\n").hint == hint


def test_a_name_that_is_near_nothing_says_how_to_look(refused: Refused) -> None:
    hint = "no name is near it; `axisrig params WORD` finds names by what they mean"
    assert refused("qqqqqq 1\n").hint == hint


def test_warnings_are_in_the_order_of_their_names(listed: Listed) -> None:
    lines = ("kenngr.dist_ctrl[0].v_max 0", "kenngr.dist_ctrl[0].kp 9",
             "kenngr.dist_ctrl[0].n_cycles 100", "kenngr.dist_ctrl[0].i_tn 99")  # fmt: skip
    for order in (lines, lines[::-1]):
        warnings = start_up(listed("\n".join(order)), "Z")
        assert [warning.id for warning in warnings] == [315011, 315010, 315002, 315000]
        assert [warning.place for warning in warnings] == [
            f"list.lst:{1 + order.index(lines[at])}" for at in (3, 1, 2, 0)
        ]


def test_a_copy_has_the_warnings_of_what_it_was_made_of() -> None:
    """Rows share lists that are read once: each of them is warned."""
    read = ParameterSet("axis")
    read.load("kenngr.dist_ctrl[0].kp", "9", HERE)
    copy = read.copied()
    copy.load("kenngr.dist_ctrl[0].i_tn", "99", HERE)
    assert [item.alarm_id for item in copy.corrected()] == [315011, 315010]
    assert [item.alarm_id for item in read.corrected()] == [315010]


@pytest.mark.parametrize("kind", ["channel", "external", "startup"])
def test_nothing_but_an_axis_is_rotary(kind: Kind) -> None:
    assert not ParameterSet(kind).is_rotary


@pytest.mark.parametrize(
    ("path", "text"),
    [("getriebe[0].wegaufz", "0"), ("getriebe[0].wegaufz", "4294967296"),
     ("filter[0].order", "201"), ("lr_hw[0].vz_stellgr", "2")],
)  # fmt: skip
def test_what_does_not_act_has_its_range_in_a_cell_too(path: str, text: str) -> None:
    """What nobody could write into a list is no value that will act one day."""
    with pytest.raises(UserError, match="is outside its range") as caught:
        ParameterSet("axis").set(path, text, "set:Z")
    assert (caught.value.file, caught.value.value) == ("set:Z", text)


@pytest.mark.parametrize(
    ("kind", "path", "allowed"),
    [
        ("axis", "kenngr.hub_messtaster", "0 .. 4294967295 0.1 um"),
        ("axis", "kenngr.messachse", "0 .. 1"),
        ("axis", "kenngr.measure.edge", "POS, NEG"),
        ("axis", "kopf.log_achs_name", "one word"),
        ("axis", "antr.function[0].scaling_factor", "any number"),
        ("axis", "kenngr.dist_ctrl[0].kalman_sigma", "at least 0.0"),
        ("axis", "kenngr.dist_ctrl[0].low_pass_filter_fg_f0", "at least 0.0 Hz"),
        ("axis", "kenngr.dist_ctrl[0].kp", "above 0.0, up to 2.0"),
    ],
)
def test_what_is_allowed_has_its_limits_and_its_unit(kind: Kind, path: str, allowed: str) -> None:
    assert table(kind).find(path)[0].allowed == allowed
