"""What a drive does with its object values (CiA 402): states, motion, touch probe. No CAN here."""
