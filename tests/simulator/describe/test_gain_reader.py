"""What `describe` says of readers of gains."""

import pytest


@pytest.fixture
def lines(run):
    """Lines that the command prints of a built-in scene, by their label."""
    _, out, _ = run("describe", "knit-36")
    return [line.split(maxsplit=1) for line in out.splitlines()[1:]]


def test_readers_of_gains_are_described(lines):
    said = [text for label, text in lines if label == "gain"]
    assert said[0] == (
        "left: reads the magnitude of the gain, driven through 1 Mohm; the input has 10 pF; the "
        "source of right is on at the same time"
    )
    assert said[2].startswith("left: unpressed 0.969 and 0.292 at 2 kHz and 25.8 kHz")
    noise = next(text for label, text in lines if label == "noise")
    assert "of |V / V_s|" in noise
