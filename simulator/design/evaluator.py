"""Evaluation of one geometry of a skin, for any material, readings and frequencies.

Results are stored in a journal; the model is trained at the first one that is missing there.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..bounds.frequency_sets import candidates_in, own_band
from ..progress import ProgressCallback
from ..scene.design_goals import POSITION, Design
from ..scene.parts import SceneParts
from ..sweeps import InputError, inputs, kept_file
from ..sweeps.digests import sealed_json, unsealed_json
from .goals import Goal, PressedPixels, TouchPositions
from .layout import Layout, Material, material_of
from .picking import GRID, Picked, Picker
from .reading_pool import own_readings, pool, terminals, wirings
from .trained_skins import TrainedSkins

Answer = dict[str, Any]
DIGITS = 9
"""Digits of merits after the point: far more than the draws resolve."""


class SearchJournal:
    """Stored results by query. header: settings that all of them depend on."""

    def __init__(self, folder: Path | None, header: Mapping[str, Any]) -> None:
        """folder: of the journal; None keeps nothing."""
        self._folder, self._header = folder, dict(header)

    def answer(self, query: Mapping[str, Any], compute: Callable[[], Answer]) -> Answer:
        """The stored result of a query, or else that of `compute`, which is then stored.

        Both pass through JSON and are rounded to DIGITS, because sums may round differently in
        another process. Raises InputError where the journal cannot be read or written.
        """
        if self._folder is None:
            return json.loads(json.dumps(rounded(compute())))
        text = json.dumps({"of": self._header, "query": dict(query)}, sort_keys=True)
        path = self._folder / f"{hashlib.sha256(text.encode()).hexdigest()[:24]}.json"
        try:
            if path.exists():
                return unsealed_json(inputs.text(path, inputs.JOURNAL))
        except (OSError, ValueError) as error:
            raise InputError(
                f"{path}: cannot be used as a journal: {error}; remove it to compute it again"
            ) from error
        found = sealed_json(rounded(compute()))
        try:
            self._folder.mkdir(exist_ok=True)
            with kept_file(path) as unfinished:
                unfinished.write_text(found, encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: cannot be used as a journal: {error}") from error
        return unsealed_json(found)

    def done(self) -> None:
        """Removes the journal of a finished search."""
        if self._folder is not None and self._folder.exists():
            shutil.rmtree(self._folder)


def rounded(answer: Any) -> Any:
    """A result with all its numbers rounded to DIGITS after the point."""
    if isinstance(answer, dict):
        return {name: rounded(part) for name, part in answer.items()}
    if isinstance(answer, list | tuple):
        return [rounded(part) for part in answer]
    return round(answer, DIGITS) if isinstance(answer, float) else answer


@dataclass(frozen=True)
class SearchSettings:
    """Settings of a search: the constraints (`request`), random numbers, journal and progress."""

    request: Design
    seed: int
    draws: int
    journal: SearchJournal
    progress: ProgressCallback


class SceneEvaluator:
    """Evaluator of one scene's geometry. wired: the terminals with wires."""

    def __init__(self, parts: SceneParts, settings: SearchSettings, wired: Sequence[str]) -> None:
        self.parts, self._settings, request = parts, settings, settings.request
        own = own_band(parts.setup)
        band = request.band or own
        self.frequency = candidates_in(parts.setup, band, max(request.frequencies or GRID, GRID))
        spanned = min(own[0], band[0]), max(own[1], band[1])
        self.wired, self.pool = tuple(wired), pool(parts.skin, parts.setup, wired)
        self._goal: Goal
        if request.target == POSITION:
            self._goal = TouchPositions(parts, request.against_rest)
        else:
            self._goal = PressedPixels(parts, request, settings.draws, settings.seed)
        self._trained = TrainedSkins(
            parts, request, spanned, settings.seed, self._goal, settings.progress
        )
        self._picker = Picker(self._trained, self._goal, self.pool, self.frequency, request)

    @property
    def own(self) -> Layout:
        """The scene's own material, readings and frequencies."""
        frequencies = tuple(self.parts.setup.frequency.tolist())
        return Layout(material_of(self.parts.skin), self.parts.setup.interfaces, frequencies)

    @property
    def own_readings(self) -> list[int]:
        """Indices of the scene's own readings in the pool."""
        return own_readings(self.parts.skin, self.parts.setup, self.pool)

    def layout(self, material: Material, picked: Picked) -> Layout:
        """The picked readings and frequencies, with a material."""
        return Layout(
            material,
            tuple(self.pool[k] for k in picked.readings),
            tuple(float(self.frequency[k]) for k in picked.frequencies),
        )

    def share_of(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> float:
        """Result of the method of `Picker`, from the journal where it is there."""
        return self._stored("share_of", material, readings, frequencies)

    def readings_at(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """Result of the method of `Picker`, from the journal where it is there."""
        return Picked.of(self._stored("readings_at", material, readings, frequencies))

    def picked(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """Result of the method of `Picker`, from the journal where it is there."""
        return Picked.of(self._stored("picked", material, readings, frequencies))

    def bound_with_own_frequencies(self, material: Material, picked: Picked) -> float | None:
        """Result of the method of `Picker`, from the journal where it is there."""
        numbers = picked.readings, picked.frequencies
        return self._stored("bound_with_own_frequencies", material, *numbers)

    def with_own_frequencies(self, material: Material, picked: Picked) -> Layout:
        """The picked readings, each with own frequencies; see `Picker.own_frequencies`."""
        numbers = self._stored("own_frequencies", material, picked.readings, picked.frequencies)
        of_each = [tuple(float(self.frequency[k]) for k in own) for own in numbers]
        readings = [
            self.pool[k].model_copy(update={"frequencies": own})
            for k, own in zip(picked.readings, of_each, strict=True)
            if own
        ]
        return Layout(material, tuple(readings), tuple(sorted(set(itertools.chain(*of_each)))))

    def merits(self, layout: Layout) -> tuple[float, ...]:
        """Exact scores of the nominal skin, then of each sample; see `goals`."""
        read = [[list(each.high), list(each.low)] for each in layout.readings]
        request = {
            "shares": [read, list(layout.frequencies)],
            **_own(layout),
            **self._at(layout.material),
        }

        def answer() -> dict[str, list[float]]:
            casts = [self._trained.sample(k) for k in range(self._settings.request.casts)]
            ons = (
                self._trained.readout(cast, layout.material, layout.readings)
                for cast in [None, *casts]
            )
            at = np.array(layout.frequencies)
            return {"shares": [self._goal.score(on, at) for on in ons]}

        return tuple(self._settings.journal.answer(request, answer)["shares"])

    def _stored(
        self, method: str, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Any:
        """Result of a method of `Picker`, from the journal where it is there."""
        query = {method: [list(readings), list(frequencies)], **self._at(material)}

        def answer() -> dict[str, Any]:
            found = getattr(self._picker, method)(material, readings, frequencies)
            return {"answer": asdict(found) if isinstance(found, Picked) else found}

        return self._settings.journal.answer(query, answer)["answer"]

    def _at(self, material: Material) -> dict[str, object]:
        return {"scene": self._text, "wired": self.wired, "material": asdict(material)}

    @cached_property
    def _text(self) -> str:
        return self.parts.text


def _own(layout: Layout) -> dict[str, object]:
    """Own frequencies of readings, where there are any, as a part of a journal's query."""
    return (
        {"of each": [list(each) for each in layout.frequencies_of_each]}
        if layout.has_own_frequencies
        else {}
    )


def first_evaluator(parts: SceneParts, settings: SearchSettings) -> SceneEvaluator:
    """Evaluator of a scene; where only some foils may have wires, that of the best ones."""
    wires = settings.request.wires or len(terminals(parts.skin))
    evaluators = [SceneEvaluator(parts, settings, wired) for wired in wirings(parts.skin, wires)]
    if len(evaluators) == 1:
        return evaluators[0]
    own = material_of(parts.skin)
    some = range(len(evaluators[0].frequency))
    return max(evaluators, key=lambda each: each.picked(own, [], list(some)).share)
