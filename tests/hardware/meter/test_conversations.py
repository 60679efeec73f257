"""Drivers against the conversations of manuals, which the virtual instruments play, too."""

import math

import pytest
from rcskin.hardware.meter.errors import FailedReadingError, NoAnswerError
from rcskin.hardware.meter.instruments import start
from rcskin.hardware.meter.lcr_meter import correct
from rcskin.tests.hardware.conversation_files import CONVERSATIONS, spoken

SCRIPTS = sorted(CONVERSATIONS.joinpath("drivers").glob("*.txt"))
R, C = 10e3, 1e-9


class FakeInstrument:
    """A connection that knows its script alone, and fails at the first unexpected line."""

    resource = "FAKE"

    def __init__(self, turns):
        self.turns, self.said, self.closed = list(turns), None, False

    def write(self, message):
        """Take the next line of the script."""
        assert self.turns, f"the conversation is over, got {message}"
        assert self.said is None, f"{self.said} was not read before {message}"
        expected, self.said = self.turns.pop(0)
        assert message == expected

    def read(self, seconds=0.0):
        """The answer of the script; where it has none, a real meter would be silent."""
        if self.said is None:
            raise NoAnswerError("silence")
        said, self.said = self.said, None
        return said

    def close(self):
        """End the conversation."""
        self.closed = True


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_a_driver_keeps_to_the_conversation_of_the_manual(path):
    fake = FakeInstrument(spoken(path))
    meter = start(fake)
    readings = [meter.read_at(1e3)]
    for _ in range(2):
        readings += meter.read_sweep([1e3, 2e3, 5e3])
    if path.stem != "E4990A":  # it sends no status
        meter.range = 1e5
        with pytest.raises(FailedReadingError, match="overload"):
            meter.read_at(1e5)
    correct(meter, "open", "ALL")
    meter.release()
    assert (fake.turns, fake.said, fake.closed) == ([], None, True)
    for reading, frequency in zip(readings, (1e3, *(1e3, 2e3, 5e3) * 2), strict=True):
        X = -1 / (2 * math.pi * frequency * C)
        assert reading.value == pytest.approx(complex(R, X), rel=1e-5)
