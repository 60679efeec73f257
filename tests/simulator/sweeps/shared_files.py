"""Files of instruments beside the project, and what they hold by a parser of their own."""

from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[3].parent / "shared" / "data"
COLUMNS = {
    "Autolab.txt": (",", 0, 4, 5, 1),
    "BioLogic.mpt": ("\t", 0, 1, 2, -1),
    "CHInstruments.txt": (",", 0, 1, 2, 1),
    "Gamry.DTA": ("\t", 3, 4, 5, 1),
    "Parstat.txt": ("\t", 3, 4, 5, 1),
    "Powersuite.txt": ("\t", 0, 1, 2, 1),
    "VersaStudio.par": (",", 9, 14, 15, 1),
    "ZPlot.z": ("\t", 0, 4, 5, 1),
}
"""Separator, places of frequency, Re Z and Im Z, and the sign of Im Z, read off by eye."""
CELLS = {"Autolab.txt": 9, "VersaStudio.par": 24, "Gamry.DTA": 12}


def shared(*parts):
    """The path of a file; the test is skipped where it is absent."""
    path = FOLDER.joinpath(*parts)
    if not path.exists():
        pytest.skip(f"{path} is absent: files of instruments are not part of the project")
    return path


def parsed(name, text):
    """Frequency and Z of a file of that instrument, ascending, by its columns alone."""
    separator, f, real, imaginary, sign = COLUMNS[name]
    rows = []
    for line in text.splitlines():
        cells = line.split(separator)
        if name in CELLS and len(cells) != CELLS[name]:
            continue
        try:
            reading = [float(cells[place]) for place in (f, real, imaginary)]
        except (ValueError, IndexError):
            continue
        if reading[0] > 0:
            rows.append(reading)
    found = np.array(sorted(rows))
    return found[:, 0], found[:, 1] + 1j * sign * found[:, 2]
