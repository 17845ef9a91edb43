"""What every topic of the decoder shares: context, blocks, frames, subprograms, waiting."""
