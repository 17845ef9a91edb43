"""Fault scenarios: many small machines with random faults, judged by the truth of their plants.

`scenario` makes them, `oracle` judges what they leave, `campaign` runs thousands.
"""
