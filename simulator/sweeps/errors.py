"""What a person can mend: input that is missing, malformed or out of range."""


class InputError(ValueError):
    """Bad input, told in one line that names the file, the key, the value and what is allowed."""
