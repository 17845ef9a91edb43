"""What ids of runs, and the names that they are made of, may consist of: they are file names."""

import re
from typing import Final

SIGNS: Final = "A-Za-z0-9_.-"
"""As in a set of a regular expression."""
RUN_ID: Final = re.compile(f"[{SIGNS}]+")
UNSAFE: Final = re.compile(f"[^{SIGNS}]")
"""What is no part of an id."""
