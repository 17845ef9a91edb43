"""The tests of unseen programs share their geometry, `unseen_geometry.py`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
