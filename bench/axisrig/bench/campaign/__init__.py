"""Running: one program, one case, many cases in processes; the results folder; pytest."""
