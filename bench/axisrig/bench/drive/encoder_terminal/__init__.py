"""The virtual axis with a speed drive and an encoder terminal."""
