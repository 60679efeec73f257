"""Another client, or a finger on the panel, changes a setting in the midst of a recording."""

import dataclasses
import random
import socket
from copy import deepcopy

import numpy as np
import pytest
from rcskin.hardware.meter.conversation import VisaConnection
from rcskin.hardware.record.operators import parse_step
from rcskin.hardware.record.recorder import record
from rcskin.hardware.record.recording_journal import recording_dataset
from rcskin.hardware.virtual.language import messages
from rcskin.hardware.virtual.served_skin import VIRTUAL_MODELS
from rcskin.simulator.sweeps import impedance
from rcskin.tests.hardware.instrument_cases import CASES

ORDER = ("none", "1,1", "2,1")


@pytest.fixture
def instrument(make_instrument, case):
    """The virtual instrument, as found."""
    return make_instrument(kind=VIRTUAL_MODELS[case.model], settings=case.found())


def execute(instrument, line):
    """Have the instrument execute the settings in a line at once, as if keys were pressed."""
    for message in messages(line):
        command, suffixes = instrument.command(message.words)
        command.on_set(instrument, *suffixes, *message.arguments)


class Meddler:
    """Another client, which sends a line before the message of a recording at a place.

    undone: True if the instrument has the settings of before again at the next message.
    """

    def __init__(self, instrument, port, line, undone):
        self.line, self.undone, self.at, self.count = line, undone, None, 0
        self._instrument, self._before = instrument, None
        self._socket = socket.create_connection(("127.0.0.1", port), timeout=5)
        self._answers = self._socket.makefile("rb")

    def before_message(self):
        """Count a message, and send the line before it if it is its turn."""
        self.count += 1
        if self._before and self.undone:
            self._instrument.settings, self.undone = self._before, False
        if self.count == self.at:
            self._before = deepcopy(self._instrument.settings)
            self._socket.sendall(f"{self.line}\n*IDN?\n".encode())
            self._answers.readline()

    def close(self):
        """End the connection."""
        self._answers.close()
        self._socket.close()


@pytest.fixture
def meddler(ports, instrument, monkeypatch):
    """A function that makes a meddler."""
    made, write = [], VisaConnection.write

    def before(line, message):
        for each in made:
            each.before_message()
        write(line, message)

    def meddler(line, undone=False):
        made.append(Meddler(instrument, ports.meter, line, undone))
        return made[-1]

    monkeypatch.setattr(VisaConnection, "write", before)
    yield meddler
    for each in made:
        each.close()


def recorded(task, operator, pillow, show):
    """Remarks of a recording of three presses, whose sweeps must be those of the skin."""
    order = tuple(parse_step(press, 2, 2).press for press in ORDER)
    task = dataclasses.replace(task, header=dataclasses.replace(task.header, order=order))
    header, entries = record(task, operator)
    sweeps = recording_dataset(header, entries)
    exact = [[pillow.impedance(press, f) for f in header.frequencies] for press in order]
    np.testing.assert_allclose(impedance(sweeps)[:, 0], exact, rtol=1e-4)
    assert header.frequencies == task.header.frequencies
    return show.remarks


def lines(*names):
    """Parameters: an instrument, a line of another client, and the seed of its moment."""
    return [
        pytest.param(case, line, seed, id=f"{case.model}-{line}")
        for case in CASES
        for seed, line in enumerate(each for name in names for each in getattr(case, name))
    ]


def meddle_in_the_second_sweep(operator, meddler, seed):
    """Let the meddler send its line at a random message of the second sweep."""
    press, starts = operator.press_skin, []

    def then(step):
        press(step)
        starts.append(meddler.count)
        if len(starts) == 2:
            meddler.at = starts[1] + 1 + random.Random(seed).randrange(starts[1] - starts[0])

    operator.press_skin = then


@pytest.mark.parametrize(("case", "line", "seed"), lines("quantities", "meddling"))
def test_a_setting_that_is_changed_is_restored_and_the_sweep_repeated(
    task, operator, pillow, show, instrument, case, line, meddler, seed
):
    other = meddler(line)
    meddle_in_the_second_sweep(operator, other, seed)
    recorded(task, operator, pillow, show)
    assert other.count > other.at
    assert instrument.settings == case.found()


@pytest.mark.parametrize(("case", "line", "seed"), lines("quantities"))
def test_a_change_that_is_undone_at_once_leaves_no_wrong_sweep(
    task, operator, pillow, show, instrument, case, line, meddler, seed
):
    other = meddler(line, undone=True)
    meddle_in_the_second_sweep(operator, other, seed)
    recorded(task, operator, pillow, show)
    assert not other.undone
    assert instrument.settings == case.found()


@pytest.mark.parametrize(("case", "line", "seed"), lines("quantities"))
def test_quantities_that_are_changed_between_trigger_and_answer_cost_the_sweep(
    task, operator, pillow, show, instrument, case, line, seed, monkeypatch
):
    keep, kept = type(instrument).keep, []

    def keep_and_change(meter, results):
        keep(meter, results)
        kept.append(results)
        if len(kept) == 3:
            execute(meter, line)

    monkeypatch.setattr(type(instrument), "keep", keep_and_change)
    failure, success = recorded(task, operator, pillow, show)
    assert "check" in failure and failure.endswith("the sweep is measured again")
    assert success == "the sweep that was measured again is whole"
    assert instrument.settings == case.found()
