"""The tests of single axes share how statements are made, `axis_statements.py`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
