"""Random programs: no set position that goes into the buffer passes what its axis may do."""

import pytest
from tests.channel import random_programs


@pytest.mark.parametrize("seed", range(4))
def test_no_set_position_of_a_random_program_passes_a_limit(seed: int) -> None:
    machine = random_programs.run(seed)
    assert machine.passed is None, machine.text
    assert machine.refused is None, machine.text


@pytest.mark.long
@pytest.mark.parametrize("block", range(10))
def test_no_set_position_of_many_random_programs_passes_a_limit(block: int) -> None:
    for seed in range(30 * block, 30 * block + 30):
        machine = random_programs.run(seed)
        assert machine.passed is None, (seed, machine.text)
