"""Simulated time: the clock that everybody reads and the scheduler that moves it on."""
