"""What words between a control and its drives mean, as both ends take them; no behaviour."""
