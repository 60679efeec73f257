"""The errors of a meter in words."""

from __future__ import annotations

import math

from ..scene.parts import Meter, Setup
from ..scene.readout.meter import Readout
from .gain_reader import describe_converter


def noise_in_words(setup: Setup, meter: Meter) -> str:
    """Noise of each reading, and the errors that are fixed for a session."""
    readout = meter.readout
    if readout.exact and setup.gain:
        return "none: readings are exact; [readout.converter] gives them noise in volts or bits"
    if readout.exact:
        return 'none: readings are exact; readout = "IM3523" gives them the noise of that meter'
    added = "" if readout.multisine is None else "in addition to that of the multisine, "
    if readout.converter is not None:
        added = f"{describe_converter(readout.converter)}; in addition to it "
    size = "|V / V_s|" if setup.gain else "|Z|"
    sheet = readout.data_sheet
    fixed = (
        f"{100 * readout.magnitude_accuracy:.3g} % and "
        f"{math.degrees(readout.phase_accuracy):.3g} degrees fixed for a session"
        if sheet is None
        else f"the accuracy of {sheet.accuracy.name} over root 3, fixed for a session"
    )
    if readout.spread is not None:
        return f"{added}measured spreads by |Z| and frequency in each reading, {fixed}"
    if sheet is not None:
        return f"{added}{sheet.noise:g} times the fixed error in each reading, {fixed}"
    return (
        f"{added}{100 * readout.magnitude_noise:.3g} % of {size} and "
        f"{math.degrees(readout.phase_noise):.3g} degrees in each reading, {fixed}"
    )


def unused_by_tables(readout: Readout) -> tuple[str, ...]:
    """Keys of the four numbers that tables of the readout replace."""
    noise = "readout.magnitude_noise", "readout.phase_noise"
    accuracy = "readout.magnitude_accuracy", "readout.phase_accuracy"
    if readout.data_sheet is not None:
        return (*accuracy, *noise)
    return noise if readout.spread is not None else ()
