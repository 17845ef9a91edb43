"""What did not pass: equal failures as one card."""
