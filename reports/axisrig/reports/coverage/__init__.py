"""What the runs of a campaign have touched, against the tables of what there is."""
