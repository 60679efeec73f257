"""What is there: skin, contacts, shape and meter; reading and checking scene files."""
