"""The changes of a field from an instant on."""

import numpy as np

from axisrig.bench.judge.distance.times import changes
from axisrig.bench.oracles.distance.cycles import Sent
from axisrig.bench.record.series import Telegrams


def test_a_value_at_the_very_instant_is_not_before_it() -> None:
    """The last value before the instant comes first, then the one at the instant."""
    sent = Telegrams(np.array([10, 20, 30, 40], np.int64), np.array([1, 2, 2, 3], np.int64))
    assert list(changes([sent], 20)) == [Sent(10, 1), Sent(20, 2), Sent(40, 3)]
