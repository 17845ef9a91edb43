"""What the control makes of the words of CiA 402, whatever carries them."""
