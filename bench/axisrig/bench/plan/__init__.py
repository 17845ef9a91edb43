"""Test plans: tables of cases, their inputs, conditions and verdicts."""
