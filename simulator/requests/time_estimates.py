"""Notes with the estimated duration before work that takes minutes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from time import perf_counter
from typing import TypeVar

import numpy as np

from ..progress import duration
from ..scene.parts import Setup, Skin
from .console import note

Item = TypeVar("Item")

MIN_NOTED_SECONDS = 60.0
"""Shortest duration of work that is announced, s."""


SIZE, REFERENCE = 200_000, 10e-3
"""Numbers that `slowness` sorts, and the time of it on the processor that the rates of work were
measured on, s."""
EARTH, TWO_FIELDS = 8.0, 3.0
"""Work of a skin with surroundings, and of one whose sheets have different fields, over that of a
plain skin of one field."""


IMPORT_SECONDS, MESH_SECONDS, TRAINING_SECONDS = 1.0, 0.3, 0.01
FIELD_SECONDS, PLACE_SECONDS, PLACES, READING_SECONDS = 0.2, 0.013, 9, 0.13
POINT_SECONDS, SKIN_SECONDS = 1.7, 0.3
"""Seconds of work at a complexity of 1: of imports, of a mesh and of the training of a reduced
model by cell; of fields, of each of PLACES places of a pixel, and of accuracies by pixel; of a
point of a study, and of its skins."""
PLACE_POWER, TRAINING_POWER = 0.75, 1.3
"""Powers of the complexity by which the work of a place, and of a training, grows."""


def slowness() -> float:
    """Time of sorting numbers here and now over REFERENCE, on one thread."""
    numbers, started = np.random.default_rng(0).random(SIZE), perf_counter()
    np.sort(numbers)
    return (perf_counter() - started) / REFERENCE


def complexity(skin: Skin, setup: Setup) -> float:
    """Work of one solution of a skin over that of one field without surroundings."""
    edge = {contact.name: contact.edge for contact in skin.contacts}
    wired = [{edge.get(name) for name in (*each.high, *each.low)} for each in setup.interfaces]
    two = skin.around is not None or any(len(edges) > 1 for edges in wired)
    return (EARTH if skin.around else 1.0) * (TWO_FIELDS if two else 1.0)


def page_parts(skin: Skin, setup: Setup, rtol: float, cells: int) -> dict[str, float]:
    """Expected seconds of the parts of a page, by the name of their progress."""
    count, times = cells**2 * skin.pixels.rows * skin.pixels.columns, complexity(skin, setup)
    each = {
        "choosing the mesh of a reduced model": IMPORT_SECONDS + MESH_SECONDS * times,
        "training a reduced model": TRAINING_SECONDS * count * times**TRAINING_POWER,
    }
    return _scaled(each, (1e-3 / rtol) ** 0.25)


def limit_parts(skin: Skin, setup: Setup) -> dict[str, float]:
    """Expected seconds of the parts of limits, by the name of their progress."""
    pixels, times = skin.pixels.rows * skin.pixels.columns, complexity(skin, setup)
    each = {
        "fields": IMPORT_SECONDS + FIELD_SECONDS * times,
        "places": PLACE_SECONDS * PLACES * pixels * times**PLACE_POWER,
        "training": MESH_SECONDS + TRAINING_SECONDS * pixels,
        "readings": READING_SECONDS * pixels,
    }
    return _scaled(each, 1.0)


def study_seconds(skin: Skin, setup: Setup, points: int, workers: int) -> float:
    """Expected seconds of a study on the processor of the rates."""
    each = POINT_SECONDS + SKIN_SECONDS * complexity(skin, setup)
    return each * math.ceil(points / workers)


def study_parts(skin: Skin, setup: Setup, points: int, workers: int) -> dict[str, float]:
    """Expected seconds of a study here and now, by the name of its progress."""
    return _scaled({"accuracy": study_seconds(skin, setup, points, workers)}, 1.0)


def _scaled(parts: Mapping[str, float], times: float) -> dict[str, float]:
    now = times * slowness()
    return {name: now * seconds for name, seconds in parts.items()}


def note_if_long(name: str, seconds: float, work: str) -> None:
    """Prints a note with the estimated duration of `work` if that is a minute or more."""
    if seconds >= MIN_NOTED_SECONDS:
        note(f"{name}: {work} will take about {duration(seconds)}")


def with_time_estimate(
    name: str, presses: Iterable[Item], count: int, clock: Callable[[], float] = perf_counter
) -> Iterator[Item]:
    """Yields the presses; once, prints an estimate of the remaining time from the latest press.

    The first press includes preparations for all, so the estimate waits for the second one, unless
    the first alone took a minute. clock: returns seconds.
    """
    started, noted = clock(), False
    for done, press in enumerate(presses):
        left, latest = count - done, clock() - started
        known = done >= 2 or (done == 1 and latest >= MIN_NOTED_SECONDS)
        if known and not noted and latest * left >= MIN_NOTED_SECONDS:
            noted = True
            note_if_long(name, latest * left, f"the other {left} of {count} presses")
        started = clock()
        yield press
