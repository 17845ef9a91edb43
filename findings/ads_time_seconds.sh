#!/usr/bin/env bash
# pyads 3.6.0 makes a time for a Beckhoff controller that has whole seconds only.
#
# ADS carries the time of a sample as FILETIME, in steps of 100 ns, and pyads has two functions for it, there and back. The
# guess: half a second more is 5 000 000 steps more, and what comes back is the same to a microsecond. What comes: the
# fraction of the second is gone, so that an edge at 7:00:00.900 and one at 7:00:00.100 have the same time. The other
# direction keeps it.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyads==3.6.0
cd "$work"
cat >try.py <<'PYTHON'
from datetime import datetime, timezone

from pyads.filetimes import dt_to_filetime, filetime_to_dt

second = datetime(2026, 11, 29, 7, 0, 0, tzinfo=timezone.utc)
whole = dt_to_filetime(second)
for microsecond in (100_000, 500_000, 900_000):
    made = dt_to_filetime(second.replace(microsecond=microsecond))
    read = filetime_to_dt(whole + 10 * microsecond)
    print(f"{microsecond} us: steps of 100 ns beyond the second: made {made - whole}, read {read.microsecond * 10}")
PYTHON
cat >expected <<'TEXT'
100000 us: steps of 100 ns beyond the second: made 0, read 1000000
500000 us: steps of 100 ns beyond the second: made 0, read 5000000
900000 us: steps of 100 ns beyond the second: made 0, read 9000000
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
