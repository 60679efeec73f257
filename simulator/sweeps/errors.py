"""How work ends that cannot be done: input to mend, or a tolerance out of reach."""


class InputError(ValueError):
    """Bad input, told in one line that names the file, the key, the value and what is allowed."""


class OutputError(RuntimeError):
    """What was to be written could not be, through no fault of the input; one line says why."""


class ToleranceError(RuntimeError):
    """The asked tolerance is not reached, so nothing is answered.

    times: as large a tolerance is likely to be kept, where that can be told.
    """

    def __init__(self, told: str, times: float | None = None) -> None:
        super().__init__(told)
        self.times = times


class InterruptedWorkError(RuntimeError):
    """Ctrl-C ended work that can be taken up again; the message says how."""
