"""Parts of all commands' reports: tables, pages, folders that are filled at once."""
