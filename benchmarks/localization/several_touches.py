"""How often a localizer of one touch notices that there are two, and how often anyone could.

Columns of 5x5 by changes and by the paper's Rs and Cp, capacitance raised 1.3 to 4.5 times,
on skins never trained on. Best possible is the likelihood ratio of two touches to one on a skin
that is known exactly, each integrated over pixels and strengths: no test notices more pairs at its
rate of single presses (J. Neyman, E. S. Pearson, Phil. Trans. A 231 (1933) 289-337). None of this
is a measurement.

Run: python benchmarks/localization/several_touches.py [--quick]
"""

from __future__ import annotations

import itertools
import tempfile
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, launch
from rcskin.localization.inputs.baselines import RECENT, read_first
from rcskin.localization.model.training import train
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.measure.sweep_touches import counts_of
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.scene.randomisation import (
    DrawnPress,
    Fixed,
    Lognormal,
    Normal,
    Randomisation,
    Session,
)
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

Array = NDArray[np.float64]

DIRECTIONS = 10
"""Of readings that presses lead in: in others they differ by less than a hundredth of the noise."""


class KnownSkin:
    """What one and two touches look like on a scene's skin as it is, in units of the meter's noise.

    Readings are changes of ln Z from the mean of RECENT sweeps at rest: white noise, for what errs
    alike in a session drops out. A touch is of any pixel and of a strength as the scene draws it.
    """

    def __init__(self, scene: Scene, rtol: float) -> None:
        self.factor = scene.dataset.press.factor_within(scene.skin.foam)
        self.pixels = scene.pixels.rows * scene.pixels.columns
        self._skin = reduced(scene.parts, rtol).at(None)
        self._at_rest = self.log_impedance(np.zeros((1, 0), dtype=np.int64), np.ones((1, 0)))
        noise = np.array([scene.readout.magnitude_noise, scene.readout.phase_noise])
        self._noise = noise * np.sqrt(1 + 1 / RECENT)

    def changes(self, cells: NDArray[np.int64], factors: Array) -> Array:
        """Of presses of some pixels by such factors, both (press, touch); (press, reading)."""
        change = self.log_impedance(cells, factors) - self._at_rest
        return np.concatenate([change.real, change.imag], axis=1) / np.repeat(
            self._noise, change.shape[1]
        )

    def drawn(self, random: np.random.Generator, touches: int, count: int) -> Array:
        """Noisy readings of so many presses at random, (press, reading)."""
        seen = self.changes(*self.presses(random, touches, count))
        return seen + random.standard_normal(seen.shape)

    def presses(
        self, random: np.random.Generator, touches: int, count: int
    ) -> tuple[NDArray[np.int64], Array]:
        """Pixels and factors of so many at random, both (press, touch)."""
        among = np.array(list(itertools.combinations(range(self.pixels), touches)))
        cells = among[random.integers(len(among), size=count)]
        return cells, self.factor.at(random.random(cells.shape))

    def every(self, touches: int, strengths: int) -> Array:
        """Readings of all presses by so many strengths of the same chance, (press, reading)."""
        each = self.factor.at((np.arange(strengths) + 0.5) / strengths)
        factors = np.array(list(itertools.product(each, repeat=touches)))
        return np.concatenate(
            [
                self.changes(np.tile(cells, (len(factors), 1)), factors)
                for cells in itertools.combinations(range(self.pixels), touches)
            ]
        )

    def log_impedance(self, cells: NDArray[np.int64], factors: Array) -> NDArray[np.complex128]:
        """Of presses, without noise, (press, frequency)."""
        return np.log(self._skin.sweeps(PressBatch.even(cells, factors - 1)))[:, 0]


def log_ratio(skin: KnownSkin, seen: Array, strengths: int) -> Array:
    """ln of the likelihood of two touches over that of one, of each sweep, shape (sweep,).

    strengths: that each of two touches is integrated over; as many in a pair give those of one.
    """
    one, two = skin.every(1, strengths * strengths), skin.every(2, strengths)
    turn = np.linalg.svd(np.concatenate([one, two[::strengths]]), full_matrices=False)[2]
    turn = turn[:DIRECTIONS].T
    return _log_evidence(two @ turn, seen @ turn) - _log_evidence(one @ turn, seen @ turn)


def _log_evidence(presses: Array, seen: Array) -> Array:
    """ln of the mean likelihood over presses, less what is the same for all of them, (sweep,)."""
    presses, seen = presses.astype(np.float32), seen.astype(np.float32)
    half = np.square(presses).sum(axis=1) / 2
    found = [presses @ each - half for each in seen]
    return np.array(
        [best + np.log(np.mean(np.exp(f - best))) for f in found for best in (f.max(),)]
    )


RTOL = 1e-3
TRAINED, FEW_TRAINED = 8000, 600
ASKED, FEW_ASKED = 4000, 300
STRENGTHS, FEW_STRENGTHS = 48, 8
DRAWN, FEW_DRAWN = 500, 40
ANSWERED = 0.98
"""Of single presses, at which the best possible is told."""
SKIN = Session(sweeps_per_session=100, rest_every=10)
ONE_SKIN = SKIN.model_copy(
    update={
        **dict.fromkeys(
            ("sheet_resistance", "sheet_mismatch", "capacitance", "contact_resistance"),
            Fixed(value=1.0),
        ),
        **dict.fromkeys(("loss_tangent", "stray_capacitance", "lead_resistance"), Fixed(value=0.0)),
        "unevenness": 0.0,
        "foam_spread": 0.0,
    }
)
TWICE = SKIN.model_copy(
    update={
        "sheet_resistance": Lognormal(median=1.0, spread=0.1),
        "sheet_mismatch": Lognormal(median=1.0, spread=0.06),
        "capacitance": Normal(mean=1.0, deviation=0.06),
        "unevenness": 0.04,
        "foam_spread": 0.04,
    }
)
TRIALS = {
    "one skin": (ONE_SKIN, ONE_SKIN),
    "random skins": (SKIN, SKIN),
    "random skins of twice the spread": (SKIN, TWICE),
}
FEATURES = ("dlnZ", "dphase")
ASKED_OF = ((FEATURES, "no"), (FEATURES, "yes"), (("Rs", "Cp"), "no"), (("Rs", "Cp"), "yes"))
"""Features, and whether pairs are shown in training."""


def scene_of(session: Session) -> Scene:
    """The 5x5 sheet, of which one press in three is by two touches."""
    press = DrawnPress(touches=(0.1, 0.6, 0.3))
    drawn = Randomisation(press=press, session=session)
    return load_scene("sheet-5x5").model_copy(update={"dataset": drawn})


def sweeps_of(session: Session, count: int, seed: int) -> xr.Dataset:
    """So many of a data set, as the scene's meter shows them."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sweeps.zarr"
        generate(DatasetPlan(scene_of(session).parts, count, seed, RTOL), path)
        return read_first(path, count).load()


def rows_of(name: str, known: xr.Dataset, asked: xr.Dataset) -> list[dict[str, str]]:
    """For each of ASKED_OF: pairs not told, single presses answered."""
    shown = {"no": known.isel(sweep=counts_of(known) < 2), "yes": known}
    rows = []
    for quantities, pairs in ASKED_OF:
        model = train(shown[pairs], quantities=quantities)
        X, told = model.usable_features(asked)
        novel = model.learned.novel(X, model.guard_changes(asked, None, told))
        touches = counts_of(asked)[told]
        rows.append(
            {
                "skins": name,
                "features": ",".join(quantities),
                "pairs in training": pairs,
                "pairs answered `cannot tell`": of(novel[touches == 2]),
                "single presses answered": of(~novel[touches == 1]),
            }
        )
    return rows


def best_row(count: int, strengths: int) -> dict[str, str]:
    """What the best test notices on the skin as it is, at the rate ANSWERED."""
    skin, random = KnownSkin(scene_of(ONE_SKIN), RTOL), np.random.default_rng(3)
    seen = np.concatenate([skin.drawn(random, touches, count) for touches in (1, 2)])
    ratio = log_ratio(skin, seen, strengths)
    limit = np.quantile(ratio[:count], ANSWERED, method="higher")
    return {
        "skins": "one skin, known exactly",
        "features": ",".join(FEATURES),
        "pairs in training": "best possible",
        "pairs answered `cannot tell`": of(ratio[count:] > limit),
        "single presses answered": of(ratio[:count] <= limit),
    }


def of(which: NDArray[np.bool_]) -> str:
    """As `85.4 % of 1072`."""
    return f"{100 * which.mean():.1f} % of {which.size}"


def main(run: Run) -> None:
    """Ask localizers about skins and seeds that taught them nothing, and publish."""
    learned, asked = run.sized(TRAINED, FEW_TRAINED), run.sized(ASKED, FEW_ASKED)
    rows = []
    for k, (name, (taught, other)) in enumerate(TRIALS.items()):
        known = sweeps_of(taught, learned, 1)
        rows += rows_of(name, known, sweeps_of(other, asked, 2 + k))
        print(name, flush=True)
    rows.append(best_row(run.sized(DRAWN, FEW_DRAWN), run.sized(STRENGTHS, FEW_STRENGTHS)))
    title = "Two touches shown to a localizer of one: columns of 5x5, factors from 1.3 to 4.5"
    run.publish("several_touches", title, rows)


if __name__ == "__main__":
    launch(main)
