"""What is asked of a whole program: alarms, duration, buses, lags; its marks and its log."""
