"""A skin with its foils where they are: what it tells of any material, readings and frequencies.

Answers are kept in a journal; the skin is trained at the first one that is not there.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property

from ..bounds.sets import candidates_in, own_band
from ..progress import ProgressCallback
from ..scene.design_goals import POSITION, Design
from ..scene.scene import Scene
from ..scene.scene_files import scene_text
from .journal import Journal
from .judged import Judge, Layout, PlaceJudge, merits
from .on_skin import Material, material_of
from .picking import GRID, Picked, Picker, PixelPairs, TouchedPlaces
from .places import Touches
from .pool import own_readings, pool, terminals, wirings
from .trained import Trained


@dataclass(frozen=True)
class Asking:
    """What a search is asked, and how: see `search.Search`."""

    asked: Design
    seed: int
    draws: int
    journal: Journal
    progress: ProgressCallback


class Bench:
    """One scene's geometry. wired: the terminals with wires."""

    def __init__(self, scene: Scene, asking: Asking, wired: Sequence[str]) -> None:
        self.scene, self._asking, asked = scene, asking, asking.asked
        own = own_band(scene)
        band = asked.band or own
        self.frequency = candidates_in(scene, band, max(asked.frequencies or GRID, GRID))
        spanned = min(own[0], band[0]), max(own[1], band[1])
        self.wired, self.pool = tuple(wired), pool(scene, wired)
        touches = Touches(scene) if asked.target == POSITION else None
        self._trained = Trained(scene, asked, spanned, asking.seed, asking.progress, touches)
        if touches is None:
            told, judge = PixelPairs(scene, asked), Judge(scene, asked, asking.draws, asking.seed)
        else:
            told, judge = TouchedPlaces(touches, asked), PlaceJudge(touches, asked.against_rest)
        self._judge: Judge | PlaceJudge = judge
        self._picker = Picker(self._trained, told, self.pool, self.frequency, asked)

    @property
    def own(self) -> Layout:
        """The scene's own."""
        frequencies = tuple(self.scene.frequencies.tolist())
        return Layout(material_of(self.scene), self.scene.interfaces, frequencies)

    @property
    def own_readings(self) -> list[int]:
        """Where the scene's own stand in the pool."""
        return own_readings(self.scene, self.pool)

    def layout(self, material: Material, picked: Picked) -> Layout:
        """What was picked, of a material."""
        return Layout(
            material,
            tuple(self.pool[k] for k in picked.readings),
            tuple(float(self.frequency[k]) for k in picked.frequencies),
        )

    def share_of(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> float:
        """As of `Picker`."""
        asked = {"share of": [list(readings), list(frequencies)], **self._at(material)}

        def answer() -> dict[str, float]:
            return {"share": self._picker.share_of(material, readings, frequencies)}

        return self._asking.journal.kept(asked, answer)["share"]

    def readings_at(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """As of `Picker`."""
        asked = {"readings at": [list(readings), list(frequencies)], **self._at(material)}

        def answer() -> dict[str, object]:
            return asdict(self._picker.readings_at(material, readings, frequencies))

        return Picked.of(self._asking.journal.kept(asked, answer))

    def picked(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """As of `Picker`."""
        asked = {"picked from": [list(readings), list(frequencies)], **self._at(material)}

        def answer() -> dict[str, object]:
            return asdict(self._picker.picked(material, readings, frequencies))

        found = self._asking.journal.kept(asked, answer)
        return Picked.of(found)

    def most_by_each(self, material: Material, picked: Picked) -> float | None:
        """As of `Picker`."""
        asked = {"each": [list(picked.readings), list(picked.frequencies)], **self._at(material)}

        def answer() -> dict[str, float | None]:
            return {"most": self._picker.most_by_each(material, picked)}

        return self._asking.journal.kept(asked, answer)["most"]

    def of_each(self, material: Material, picked: Picked) -> Layout:
        """What was picked, each reading with the frequencies of its own that `Picker` finds."""
        asked = {"of each": [list(picked.readings), list(picked.frequencies)], **self._at(material)}

        def answer() -> dict[str, list[list[int]]]:
            return {"numbers": self._picker.of_each(material, picked)}

        numbers = self._asking.journal.kept(asked, answer)["numbers"]
        told = [tuple(float(self.frequency[k]) for k in own) for own in numbers]
        readings = [
            self.pool[k].model_copy(update={"frequencies": own})
            for k, own in zip(picked.readings, told, strict=True)
            if own
        ]
        return Layout(material, tuple(readings), tuple(sorted(set(itertools.chain(*told)))))

    def shares(self, layout: Layout) -> tuple[float, ...]:
        """Merits of the skin as it was meant and of each cast: see `Judge`, `PlaceJudge`."""
        read = [[list(each.high), list(each.low)] for each in layout.readings]
        asked = {
            "shares": [read, list(layout.frequencies)],
            **_own(layout),
            **self._at(layout.material),
        }

        def answer() -> dict[str, list[float]]:
            casts = self._asking.asked.casts
            return {"shares": merits(self._judge, self._trained, layout, casts)}

        return tuple(self._asking.journal.kept(asked, answer)["shares"])

    def _at(self, material: Material) -> dict[str, object]:
        return {"scene": self._text, "wired": self.wired, "material": asdict(material)}

    @cached_property
    def _text(self) -> str:
        return scene_text(self.scene)


def _own(layout: Layout) -> dict[str, object]:
    """Frequencies of readings that have their own, as a journal keeps them."""
    return {"of each": [list(each) for each in layout.of_each]} if layout.own else {}


def first_bench(scene: Scene, asking: Asking) -> Bench:
    """Of a scene with the wires that tell most of what it is, where not all foils may have one."""
    wires = asking.asked.wires or len(terminals(scene))
    benches = [Bench(scene, asking, wired) for wired in wirings(scene, wires)]
    if len(benches) == 1:
        return benches[0]
    own = material_of(scene)
    some = range(len(benches[0].frequency))
    return max(benches, key=lambda each: each.picked(own, [], list(some)).share)
