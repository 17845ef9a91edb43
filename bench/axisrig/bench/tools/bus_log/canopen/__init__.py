"""Telegrams of CANopen in words."""
