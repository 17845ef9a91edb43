"""The co-simulation master: the scheduler of simulated time and the plants that it advances."""
