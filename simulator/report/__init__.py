"""What reports of all commands are made of: tables, pages, and folders that are filled at once."""
