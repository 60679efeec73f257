"""Evaluation of one geometry of a skin, for any material, readings and frequencies.

Results are stored in a journal; the model is trained at the first one that is missing there.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property

from ..bounds.frequency_sets import candidates_in, own_band
from ..progress import ProgressCallback
from ..scene.design_goals import POSITION, Design
from ..scene.parts import SceneParts
from .picking import GRID, Picked, Picker, PixelPairs, PositionPairs
from .reading_pool import own_readings, pool, terminals, wirings
from .scoring import AccuracyScorer, Layout, PositionScorer, merits
from .search_journal import SearchJournal
from .skin_readout import Material, material_of
from .touch_positions import TouchPositions
from .trained_skins import TrainedSkins


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
        touches = TouchPositions(parts) if request.target == POSITION else None
        self._trained = TrainedSkins(
            parts, request, spanned, settings.seed, settings.progress, touches
        )
        if touches is None:
            pair_source = PixelPairs(parts, request)
            scorer = AccuracyScorer(parts, request, settings.draws, settings.seed)
        else:
            pair_source, scorer = (
                PositionPairs(touches, request),
                PositionScorer(touches, request.against_rest),
            )
        self._scorer: AccuracyScorer | PositionScorer = scorer
        self._picker = Picker(self._trained, pair_source, self.pool, self.frequency, request)

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
        request = {"share of": [list(readings), list(frequencies)], **self._at(material)}

        def answer() -> dict[str, float]:
            return {"share": self._picker.share_of(material, readings, frequencies)}

        return self._settings.journal.answer(request, answer)["share"]

    def readings_at(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """Result of the method of `Picker`, from the journal where it is there."""
        request = {"readings at": [list(readings), list(frequencies)], **self._at(material)}

        def answer() -> dict[str, object]:
            return asdict(self._picker.readings_at(material, readings, frequencies))

        return Picked.of(self._settings.journal.answer(request, answer))

    def picked(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """Result of the method of `Picker`, from the journal where it is there."""
        request = {"picked from": [list(readings), list(frequencies)], **self._at(material)}

        def answer() -> dict[str, object]:
            return asdict(self._picker.picked(material, readings, frequencies))

        found = self._settings.journal.answer(request, answer)
        return Picked.of(found)

    def bound_with_own_frequencies(self, material: Material, picked: Picked) -> float | None:
        """Result of the method of `Picker`, from the journal where it is there."""
        request = {"each": [list(picked.readings), list(picked.frequencies)], **self._at(material)}

        def answer() -> dict[str, float | None]:
            return {"most": self._picker.bound_with_own_frequencies(material, picked)}

        return self._settings.journal.answer(request, answer)["most"]

    def with_own_frequencies(self, material: Material, picked: Picked) -> Layout:
        """The picked readings, each with own frequencies; see `Picker.own_frequencies`."""
        request = {
            "of each": [list(picked.readings), list(picked.frequencies)],
            **self._at(material),
        }

        def answer() -> dict[str, list[list[int]]]:
            return {"numbers": self._picker.own_frequencies(material, picked)}

        numbers = self._settings.journal.answer(request, answer)["numbers"]
        of_each = [tuple(float(self.frequency[k]) for k in own) for own in numbers]
        readings = [
            self.pool[k].model_copy(update={"frequencies": own})
            for k, own in zip(picked.readings, of_each, strict=True)
            if own
        ]
        return Layout(material, tuple(readings), tuple(sorted(set(itertools.chain(*of_each)))))

    def merits(self, layout: Layout) -> tuple[float, ...]:
        """Merits of the nominal skin, then of each sample; see `scoring`."""
        read = [[list(each.high), list(each.low)] for each in layout.readings]
        request = {
            "shares": [read, list(layout.frequencies)],
            **_own(layout),
            **self._at(layout.material),
        }

        def answer() -> dict[str, list[float]]:
            casts = self._settings.request.casts
            return {"shares": merits(self._scorer, self._trained, layout, casts)}

        return tuple(self._settings.journal.answer(request, answer)["shares"])

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
