"""Kinematics once more: lists read again, chains as products of 4x4 matrices."""
