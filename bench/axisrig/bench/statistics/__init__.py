"""Statistics over samples of numbers: pure functions that know nothing of plans and runs."""
