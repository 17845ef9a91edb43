"""Several words of a block that need the same: the first is named, and the block waits once."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import EndOfProgram, LinearMove, Message, TechnologyFunction, Wait


@pytest.mark.parametrize(
    ("block", "word"),
    [
        ("G41 G93 X1", "G41"),
        ("G93 G42 X1", "G93"),
        ("E5 X1 G93", "E"),
        ("G93 X1 E5", "G93"),
        ("S5 X1 E5", "S"),
        ("X=SIZEOF[P1] G41", "SIZEOF"),
    ],
)
def test_of_words_that_do_not_act_the_first_is_named(run, block, word):
    with pytest.raises(Alarm) as caught:
        run(f"G0 X1\nN20 {block}")
    assert (caught.value.id, caught.value.values["word"]) == (900100, word)
    assert caught.value.place == "test.nc line 2, block N20"


@pytest.mark.parametrize(
    ("block", "kinds"),
    [
        ('#MSG SYN ["%g", V.A.ACT_POS.X]', [Wait, Message]),
        ('#MSG SYN ["at %g", 1]', [Wait, Message]),
        ('#MSG ["%g", V.A.ACT_POS.X]', [Wait, Message]),
        ('#MSG ["%g %g", V.A.ACT_POS.X, V.A.MERF.Y]', [Wait, Message]),
        ('#MSG ["%g", V.A.ABS.X]', [Message]),
        ("#FLUSH WAIT", [Wait]),
        ("G0 X=V.A.ACT_POS.X+1 Y=V.A.ACT_POS.Y", [Wait, LinearMove]),
        ("H=V.A.ACT_POS.X T=V.A.ACT_POS.X", [Wait, TechnologyFunction, TechnologyFunction]),
        ("P1=V.A.ACT_POS.X P2=V.A.ACT_POS.Y", [Wait, Wait]),  # two assignments are two
    ],
)
def test_a_block_waits_once_for_what_it_reads_and_what_it_is(run, block, kinds):
    commands = [c for c in run(f"G0 X1\n{block}") if c.block.line == 2]
    assert [type(each) for each in commands if not isinstance(each, EndOfProgram)] == kinds
    assert not any(each.for_cycle for each in commands if isinstance(each, Wait))


@pytest.mark.parametrize("other", ["P1", "V.A.ABS.X", "V.A.ACT_POS.X", "V.A.MERF.Z"])
@pytest.mark.parametrize("before", [True, False])
def test_what_the_plc_side_has_is_read_in_the_next_cycle_beside_anything(run, other, before):
    values = f"{other}, V.E.N" if before else f"V.E.N, {other}"
    text = f'P1=1\n#MSG ["%g %g", {values}]'
    first, message, _ = run(text, external={"N": 7.0})
    assert isinstance(first, Wait)
    assert first.for_cycle
    assert isinstance(message, Message)
    assert message.text.split()[1 if before else 0] == "7"
