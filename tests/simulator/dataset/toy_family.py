"""A family of skins that costs nothing: one R and one C, for tests of everything around it.

Importable by name, so that other processes can load it.
"""

import pickle
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.skin_model import Training
from rcskin.simulator.scene.parts import SceneParts
from rcskin.simulator.scene.scene_files import load_scene


@dataclass(frozen=True)
class ToySkin:
    """R and C of a skin pressed on some cells; presses of `doubtful` touches have a poor bound."""

    parts: SceneParts
    variation: object
    doubtful: int | None

    def sweeps(self, batch):
        return np.array([self._Z(*touched) for touched in batch.each()])

    def certificate(self, cells, rises):
        shape = (2, len(self.parts.setup.interfaces), len(self.parts.setup.frequency))
        return np.full(shape, 1.0 if len(cells) == self.doubtful else 1e-6 * (1 + len(cells)))

    def by_mesh(self, cells, rises):
        return 0.0

    def exact(self, cells, rises):
        return 2 * self._Z(cells, rises)

    def _Z(self, cells, rises):
        c = self.variation.capacitance.ravel().copy()
        c[cells] *= 1 + rises
        C = 1e-10 * c.mean()
        R = 1e4 * (c @ np.arange(c.size)) / c.sum() / self.variation.top[0]
        Z = R + 1 / (2j * np.pi * self.parts.setup.frequency * C)
        return np.tile(Z, (len(self.parts.setup.interfaces), 1))


@dataclass(frozen=True)
class ToyFamily:
    """Skins of a scene. delay: seconds that each takes. fine: cells along a pixel.

    tokens: a folder of files, of which each skin takes one and waits until there is one; none are
    needed where there is no such folder.
    """

    parts: SceneParts
    delay: float = 0.0
    fine: int = 1
    doubtful: int | None = None
    tokens: Path | None = None
    modes: int = 4

    @property
    def grid(self):
        return self.parts.skin.pixels.rows * self.fine, self.parts.skin.pixels.columns * self.fine

    def at(self, variation):
        time.sleep(self.delay)
        while not self._taken():
            time.sleep(0.005)
        return ToySkin(self.parts, variation, self.doubtful)

    def _taken(self):
        if self.tokens is None or not self.tokens.exists():
            return True
        for token in self.tokens.iterdir():
            with suppress(FileNotFoundError):
                token.unlink()
                return True
        return False


def training(**family):
    """Of a toy family with these options."""
    return Training(lambda parts, rtol: ToyFamily(parts, **family), _save, _load)


def _save(family, path):
    path.write_bytes(pickle.dumps(family))


def _load(path):
    return pickle.loads(path.read_bytes())


def small_plan(sweeps=400, seed=1, block=4, **session):
    """A data set of sheet-3x3 in sessions of 10 sweeps, so many of them a block."""
    scene = load_scene("sheet-3x3")
    session = scene.dataset.session.model_copy(update={"sweeps_per_session": 10, **session})
    dataset = scene.dataset.model_copy(update={"session": session})
    scene = scene.model_copy(update={"dataset": dataset})
    return DatasetPlan(scene.parts, sweeps, seed, 1e-4, block * 10 * len(scene.frequencies))


def bytes_of(folder):
    """Every file under a folder, by its path."""
    paths = (path for path in Path(folder).rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths}


def main():
    """Makes a data set in blocks of two sessions: OUTPUT SWEEPS PROCESSES TOKENS."""
    output, sweeps, processes, tokens = sys.argv[1:]
    generate(
        small_plan(int(sweeps), block=2),
        Path(output),
        processes=int(processes),
        training=training(tokens=Path(tokens)),
    )
