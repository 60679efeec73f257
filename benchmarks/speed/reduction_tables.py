"""Skins and presses that reduced models are measured on, and the tables: whether they keep their
targets, how the cost of a sweep grows with the pixels, how the error falls with the basis, and one
sheet by five ways.

All sweeps are of 20 frequencies from 40 Hz to 200 kHz.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, best_time
from rcskin.benchmarks.rivals import finite_elements, ngspice_grid
from rcskin.benchmarks.rivals.bilinear import Cells
from rcskin.benchmarks.rivals.finite_elements import Elements
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.reduced.cases import pixel_touches
from rcskin.simulator.models.reduced.greedy import MESH_DRAWS, reduce
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.models.reduced.reduced_skin import ReducedSkin
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import PressBatch, TouchedCells
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

FREQUENCIES = np.geomspace(40.0, 200e3, 20)
FACTORS = (1.2, 3.0)
RTOL, TRUE_RTOL = 1e-5, 1e-8
BATCH = 1000

Impedance = NDArray[np.complex128]


@dataclass(frozen=True)
class Skin:
    """A scene by its name, with other pixels or with its interfaces crossed.

    pixels: along either side. crossed: each interface drives the top foil of its own pair against
    the bottom foil of the other pair, so that no one field serves.
    """

    name: str
    pixels: int = 5
    crossed: bool = False

    @property
    def title(self) -> str:
        """For tables."""
        pixels = "" if self.pixels == 5 else f", {self.pixels}x{self.pixels} pixels"
        return self.name + pixels + (", crossed" if self.crossed else "")

    def scene(self) -> Scene:
        """The scene at the frequencies of the benchmark."""
        scene = load_scene(self.name)
        tables = scene.model_dump(by_alias=True, exclude_none=True)
        tables["sweep"] = {"frequencies": FREQUENCIES.tolist()}
        tables["pixels"] = {"rows": self.pixels, "columns": self.pixels}
        if self.crossed:
            first, second = tables["interface"]
            first["low"], second["low"] = second["low"], first["low"]
        return Scene.model_validate(tables)


@dataclass(frozen=True)
class Presses:
    """Random single and double pixel presses."""

    scene: Scene
    batch: PressBatch

    @classmethod
    def drawn(cls, scene: Scene, count: int, seed: int) -> Presses:
        """Not those of the training: the seed is another."""
        random, draw = (
            np.random.default_rng(seed),
            pixel_touches(scene.parts.skin, scene.parts.plan, FACTORS),
        )
        cases = [draw(random) for _ in range(count)]
        return cls(scene, PressBatch.of((case.cells, case.rises) for case in cases))

    def doubtful(self, skin: ReducedSkin, count: int) -> tuple[Presses, NDArray[np.float64]]:
        """Those with the largest certificates, and the certificates of all."""
        each = list(self)
        certified = np.array([skin.certificate(*press).max() for press in each])
        worst_first = np.argsort(-certified)[:count]
        return Presses(self.scene, PressBatch.of(each[k] for k in worst_first)), certified

    def __iter__(self) -> Iterator[TouchedCells]:
        return self.batch.each()

    def named(self) -> list[Press]:
        """The same as the full solver takes them."""
        columns = self.scene.pixels.columns
        return [
            Press(
                tuple(
                    Touch(int(cell) // columns + 1, int(cell) % columns + 1, 1 + float(rise))
                    for cell, rise in zip(cells, rises, strict=True)
                )
            )
            for cells, rises in self
        ]

    def solved(self, skin: ReducedSkin) -> Impedance:
        """Z in ohm by a reduced model, shape (press, interface, frequency)."""
        return skin.sweeps(self.batch)


@dataclass(frozen=True)
class Prepared:
    """A reduced model and the time in s that it took to prepare."""

    reduced: Reduced
    seconds: float


@cache
def prepared(skin: Skin, rtol: float = RTOL) -> Prepared:
    """Trained on presses as they are asked, by compiled kernels."""
    compiled()
    scene = skin.scene()
    start = time.perf_counter()
    reduced = reduce(scene.parts, rtol, pixel_touches(scene.parts.skin, scene.parts.plan, FACTORS))
    return Prepared(reduced, time.perf_counter() - start)


@cache
def compiled() -> None:
    """Kernels are compiled once for all skins."""
    scene = Skin("sheet-5x5", pixels=2).scene()
    Presses.drawn(scene, 1, 0).solved(reduce(scene.parts, 1e-3).at(None))


def worst(Z: Impedance, truth: Impedance) -> float:
    """Largest relative error of Rs and Cp. Z, truth: shape (..., frequency)."""
    return float(relative_difference(Z, truth).max())


def true_impedance(presses: Presses) -> Impedance:
    """Z in ohm by the full solver, shape (press, interface, frequency)."""
    solver = Solver(presses.scene.parts, TRUE_RTOL)
    return np.stack([solver.solve(press).Z for press in presses.named()])


def sharpened(reduced: Reduced) -> Reduced:
    """The same basis, with Lanczos' method taken so far that it leaves nothing to be seen."""
    return replace(reduced, rtol=1e-3 * reduced.rtol, built=reduced.family)


def against_exact(skin: ReducedSkin, presses: Presses) -> tuple[NDArray, NDArray]:
    """What the basis leaves out of each press, and its certificate; shape (press,)."""
    Z = presses.solved(skin)
    errors = [worst(one, unreduced(skin, *press)) for one, press in zip(Z, presses, strict=True)]
    return np.array(errors), np.array([skin.certificate(*press).max() for press in presses])


def unreduced(skin: ReducedSkin, cells: NDArray[np.int64], rises: NDArray[np.float64]) -> Impedance:
    """Z in ohm of one press on the very mesh that was reduced, shape (interface, frequency)."""
    reduced = skin.reduced
    loss = (skin.variation or reduced.parts.skin.foam).loss
    asked = skin.weights, loss, skin.map_of(cells, rises), reduced.rtol, reduced.frequency
    return reduced.family.solved(*asked, reduced.circuit.excitations)[0]


def microseconds(skin: ReducedSkin, scene: Scene, count: int = BATCH) -> float:
    """Of a press with all its interfaces, in a batch of so many."""
    presses = Presses.drawn(scene, count, seed=2)
    return 1e6 * best_time(lambda: presses.solved(skin)) / count


CERTIFIED = 100
"""Random presses, of which the most doubtful are checked."""
WRONG = 1e-3
"""What is off by more is not timed."""
IN_A_BATCH = "a sweep in a batch (µs per interface)"


@dataclass(frozen=True)
class Target:
    """Limits of one skin, and how many presses the full solver checks.

    microseconds: of a sweep, per interface. seconds: of the preparation, where it is limited.
    """

    skin: Skin
    microseconds: float
    seconds: float
    presses: int


TARGETS = (
    Target(Skin("sheet-5x5"), 20.0, 5.0, 30),
    Target(Skin("sheet-5x5-crossed"), 60.0, np.inf, 30),
    Target(Skin("sheet-5x5-two-interfaces"), 60.0, np.inf, 4),
    Target(Skin("sheet-5x5-two-interfaces", crossed=True), 60.0, np.inf, 2),
    Target(Skin("sheet-5x5", pixels=20), 200.0, 60.0, 12),
)


def by_targets(run: Run) -> pd.DataFrame:
    """One row for each target."""
    few = [replace(target, presses=FEW_PRESSES) for target in TARGETS[:2]]
    return pd.DataFrame([measured(target) for target in run.sized(TARGETS, tuple(few))])


def measured(target: Target) -> dict[str, str | float]:
    """One row: sizes, times, errors, and whether all limits are kept."""
    model = prepared(target.skin)
    errors = _errors(model.reduced, target.presses)
    if not errors["true error"] < WRONG:
        raise AssertionError(f"{target.skin.title}: off by {errors['true error']:.1e}")
    times = {"preparation (s)": model.seconds, **_times(model.reduced)}
    limits = (RTOL, target.microseconds, target.seconds)
    reached = (errors["true error"], times[IN_A_BATCH], times["preparation (s)"])
    kept = all(value <= limit for value, limit in zip(reached, limits, strict=True))
    return {
        "skin": target.skin.title,
        "tolerance": f"{model.reduced.rtol:g}",
        "fields": model.reduced.circuit.fields,
        "unknowns": model.reduced.family.space.inner,
        "vectors": model.reduced.size,
        **times,
        f"checked of {CERTIFIED} presses": target.presses,
        **errors,
        "limits (µs, s)": f"{target.microseconds:g}, {target.seconds:g}".replace("inf", "-"),
        "kept": "yes" if kept else "no",
    }


def _times(reduced: Reduced) -> dict[str, float]:
    skin, interfaces = reduced.at(None), len(reduced.circuit.excitations)
    return {
        name: microseconds(skin, reduced.parts.scene, count) / interfaces
        for name, count in ((IN_A_BATCH, BATCH), ("a single call (µs per interface)", 1))
    }


def _errors(reduced: Reduced, count: int) -> dict[str, float]:
    """Of the presses with the largest certificates: against the full solver, and of the basis."""
    skin = reduced.at(None)
    presses, certified = Presses.drawn(reduced.parts.scene, CERTIFIED, seed=1).doubtful(skin, count)
    left_out, bounds = against_exact(sharpened(reduced).at(None), presses)
    ratio = bounds / left_out
    return {
        "true error": worst(presses.solved(skin), true_impedance(presses)),
        "left out by the basis": float(left_out.max()),
        "largest certificate": float(certified.max()),
        "certificates above it (%)": 100 * float((certified > reduced.rtol).mean()),
        "certificate over left out, least": float(ratio.min()),
        "certificate over left out, median": float(np.median(ratio)),
    }


SHEET = "sheet-5x5"
PIXELS = (2, 4, 8, 16, 20, 32)
QUICK_PIXELS = (2, 4, 8)
LARGE_RTOL = 1e-7
AGREEING = 2 * RTOL
"""Two answers within the tolerance of the truth differ by no more."""


def by_pixels(run: Run) -> pd.DataFrame:
    """Times of both models on square sheets of more and more pixels."""
    return pd.DataFrame([_cost(pixels) for pixels in run.sized(PIXELS, QUICK_PIXELS)])


def _cost(pixels: int) -> dict[str, float]:
    model = prepared(Skin(SHEET, pixels))
    reduced, skin = model.reduced, model.reduced.at(None)
    presses = Presses.drawn(reduced.parts.scene, 4, seed=3)
    named, solver = presses.named(), Solver(reduced.parts, RTOL)
    truth = np.stack([solver.solve(press).Z for press in named])
    difference = worst(presses.solved(skin), truth)
    if not difference <= AGREEING:
        raise AssertionError(f"{pixels}x{pixels} pixels: the models differ by {difference:.1e}")
    full = best_time(lambda: [solver.solve(press) for press in named], 3) / len(named)
    return {
        "pixels along a side": pixels,
        "unknowns": reduced.family.space.inner,
        "vectors": reduced.size,
        "preparation (s)": model.seconds,
        "full (µs)": 1e6 * full,
        "reduced (µs)": microseconds(skin, reduced.parts.scene),
        "difference": difference,
    }


def by_size(run: Run) -> pd.DataFrame:
    """Error and certificate of the leading vectors of one large basis."""
    reduced = prepared(Skin(SHEET), LARGE_RTOL).reduced
    leading = turned(sharpened(reduced), Presses.drawn(reduced.parts.scene, 200, seed=4))
    presses = Presses.drawn(reduced.parts.scene, run.sized(30, 6), seed=5)
    sizes = sorted({*range(5, reduced.size, run.sized(5, 20)), reduced.size})
    rows = [against_exact(truncated(leading, size).at(None), presses) for size in sizes]
    return pd.DataFrame(
        {
            "vectors": sizes,
            "error": [errors.max() for errors, _ in rows],
            "certificate": [certified.max() for _, certified in rows],
        }
    )


def turned(reduced: Reduced, presses: Presses) -> Reduced:
    """The same space, its vectors in the order of what they give to these presses."""
    skin, terminals = reduced.at(None), len(reduced.conductance)
    found = [u[terminals:] for press in presses for u, _ in skin.solved(*press, skin.s[::4])]
    parts = np.hstack([part for u in found for part in (u.real, u.imag)])
    principal, _, _ = np.linalg.svd(parts / np.linalg.norm(parts, axis=0), full_matrices=False)
    return _in_basis(reduced, principal)


def truncated(reduced: Reduced, size: int) -> Reduced:
    """Its first vectors alone."""
    return _in_basis(reduced, np.eye(reduced.size, size))


def _in_basis(reduced: Reduced, vectors: NDArray[np.float64]) -> Reduced:
    """The model in some combinations of its vectors, orthonormal, shape (size, new size)."""
    terminals = len(reduced.conductance)
    size = vectors.shape[1]
    whole = np.eye(terminals + reduced.size, terminals + size)
    whole[terminals:, terminals:] = vectors
    return replace(
        reduced,
        basis=reduced.basis @ vectors,
        stiffness=whole.T @ reduced.stiffness @ whole,
        factors=reduced.factors @ whole,
    )


PRESSES, FEW_PRESSES, SPICE_PRESSES = 30, 4, 1
TRAINED_BY, FEW_TRAINED_BY = 100, 4
SHIFTS = (40.0, 2.8e3, 200e3)
"""Hz: every press that is trained on at each of them."""
GREEDY_RTOL = 2e-4
"""Of the field: about the coarsest that keeps 1e-5 of Rs and Cp on presses it is not trained on."""
TURNS = {"real shifts": 2 * np.pi, "imaginary shifts": 2j * np.pi}
"""From frequencies to s in rad/s."""


@dataclass(frozen=True)
class Found:
    """Z in ohm of the first presses, shape (press, frequency), and times.

    preparation: s, of what serves all presses. sweep: µs. of_same: whether of the same matrices.
    """

    way: str
    setting: str
    preparation: float
    sweep: float
    Z: Impedance
    of_same: bool = False


def by_ways(run: Run) -> pd.DataFrame:
    """One row for each way: the true error, and that against the matrices that were reduced."""
    reduced = prepared(Skin("sheet-5x5")).reduced
    presses = Presses.drawn(reduced.parts.scene, run.sized(PRESSES, FEW_PRESSES), seed=6)
    truth = true_impedance(presses)[:, 0]
    skin = reduced.at(None)
    exact = np.stack([unreduced(skin, *press)[0] for press in presses])
    rows = []
    for found in _ways(reduced, presses, run):
        count = len(found.Z)
        rows.append(
            {
                "way": found.way,
                "setting": found.setting,
                "preparation (s)": found.preparation,
                "a sweep (µs)": found.sweep,
                "presses": count,
                "true error": worst(found.Z, truth[:count]),
                "of the same matrices": worst(found.Z, exact) if found.of_same else np.nan,
            }
        )
    return pd.DataFrame(rows)


def _ways(reduced: Reduced, presses: Presses, run: Run) -> Iterator[Found]:
    yield _reduced(reduced, presses)
    yield _full(presses)
    for order in (3, 4):
        way = partial(finite_elements.script, elements=Elements(order, 1))
        yield _script(f"scikit-fem Q{order}", "1x1 a pixel", way, presses)
    if not run.quick:
        ngspice_grid.ensure_ngspice()
    if run.has("ngspice"):
        way = partial(ngspice_grid.impedance, cells=Cells(40, 40))
        yield _script("ngspice", "40x40", way, presses, SPICE_PRESSES)
    for setting in run.sized(list(TURNS), ["real shifts"]) if run.has("pymor") else ():
        yield _pymor(setting, reduced, presses, run.sized(TRAINED_BY, FEW_TRAINED_BY))


def _reduced(reduced: Reduced, presses: Presses) -> Found:
    skin = reduced.at(None)
    return Found(
        "reduced model",
        f"{reduced.rtol:g}, {reduced.size} vectors",
        prepared(Skin("sheet-5x5")).seconds,
        microseconds(skin, reduced.parts.scene),
        presses.solved(skin)[:, 0],
        of_same=True,
    )


def _full(presses: Presses) -> Found:
    """The shipped solver: its preparation is a first press."""
    named = presses.named()
    start = time.perf_counter()
    solver = Solver(presses.scene.parts, RTOL)
    solver.solve(named[0])
    first = time.perf_counter() - start
    Z = np.stack([solver.solve(press).Z[0] for press in named])
    again = best_time(lambda: [solver.solve(press) for press in named], 3)
    return Found("full model", f"{RTOL:g}", first, 1e6 * again / len(named), Z)


def _script(
    name: str,
    setting: str,
    way: Callable[..., Impedance],
    presses: Presses,
    count: int | None = None,
) -> Found:
    """A way that starts anew with every press."""
    given = [(presses.scene, press, FREQUENCIES) for press in presses.named()[:count]]
    Z = np.stack([way(*each) for each in given])
    return Found(name, setting, 0.0, 1e6 * best_time(lambda: way(*given[0]), 2), Z)


def _pymor(setting: str, reduced: Reduced, presses: Presses, trained_by: int) -> Found:
    """pyMOR's basis of the same matrices, from the presses that our training begins with."""
    from rcskin.benchmarks.rivals import pymor_basis

    start = time.perf_counter()
    training = [(TURNS[setting] * f, c) for c in _training(reduced, trained_by) for f in SHIFTS]
    matrices = pymor_basis.Matrices.of_family(reduced.family)
    basis = pymor_basis.Basis(matrices, training, GREEDY_RTOL)
    preparation = time.perf_counter() - start
    maps = [reduced.at(None).map_of(*press).ravel() for press in presses]
    Z = np.stack([basis.impedance(c, FREQUENCIES) for c in maps])
    again = best_time(lambda: [basis.impedance(c, FREQUENCIES) for c in maps], 3)
    told = f"{setting}, {basis.size} vectors"
    return Found("pyMOR", told, preparation, 1e6 * again / len(maps), Z, of_same=True)


def _training(reduced: Reduced, count: int) -> list[NDArray[np.float64]]:
    """c of each pixel over that at rest, of the presses that `reduction.reduce` draws first."""
    random, draw = (
        np.random.default_rng(0),
        pixel_touches(reduced.parts.skin, reduced.parts.plan, FACTORS),
    )
    cases = [draw(random) for _ in range(MESH_DRAWS + count)][MESH_DRAWS:]
    skin = reduced.at(None)
    return [skin.map_of(case.cells, case.rises).ravel() for case in cases]
