"""Is the bound of a designed skin reached? 6x6 pixels from four wires, as designed, on twins.

`rcskin design` finds sheets, readings and frequencies. Localizers are trained on simulation of that
skin alone; twins of it, cast as [dataset.session] spreads them, are read over TCP by the virtual
meter, and pressed by a hand that misses pixels a little.

Run: python benchmarks/localization/twin_design.py [--skins 20] [--quick]
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import pandas as pd
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.benchmarks.localization.twin import SKINS, experiment, summary
from rcskin.benchmarks.localization.twin_parts.scenes import OFFSET, believed
from rcskin.benchmarks.localization.twin_parts.trials import SINGLE, TWO, Trial, every_pixel
from rcskin.simulator.limits import hand_accuracy
from rcskin.simulator.scene.files import load_scene, scene_text
from rcskin.simulator.scene.scene import Scene

LOCALIZERS = ("ksvm-ovo", "model-based", "model-adapted")
TRAINING, RESTS = 12_000, 6
GOAL = 0.9


def designed(scene: Scene, folder: Path, options: list[str]) -> Scene:
    """As `rcskin design` finds it; what the search knows stays in the folder."""
    path = folder / "asked.toml"
    path.write_text(scene_text(scene), encoding="utf-8")
    command = [sys.executable, "-m", "rcskin", "design", str(path), *options]
    subprocess.run([*command, "-o", str(folder / "designed")], check=True)
    found = load_scene(folder / "designed" / "design.toml")
    return found.model_copy(update={"name": f"{scene.name}, as designed"})


def trial(scene: Scene, training: int) -> Trial:
    """Every pixel twice, by the same hand as in the other trials."""
    return Trial(
        f"pixel of {scene.name}",
        scene,
        "pixel",
        every_pixel(2),
        LOCALIZERS,
        GOAL,
        training=training,
    )


def bound(scene: Scene, run: Run) -> str:
    """Of a skin that is known and that hand, against rest, in %."""
    between = hand_accuracy(
        scene,
        "pixel",
        offset=OFFSET,
        against_rest=RESTS,
        draws=run.sized(400, 20),
        samples=run.sized(2000, 50),
    )
    return f"{100 * between.least:.1f} to {100 * between.most:.1f}"


def main(run: Run) -> None:
    """The scene as it is, then as designed; a folder of the search keeps it for another run."""
    with tempfile.TemporaryDirectory() as scratch:
        told(run, run.asked.found or Path(scratch))


def told(run: Run, folder: Path) -> None:
    """Search, ask both skins, and write the table."""
    folder.mkdir(parents=True, exist_ok=True)
    pixels, skins = run.sized(6, 2), run.asked.skins or run.sized(SKINS, 1)
    plain = believed(TWO, pixels, SINGLE)
    options = run.sized([], ["--casts", "1", "--draws", "20", "--readings", "2"])
    rows = []
    for scene in (plain, designed(plain, folder, options)):
        one, most = trial(scene, run.sized(TRAINING, 400)), bound(scene, run)
        for _, told in summary(experiment(one, skins, run.asked.processes)).iterrows():
            rows.append(
                {
                    "skin": scene.name,
                    "readings": len(scene.interfaces),
                    "kohm/sq": round(scene.skin.top.sheet_resistance / 1e3),
                    "bound of a known skin (%)": most,
                    **told[["localizer", "skins", "10 %", "median", "90 %", "answered"]],
                }
            )
    title = f"{pixels}x{pixels} pixels from four wires: as it is, and as designed"
    publish(run.results, "twin_design", title, pd.DataFrame(rows))


def options() -> argparse.ArgumentParser:
    """Of the command line."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--skins", type=int)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--found", type=Path, help="Folder of the search, to be kept.")
    return parser


if __name__ == "__main__":
    launch(main, options())
