"""Answer of a localizer to one sweep, in words and in numbers to draw."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...localization.trust.answers import CANNOT_TELL
from ...simulator.sweeps.press_text import named_pixels

if TYPE_CHECKING:
    from ...localization.model.localizer_model import Model
    from ...simulator.arrays import Real

NOTHING_PRESSED = "nothing pressed"
LABEL_TEXTS = {"column": "column {}", "row": "row {}", "touches": "{} touches"}


@dataclass(frozen=True)
class TouchAnswer:
    """Answer to one sweep.

    label: in words. probability: of the label, None if unknown. pixels: probability that a pixel is
    pressed, shape (row, column), row 1 first. position: x, y in mm. deviation: its standard
    deviations, mm. region: function of x, y in mm; 0 outside the region that holds 95 % of the
    probability, up to 1 inside. remark: a note, or empty. shared: "column" or "row" if its pixels
    are pressed together and share one probability. pixel: row and column of the only pressed pixel,
    from 1; 0: nothing is pressed; -1: unknown, or several. Raises ValueError if a length is not
    finite or a probability is outside 0 to 1.
    """

    label: str
    probability: float | None = None
    pixels: Real | None = None
    position: tuple[float, float] | None = None
    deviation: tuple[float, float] | None = None
    region: Callable[[Real, Real], Real] | None = None
    remark: str = ""
    shared: str = ""
    pixel: tuple[int, int] = (-1, -1)

    def __post_init__(self) -> None:
        probabilities = np.append(
            [] if self.pixels is None else self.pixels,
            [] if self.probability is None else self.probability,
        )
        lengths = (*(self.position or ()), *(self.deviation or ()))
        within = (probabilities >= -1e-9) & (probabilities <= 1 + 1e-9)
        if not (within.all() and all(map(math.isfinite, lengths))):
            raise ValueError(
                f"the localizer's answer {self.label!r} has numbers that are not finite"
            )

    @property
    def words(self) -> str:
        """The label with its uncertainty: `column 3, 97 %`."""
        parts = [self.label]
        if self.deviation is not None:
            parts.append(f"± {self.deviation[0]:.1f} x {self.deviation[1]:.1f} mm")
        if self.probability is not None:
            parts.append(f"{100 * self.probability:.0f} %")
        return ", ".join(parts)


def frequencies_of(model: Model) -> dict[str, tuple[float, ...]]:
    """Frequencies of every interface of a model, Hz, ascending, by name."""
    own = model.own_frequencies
    return {name: own.get(name, model.frequencies) for name in model.interfaces}


def reading_count(model: Model) -> int:
    """Number of readings in a sweep of this model."""
    return sum(map(len, frequencies_of(model).values()))


def answer_of_classes(
    target: str, label: str, classes: Sequence[str], probabilities: Real, shape: tuple[int, int]
) -> TouchAnswer:
    """Answer of a classifier: its label, and the probability of each of its classes.

    classes: a number for a column, row or count of touches, `ROW,COLUMN` for a pixel, several
    joined by '+'; zeros for the unpressed skin. shape: rows and columns of pixels.
    """
    known = dict(zip(classes, probabilities.tolist(), strict=True))
    pixels = None
    if target != "touches":
        pressed = np.array([_pressed_pixels(target, each, shape) for each in classes])
        pixels = np.tensordot(probabilities, pressed, 1)
    shared = target if target in ("column", "row") else ""
    return TouchAnswer(
        _label_text(target, label),
        known.get(label),
        pixels,
        shared=shared,
        pixel=_only_pixel(target, label),
    )


def _only_pixel(target: str, label: str) -> tuple[int, int]:
    """Row and column of a class with one pressed pixel; see `TouchAnswer`."""
    pixels = named_pixels(label)
    if label == "0" or (pixels and all(pixel == (0, 0) for pixel in pixels)):
        return 0, 0
    if target in ("column", "row") and label.isdigit():
        return (-1, int(label)) if target == "column" else (int(label), -1)
    return pixels[0] if len(pixels) == 1 else (-1, -1)


def _label_text(target: str, label: str) -> str:
    if label == CANNOT_TELL:
        return label
    pixels = named_pixels(label)
    if _only_pixel(target, label) == (0, 0):
        return NOTHING_PRESSED
    if pixels:
        return ("pixel " if len(pixels) == 1 else "pixels ") + label.replace("+", " and ")
    return "1 touch" if (target, label) == ("touches", "1") else LABEL_TEXTS[target].format(label)


def _pressed_pixels(target: str, label: str, shape: tuple[int, int]) -> Real:
    """Pixels that a class presses: 1, others 0; shape (row, column)."""
    pressed = np.zeros(shape)
    if target == "column" and int(label):
        pressed[:, int(label) - 1] = 1
    elif target == "row" and int(label):
        pressed[int(label) - 1, :] = 1
    for row, column in named_pixels(label):
        if row and column:
            pressed[row - 1, column - 1] = 1
    return pressed
