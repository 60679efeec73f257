"""Localizer of a live session: a trained model, its filter and its adaptive sweeps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from ...localization.commands.model_notes import note_version
from ...localization.filtering.adaptive import AdaptivePolicy, inverter_for
from ...localization.filtering.follower import MAX_CHANGE_PROBABILITY, FollowedAnswer, Follower
from ...localization.inputs.features import needs_baseline
from ...localization.model.localizer_file import load
from ...localization.trust.answers import CANNOT_TELL
from ...localization.trust.diagnosis import without_answer
from .touch_answer import NOTHING_PRESSED, TouchAnswer, answer_of_classes

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ...localization.filtering.adaptive import AdaptiveSweep
    from ...localization.filtering.chain import TouchDynamics
    from ...localization.inversion.region import Region
    from ...localization.model.localizer_model import Model
    from ...simulator.scene.parts import SceneParts

TOUCH_CHANGED = "the touch changed in mid-sweep"


def localizer_of(
    path: Path, touching: TouchDynamics | None, adaptive: bool, certain: float | None, within: float
) -> LiveLocalizer:
    """Localizer of a model file, ready to answer. Prints a note if other versions wrote the file.

    touching: dynamics of touches, to combine successive sweeps. adaptive: True to choose readings.
    certain, within: limits of the filter and of the adaptive sweep. Raises InputError.
    """
    model = load(path).in_background()
    note_version(model, path)
    follower = Follower(model, touching, certain) if touching else None
    policy = AdaptivePolicy(model, certain, follower, within) if adaptive else None
    return LiveLocalizer(model, model.known_scene.parts, follower, policy)


@dataclass(frozen=True)
class LiveLocalizer:
    """A model and its skin.

    follower: combines successive sweeps; None: each sweep is answered by itself. policy: chooses
    the readings of sweeps; None: all of them in their order.
    """

    model: Model
    parts: SceneParts
    follower: Follower | None = None
    policy: AdaptivePolicy | None = None

    @property
    def uses_baseline(self) -> bool:
        """True if the model compares with the unpressed skin."""
        return needs_baseline(self.model.quantities) or self.model.guards_use_changes

    def prepare(self, rest: xr.Dataset | None) -> None:
        """Compute tables of the skin, if the model has any, and restart the filter."""
        if rest is not None and needs_baseline(self.model.quantities):
            inverter_for(self.model, rest)
        if self.follower is not None:
            self.follower.forget()

    def adaptive_sweep(self, rest: xr.Dataset | None, gap: float) -> AdaptiveSweep | None:
        """Adaptive sweep, gap s after the sweep before; None if sweeps are to be whole."""
        if self.policy is None or rest is None:
            return None
        return self.policy.begin(rest, gap)

    def answer(
        self, sweep: xr.Dataset, rest: xr.Dataset | None, gap: float, during: float
    ) -> TouchAnswer:
        """Answer to one sweep; a filter also uses the sweeps before it.

        rest: unpressed sweeps or None; the coordinate OPENING of `simulator.sweeps` marks those of
        the opening. gap: s since the end of the sweep before. during: its
        duration, s. A sweep without an answer names the fault that it resembles, if the model knows
        any.
        """
        found = self._answer(sweep, rest, gap, during)
        if found.label != CANNOT_TELL:
            return found
        return replace(found, label=without_answer(str(self.model.fault_kinds(sweep)[0])))

    def _answer(
        self, sweep: xr.Dataset, rest: xr.Dataset | None, gap: float, during: float
    ) -> TouchAnswer:
        """Answer without the name of a fault."""
        if self.follower is not None:
            return self.described(self.follower.follow(sweep, rest, gap, during))
        found = self.model.answers(sweep, rest)
        label, probability = str(found.labels[0]), float(found.probability[0])
        if self.model.target != "position":
            return self._class_answer(label, found.chances[0])
        if label == "1":
            region = self.model.regions(sweep, rest)[0]
            return _position_answer(*self.model.positions(sweep, rest), region)
        return _answer_without_position(label, probability)

    def described(self, followed: FollowedAnswer) -> TouchAnswer:
        """Answer for a filtered or adaptive result."""
        if self.model.target != "position":
            answer = self._class_answer(followed.label, followed.probabilities)
        elif followed.coordinates:
            x, y, across, up = followed.coordinates
            words, shade = f"x {x:.0f} mm, y {y:.0f} mm", followed.region and followed.region.shade
            answer = TouchAnswer(words, followed.probability, None, (x, y), (across, up), shade)
        else:
            answer = _answer_without_position(followed.label, followed.probability)
        return replace(
            answer, remark=TOUCH_CHANGED if followed.changed > MAX_CHANGE_PROBABILITY else ""
        )

    def _class_answer(self, label: str, chances: NDArray) -> TouchAnswer:
        names = [str(each) for each in self.model.classes]
        return answer_of_classes(
            self.model.target, label, names, chances, self.parts.skin.pixels.shape
        )


def _position_answer(found: NDArray, deviations: NDArray, region: Region | None) -> TouchAnswer:
    x, y, strength = found[0].tolist()
    across, up = deviations[0, :2].tolist()
    words = f"x {x:.0f} mm, y {y:.0f} mm, strength {strength:.2g}"
    shade = region and region.shade
    return TouchAnswer(words, position=(x, y), deviation=(across, up), region=shade)


def _answer_without_position(label: str, probability: float) -> TouchAnswer:
    if label == "0":
        return TouchAnswer(NOTHING_PRESSED, probability, pixel=(0, 0))
    return TouchAnswer(CANNOT_TELL)
