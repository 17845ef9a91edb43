"""Series whose disk becomes full: nothing of them is left, whenever that happens."""

import os
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from tests.record.test_files_as_a_whole import no_more_than

from axisrig.bench.record.series import SINK_BYTES, Series, SeriesWriter

pytestmark = pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")


def block(rows: int) -> dict[str, pa.Array]:
    """Rows that no compression makes short."""
    values = np.random.default_rng(1).integers(0, 2**62, rows)
    return {"time_ns": pa.array(np.arange(rows, dtype=np.int64)), "Z.set_mm": pa.array(values)}


def test_a_run_that_is_broken_off_leaves_no_file_where_even_its_end_does_not_fit(
    tmp_path: Path,
) -> None:
    """What was collected is written when it is closed, and there is no room for that."""
    path = tmp_path / "a.parquet"
    writer = SeriesWriter(path)
    writer.add(block(10))
    assert path.exists()
    with no_more_than(4):
        writer.discard()
    assert list(tmp_path.iterdir()) == []


def test_a_block_that_does_not_fit_is_an_error_of_its_file_and_leaves_none(tmp_path: Path) -> None:
    path = tmp_path / "a.parquet"
    writer = SeriesWriter(path)
    with no_more_than(1000):
        with pytest.raises(OSError, match="too large") as caught:
            writer.add(block(SINK_BYTES // 4))
        assert caught.value.filename == str(path)
        writer.discard()
    assert list(tmp_path.iterdir()) == []


def test_an_end_that_does_not_fit_is_an_error_of_its_file_and_leaves_none(tmp_path: Path) -> None:
    path = tmp_path / "a.parquet"
    writer = SeriesWriter(path)
    writer.add(block(10))
    with no_more_than(4), pytest.raises(OSError, match="too large") as caught:
        writer.close()
    assert caught.value.filename == str(path)
    writer.discard()
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_gone_is_discarded_all_the_same(tmp_path: Path) -> None:
    path = tmp_path / "a.parquet"
    writer = SeriesWriter(path)
    writer.add(block(10))
    path.unlink()
    writer.discard()
    assert list(tmp_path.iterdir()) == []


def test_a_series_beside_one_that_is_discarded_stays(tmp_path: Path) -> None:
    whole, broken = SeriesWriter(tmp_path / "a.parquet"), SeriesWriter(tmp_path / "b.parquet")
    for writer in (whole, broken):
        writer.add(block(5))
    broken.discard()
    kept = whole.close()
    whole.discard()
    assert [path.name for path in tmp_path.iterdir()] == ["a.parquet"]
    assert isinstance(kept, Series)
    assert kept.released().column("time_ns").tolist() == list(range(5))
