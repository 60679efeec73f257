"""What a served page has to bear."""
