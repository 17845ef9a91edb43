"""The columns `acts` of the tables say what the decoder does."""

import pytest

from axisrig.kernel.nc.decoder import registry
from axisrig.kernel.nc.expressions import FUNCTIONS
from axisrig.kernel.nc.text.words import commands, variables, words

AXIS = "<axis>"
# Handled while the text is read or by the order of blocks, not by a handler of their own
BY_THE_TEXT = {"VAR", "ENDVAR", "COMMENT BEGIN", "COMMENT END", "L CYCLE"}
MOTION = {"G0", "G1", "G90", "G91"}


def test_every_g_function_that_acts_has_a_handler():
    handled = {*registry.SETTINGS, *registry.TAKES_AXES, *MOTION}
    acting = {name for name, word in words("G").items() if word.acts}
    assert acting - handled == set()


@pytest.mark.parametrize("name", [name for name in commands() if name not in BY_THE_TEXT])
def test_a_command_acts_if_the_decoder_has_a_handler(name):
    acts = commands()[name][""].acts
    if name.startswith(AXIS):
        assert not acts or name.removeprefix(AXIS) in registry.AXIS_COMMANDS
    else:
        assert not acts or name in registry.COMMANDS


def test_every_function_that_acts_is_computed():
    acting = {name for name, word in words("function").items() if word.acts}
    assert acting - {*FUNCTIONS, "NOT", "SIZEOF", "EXIST"} == set()


def test_no_keyword_stands_twice_and_every_row_says_what_it_means():
    for name, table in commands().items():
        assert "" in table, name
        for row in table.values():
            assert row.meaning
            assert row.source


@pytest.mark.parametrize("row", [row for row in variables() if row.acts], ids=lambda row: row.name)
def test_every_variable_that_acts_is_read_by_somebody(row):
    stem = row.name.partition("<")[0].rstrip(".")
    assert any(reader.startswith(stem) or stem.startswith(reader) for reader in registry.READERS)
