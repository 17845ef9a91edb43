"""SERCOS drives as a rig has them: their keys, telegrams and checks."""
