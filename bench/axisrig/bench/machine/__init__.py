"""A rig brought to life: everything that exists only while a run lasts."""
