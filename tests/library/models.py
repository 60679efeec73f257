"""Scenes and reduced models that are made once a run, by the process that needs them first."""

import hashlib
import pickle
from functools import cache

import numpy as np
from filelock import FileLock
from rcskin.simulator.models.model import Model
from rcskin.simulator.models.reduced.cases import pixel_touches
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.press.batch import NOTHING
from rcskin.tests.library.scenes import KINDS

CASES = 4


class Library:
    """What the processes of a run share, in its folder."""

    def __init__(self, folder):
        folder.mkdir(exist_ok=True)
        self.folder, self._models = folder, {}
        self.scene = cache(self._scene)

    def _scene(self, name):
        """The scene of a kind."""
        with FileLock(self.folder / "scenes.lock"):
            return KINDS[name].make(self.folder)

    def reduce(self, parts, rtol=1e-5, draw=None, *, progress=None, **options):
        """The model that `reduce` makes, as it was trained or, by another process, as its file."""
        path = self._path(parts, rtol, draw, **options)
        if path not in self._models:
            with FileLock(path.with_suffix(".lock")):
                if path.exists():
                    self._models[path] = load(path)
                else:
                    model = self._models[path] = reduce(parts, rtol, draw, **options)
                    np.savez(path.with_suffix(".answers.npz"), **answers(model))
                    save(model, path)
        return self._models[path]

    def _path(self, parts, rtol, draw, **options):
        """File of a model; draws are told apart by their first cases."""
        random = np.random.default_rng(0)
        cases = draw and [draw(random) for _ in range(CASES)]
        given = pickle.dumps((rtol, cases, sorted(options.items())))
        digest = hashlib.sha256(parts.text.encode() + given)
        return self.folder / f"{digest.hexdigest()[:32]}.npz"

    def model(self, name):
        """The reduced model of a kind."""
        return self.reduce(*self._training(name))

    def stored(self, name):
        """Answers of the model of a kind before it was written, and those of its file."""
        self.model(name)
        path = self._path(*self._training(name))
        with np.load(path.with_suffix(".answers.npz")) as before:
            return dict(before), answers(load(path))

    def _training(self, name):
        scene, kind = self.scene(name), KINDS[name]
        return (
            scene.parts,
            kind.rtol,
            pixel_touches(scene.parts.skin, scene.parts.plan, kind.factors),
        )

    def forward(self, scene, **options):
        """A forward model of a scene, trained once."""
        return Forward(scene.parts, train=self.reduce, **options)


def impedance(model, press, frequency):
    """Z in ohm by a model, or by one mesh."""
    if isinstance(model, Model):
        return model.solve(press, frequency).Z
    return model.impedance(press, frequency)


def answers(model):
    """Z of the unpressed skin and of a touch of its first pixel, and their certificates."""
    own, first = model.at(None), (np.zeros(1, dtype=np.int64), np.array([0.5]))
    presses = {"unpressed": NOTHING, "pressed": first}
    bounds = {f"bound {name}": own.certificate(*press) for name, press in presses.items()}
    return bounds | {name: own.sweep(*press) for name, press in presses.items()}
