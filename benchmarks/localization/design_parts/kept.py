"""A folder of everything that takes time, so that a run that was stopped goes on."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TypeVar

from rcskin.benchmarks.localization.design_parts.goals import SHOWN, Goal
from rcskin.benchmarks.localization.design_parts.searching import command, searched
from rcskin.benchmarks.localization.twin_parts.scenes import built
from rcskin.benchmarks.localization.twin_parts.training import BY_CHANGE, CHANGE, SEED, WHOLE
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

READ = {"gaussian": ("lnZ", "phase")}
"""Features that localizers take beside WHOLE."""
Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Kept:
    """That folder, of one goal. searches: the folder of designs that were found."""

    folder: Path
    goal: Goal
    searches: Path

    def designed(self) -> Scene:
        """As `rcskin design` finds it."""
        return load_scene(self.design)

    @cached_property
    def design(self) -> Path:
        """The scene that is found."""
        return searched(self.goal.trial.believed, self.goal.asked, self.searches) / "design.toml"

    def model(self, name: str, sweeps: int) -> Path:
        """A localizer, trained on simulation alone."""
        data, path = self.folder / "skins.zarr", self.folder / f"{name}.npz"
        asked = "--sweeps", str(sweeps), "--seed", str(SEED), "--rtol", str(self.goal.rtol)
        command("dataset", str(self.design), *asked, "-o", str(data))
        if not path.exists():
            whole = CHANGE if name in BY_CHANGE else WHOLE
            shown = "--most", str(min(SHOWN.get(name, sweeps), sweeps)), "--features"
            shown = *shown, ",".join((*whole, *READ.get(name, ())))
            told = "--target", self.goal.trial.target, "--estimator", name
            command("train", str(data), *told, *shown, "-o", str(path))
        return path

    def has(self, name: str) -> bool:
        """Whether that answer is there."""
        return self._answer(name).exists()

    def once(self, name: str, made: Callable[[], Answer]) -> Answer:
        """An answer that JSON can hold, made where it is not there yet."""
        path = self._answer(name)
        if not path.exists():
            path.write_text(json.dumps(made()), encoding="utf-8")
        return json.loads(path.read_text(encoding="utf-8"))

    def _answer(self, name: str) -> Path:
        return self.folder / f"{name}.json"

    def as_meant(self) -> float:
        """The merit of the design as it was meant, as the search told."""
        told = json.loads((self.design.parent / "design.json").read_text(encoding="utf-8"))
        return [each for each in told["steps"] if each["taken"]][-1]["as_meant"]

    def family(self, scene: Scene) -> Reduced:
        """Of the twins, which are more than localizers believe."""
        path = self.folder / "twins.npz"
        if not path.exists():
            save(reduced(built(scene).parts, self.goal.rtol), path)
        return load(path)
