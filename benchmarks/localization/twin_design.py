"""Is the bound of a designed skin reached? 6x6 pixels from four wires, as designed, on twins.

`rcskin design` finds sheets, readings and frequencies, `rcskin dataset` simulates sweeps of skins
like it, `rcskin train` makes localizers of them: all as a user does. Twins, cast as
[dataset.session] spreads them, are read over TCP by the virtual meter, and pressed by a hand that
misses pixels a little. Beside that, the same twins are read at once, with and without their drift:
what stands between the bound of a known skin and what is reached. The bound is of the design as it
is meant, and of each twin's own skin as it is.

Run: python benchmarks/localization/twin_design.py [--skins 20] [--localizers NAME,...]
     [--training SWEEPS] [--second] [--quick]
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from joblib import Parallel, delayed
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.benchmarks.localization.twin import SEED, WHOLE, equip, localizers
from rcskin.benchmarks.localization.twin_parts.known import known_accuracy
from rcskin.benchmarks.localization.twin_parts.reading import HELD, ONE, OWN, read_at_once
from rcskin.benchmarks.localization.twin_parts.recording import recorded
from rcskin.benchmarks.localization.twin_parts.scenes import OFFSET, believed, built
from rcskin.benchmarks.localization.twin_parts.skin import Drift, Hand, Twin
from rcskin.benchmarks.localization.twin_parts.trials import SINGLE, TWO, Trial, every_pixel
from rcskin.localization.inputs.rest import RECENT
from rcskin.localization.model.file import load as load_model
from rcskin.simulator.dataset.model import reduced
from rcskin.simulator.limits import hand_accuracy
from rcskin.simulator.limits.hand import Between
from rcskin.simulator.models.reduced.file import load, save
from rcskin.simulator.models.reduced.model import Reduced
from rcskin.simulator.scene.files import load_scene, scene_text
from rcskin.simulator.scene.scene import Scene

RTOL = 1e-2
"""Of Rs and Cp, certified; readings are some ten times closer, a tenth of the meter's noise."""
SKINS, TRAINING, FEW = 20, 100_000, 600
LOCALIZERS = ("gaussian", "ksvm-ovo")
FIRST = LOCALIZERS[:1]
A_SECOND = "--seconds", "1", "--readings", "12"
"""Asked of `rcskin design` where a sweep may take that long."""
SHOWN = {"gaussian": math.inf, "ksvm-ovo": 10_000, "model-adapted": 5_000, "network": math.inf}
"""Sweeps of the data set that each is trained on, at most."""
READ = {"gaussian": ("lnZ", "phase")}
"""Features that localizers take beside WHOLE."""
GOAL = 0.9
KNOWN = 400, 600
"""Draws of a twin, and presses of each pixel, that tell the bound of its own skin."""
STILL = Drift(capacitance=0.0, resistance=0.0, step=0.0)
TCP = "over TCP"
WAYS = {
    "at once, without drift": ONE,
    "at once": ONE,
    "at once, each range with its gain": OWN,
    "at once, these ranges held": HELD,
    TCP: OWN,
}
"""How a twin is read, and what its meter's ranges are."""


@dataclass(frozen=True)
class Kept:
    """A folder of everything that took time, for another run."""

    folder: Path

    def designed(self, scene: Scene, options: list[str]) -> Scene:
        """As `rcskin design` finds it."""
        path = self.folder / "asked.toml"
        if not self.design.exists():
            path.write_text(scene_text(scene), encoding="utf-8")
            command("design", str(path), *options, "-o", str(self.design.parent))
        return load_scene(self.design)

    @property
    def design(self) -> Path:
        """The scene that was found."""
        return self.folder / "designed" / "design.toml"

    def model(self, name: str, sweeps: int) -> Path:
        """A localizer of pixels, trained on simulation alone."""
        data, path = self.folder / "skins.zarr", self.folder / f"{name}.skops"
        asked = "--sweeps", str(sweeps), "--seed", str(SEED), "--rtol", str(RTOL)
        command("dataset", str(self.design), *asked, "-o", str(data))
        if not path.exists():
            shown = "--most", str(min(SHOWN[name], sweeps)), "--features"
            shown = *shown, ",".join((*WHOLE, *READ.get(name, ())))
            told = "--target", "pixel", "--estimator", name
            command("train", str(data), *told, *shown, "-o", str(path))
        return path

    def bound(self, scene: Scene, draws: int, samples: int) -> Between:
        """Of a known skin and the twins' hand, against as many rests as localizers take."""
        path = self.folder / "bound.json"
        if not path.exists():
            told = {"draws": draws, "samples": samples, "against_rest": RECENT}
            found = hand_accuracy(scene, "pixel", offset=OFFSET, **told)
            path.write_text(json.dumps(found._asdict()), encoding="utf-8")
        return Between(**json.loads(path.read_text(encoding="utf-8")))

    def whole(self) -> float:
        """Of the design as it was meant, pixels hit whole, as the search told."""
        told = json.loads((self.design.parent / "design.json").read_text(encoding="utf-8"))
        return [each for each in told["steps"] if each["taken"]][-1]["as_meant"]

    def family(self, scene: Scene) -> Reduced:
        """Of the twins, which are more than localizers believe."""
        path = self.folder / "twins.npz"
        if not path.exists():
            save(reduced(scene, RTOL), path)
        return load(path)


def command(*words: str) -> None:
    """Run a command of rcskin; raises CalledProcessError where it fails."""
    subprocess.run([sys.executable, "-m", "rcskin", *words], check=True)


def asked_of(scene: Scene) -> Trial:
    """Every pixel once, by the same hand as in the other trials."""
    return Trial("pixel", scene, "pixel", every_pixel(1), LOCALIZERS, GOAL, training=0)


def scores(
    trial: Trial,
    family: Reduced,
    models: dict[str, Path],
    number: int,
    ways: Iterable[str] = tuple(WAYS),
) -> list[dict]:
    """Of one twin: a row for each localizer and each way of reading it, of WAYS."""
    scene = trial.believed
    presses = trial.recording(np.random.default_rng([SEED, number]))
    rows = []
    for way in ways:
        drift = STILL if way.endswith("without drift") else Drift()
        twin = Twin(built(scene), family, SEED, number, Hand(offset=OFFSET), drift)
        sweeps = _read(twin, presses, way, [each.name for each in scene.interfaces])
        sweeps.attrs["scene"] = scene_text(scene)
        for name, path in models.items():
            model = load_model(path, localizers())
            equip(model)
            right, answered = trial.score(model, sweeps)
            rows.append(
                {
                    "skin": number,
                    "localizer": name,
                    "read": way,
                    "right": right,
                    "answered": answered,
                }
            )
    return rows


def _read(twin: Twin, presses: list[str], way: str, interfaces: list[str]) -> xr.Dataset:
    if way == TCP:
        return recorded(twin, presses, interfaces)
    return read_at_once(twin, presses, ranges=WAYS[way])


def known(trial: Trial, family: Reduced, number: int, draws: int, samples: int) -> float:
    """The bound of one twin, pressed by its hand, for whoever knows its skin and meets no drift."""
    scene = trial.believed
    twin = Twin(built(scene), family, SEED, number, Hand(offset=OFFSET), STILL)
    bound = known_accuracy(scene, twin, draws=draws, samples=samples, against_rest=RECENT)
    return (bound.least + bound.most) / 2


def summary(found: pd.DataFrame) -> list[dict[str, object]]:
    """One row for each localizer and way of reading: the distribution over skins, in %."""
    rows = []
    for (name, way), group in found.groupby(["localizer", "read"], sort=False):
        answered = {"answered": f"{100 * group['answered'].mean():.1f}"}
        rows.append({"who": name} | spread(group["right"], way) | answered)
    return rows


def spread(right: pd.Series, way: str) -> dict[str, object]:
    """Over skins, in %."""
    right = 100 * right
    return {
        "skins": f"{len(right)} twins, {way}",
        "10 %": f"{right.quantile(0.1):.1f}",
        "median": f"{right.median():.1f}",
        "90 %": f"{right.quantile(0.9):.1f}",
        "mean": f"{right.mean():.1f} ± {right.std(ddof=0) / len(right) ** 0.5:.1f}",
    }


def found_by(run: Run, kept: Kept, asked: Iterable[str] = ()) -> Scene:
    """The design that twins are of. asked: options of the search."""
    quick = ["--casts", "1", "--draws", "20", "--readings", "2"]
    plain = believed(TWO, run.sized(6, 2), SINGLE)
    return kept.designed(plain, run.sized(list(asked), quick))


def told(run: Run, folder: Path) -> None:
    """Search, train, ask the twins, and write the table."""
    folder.mkdir(parents=True, exist_ok=True)
    kept, skins = Kept(folder), run.asked.skins or run.sized(SKINS, 1)
    asked, second = run.asked.localizers, run.asked.second
    scene = found_by(run, kept, A_SECOND if second else ())
    names = asked.split(",") if asked else run.sized(FIRST if second else LOCALIZERS, FIRST)
    sweeps = run.asked.training or run.sized(TRAINING, FEW)
    models = {name: kept.model(name, sweeps) for name in names}
    trial, family = asked_of(scene), kept.family(built(scene))
    work = (delayed(scores)(trial, family, models, number) for number in range(skins))
    found = pd.DataFrame(
        [row for rows in Parallel(n_jobs=run.asked.processes)(work) for row in rows]
    )
    judged = run.sized(KNOWN, (20, 10))
    own = (delayed(known)(trial, family, number, *judged) for number in range(skins))
    own_skins = pd.Series(Parallel(n_jobs=run.asked.processes)(own))
    hand = kept.bound(scene, run.sized(1000, 20), run.sized(2000, 50))
    middle = f"{50 * (hand.least + hand.most):.1f} ± {100 * hand.error:.1f}"
    bounds = [
        {"who": "bound", "skins": f"a known skin, {hit}", "mean": mean}
        for hit, mean in (
            ("pixels hit whole", f"{100 * kept.whole():.1f}"),
            ("the twins' hand", middle),
        )
    ]
    bounds.append({"who": "bound"} | spread(own_skins, "each known, without drift"))
    table = pd.DataFrame([*bounds, *summary(found)]).astype(object).fillna("-")
    pixels = scene.pixels
    title = f"Pixels of {pixels.rows}x{pixels.columns} told right (%), four wires, as designed"
    name = "twin_design_second" if second else "twin_design"
    columns = ["who", "skins", "10 %", "median", "90 %", "mean", "answered"]
    publish(run.results, name, title, table[columns])


def in_its_folder(run: Run, tell: Callable[[Run, Path], None]) -> None:
    """Do what takes time in a folder that is asked for, or in one that is not kept."""
    with tempfile.TemporaryDirectory() as scratch:
        tell(run, run.asked.found or Path(scratch))


def main(run: Run) -> None:
    """All of it."""
    in_its_folder(run, told)


def shared_options() -> argparse.ArgumentParser:
    """Of the command line, of all that ask twins of a design."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--skins", type=int)
    parser.add_argument("--training", type=int, help="Simulated sweeps of the data set.")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--found", type=Path, help="Folder of what takes time, to be kept.")
    return parser


def options() -> argparse.ArgumentParser:
    """Of the command line."""
    parser = shared_options()
    parser.add_argument("--localizers", help=f"Of {', '.join(SHOWN)}, joined by commas.")
    parser.add_argument("--second", action="store_true", help="A sweep may take a second.")
    return parser


if __name__ == "__main__":
    launch(main, options())
