"""Forms of commands, numbers and messages that the languages of meters share."""
