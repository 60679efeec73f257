"""The gallery of the site: the best pictures of the whole tool, each with the lines that make it.

`python docs/generate.py` writes the page from this table. This script draws the pictures of
`results/gallery` anew, by the commands that stand beneath them.

Run: python benchmarks/pictures/gallery.py [--quick] [PICTURE ...]
"""

from __future__ import annotations

import os
import shlex
import shutil
import tempfile
from contextlib import chdir
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageSequence
from rcskin.__main__ import app
from rcskin.benchmarks.bench import HERE, Run, launch

PAGE = HERE.parent / "docs" / "gallery.md"
SHEET = "sheet-5x5-two-interfaces"
OWN = "benchmarks/results/gallery/"
"""Folder of the pictures that this script draws."""
LARGEST = 300_000
"""Bytes of a picture of the page."""
COLOURS = 256
"""Number of colours of a picture that would be larger."""
WIDTH, FRAMES = 400, 8
"""Width of a film that would be larger, pixels, and about the number of its frames."""
HEAD = """# Gallery

What rcskin draws, by theme. The lines beneath each picture make it, typed in an empty folder;
lines that begin with `python benchmarks/` run at the root of the repository. Potentials, currents
and power are those of 1 V at the terminals. Large pictures are shown with fewer colours than the
lines give, and films smaller. Click a picture to see it in full size.

`python docs/generate.py` writes this page from the table in `benchmarks/pictures/gallery.py`.
"""


class Picture(NamedTuple):
    """A picture, the lines that make it, and what is to be seen.

    file: its path from the root of the repository. made: name under which the last line leaves it,
    if that is another. quick: options of that line in a quick pass; None leaves the picture out.
    """

    file: str
    lines: str
    caption: str
    made: str = ""
    quick: str | None = ""

    @property
    def name(self) -> str:
        """Name of the file."""
        return Path(self.file).name


def view(name: str, arguments: str, caption: str, quick: str | None = "--rtol 1e-2") -> Picture:
    """A picture of fields by the command `rcskin view`."""
    return Picture(OWN + name, f"rcskin view {arguments} -o {name}", caption, quick=quick)


def result(name: str, lines: str, caption: str, made: str = "") -> Picture:
    """A picture among the results of benchmarks."""
    return Picture(f"benchmarks/results/{name}", lines, caption, made)


EVALUATED = """rcskin dataset sheet-3x3 --sweeps 1000 -o skins.zarr
rcskin train skins.zarr --target pixel -o pixels.npz
rcskin dataset sheet-3x3 --sweeps 500 --seed 2 -o unseen.zarr
rcskin evaluate pixels.npz unseen.zarr -o evaluated"""

RECORDED = """rcskin dataset strip-1x5 --sweeps 1000 -o skins.zarr
rcskin dataset strip-1x5 --sweeps 60 --seed 2 -o mine.zarr"""
"""Lines whose second file, sweeps of one random skin, stands for a recording of one's own."""

THEMES: dict[str, tuple[Picture, ...]] = {
    "Fields in a skin": (
        view(
            "potential.png",
            f"{SHEET} --press 4,3 --frequency 2e4 --frequency 6e4 --frequency 2e5",
            "At 20 kHz every pixel counts; at 200 kHz the potential between the sheets falls "
            "towards the far corner.",
        ),
        view(
            "current.png",
            f"{SHEET} --press 4,3 --frequency 2e4 --what current",
            "The current at 20 kHz enters at the driven foil; near the corner a part takes the "
            "floating foil and leaves it farther along.",
        ),
        view(
            "sensitivity-Rs.png",
            f"{SHEET} --what sensitivity-Rs --frequency 2e3 --frequency 2e4 --frequency 2e5",
            "What a press at each place does to Rs: blue places lower it, red ones raise it, "
            "white ones leave it.",
            None,
        ),
        view(
            "sensitivity-Cp.png",
            f"{SHEET} --what sensitivity-Cp --frequency 2e3 --frequency 2e4 --frequency 2e5",
            "What a press at each place does to Cp: all places count equally at 2 kHz, and far "
            "presses lower it at 200 kHz.",
        ),
        view(
            "outline.png",
            "l-shape --press 'disc(0.09,0.025,0.012):3' --frequency 5e4 --what current",
            "In a skin cut to an L with a hole, the current of the top sheet crowds at the inner "
            "corner.",
        ),
        view(
            "mug.png",
            "mug --press 2,4:2mm --frequency 2e4 --what current",
            "A skin around a mug carries the same current as a flat one.",
        ),
        view(
            "deformation.png",
            "mug --press 2,4:2mm --what deformation --flat",
            "A pixel pressed 2 mm into 4 mm of foam, drawn flat: the tension of the skin spreads "
            "the press.",
        ),
        view(
            "frequency.gif",
            f"{SHEET} --press 4,3 --what phase",
            "The phase between the sheets from 1 to 200 kHz grows from less than one degree to "
            "more than a hundred.",
            "--rtol 1e-2 --frequency 1e3 --frequency 2e5",
        ),
        view(
            "period.gif",
            f"{SHEET} --press 4,3 --frequency 2e5 --what current --animate phase",
            "One period of the current at 200 kHz: it turns first at the foil and later far off.",
            None,
        ),
    ),
    "Scenes and sweeps": (
        Picture(
            f"{OWN}scene.png",
            "rcskin describe l-shape -o scene.png",
            "A scene from above: outline, hole, pixels, and foils with their part in the reading.",
        ),
        Picture(
            f"{OWN}sweeps.png",
            "rcskin sweep strip-1x5 -o sweeps.nc\nrcskin plot sweeps.nc -o sweeps.png",
            "Rs and Cp of a strip against frequency, and their changes under each press.",
        ),
        result(
            "sheet-5x5.png",
            "rcskin reproduce -o paper",
            "The paper's 5x5 sheet reproduced: Cp and Rs for every pressed pixel, and the "
            "confusion matrix.",
            "paper/sheet-5x5.png",
        ),
    ),
    "Limits and design": (
        result(
            "limits.png",
            f"rcskin limits {SHEET} --against-rest 6 -o limits",
            "The smallest deviation of x, y and strength that any estimator can reach, over the "
            "sheet.",
            "limits/frequencies.png",
        ),
        result(
            "study.png",
            "rcskin study sheet-5x5 -o study.csv",
            "Accuracy and separation of columns over sheet resistance and number of pixels.",
            "study.png",
        ),
        result(
            "design.png",
            "python benchmarks/localization/design.py",
            "The largest share of pixels that any localizer gets right, by number of pixels and "
            "wires, sheet resistance and error of the meter.",
        ),
        result(
            "multisine.png",
            "python benchmarks/localization/multisine.py",
            "A multisine reader reads all frequencies at once: touches that it finds, against the "
            "time of a sweep, beside a swept meter.",
        ),
    ),
    "Calibration and the gap to the skin": (
        Picture(
            f"{OWN}gap.png",
            f"{RECORDED}\nrcskin gap skins.zarr mine.zarr --charts png -o gap",
            "Columns found on one random skin, which stands for your own, by localizers trained on "
            "simulation and on some of its sweeps, before and after calibration.",
            "gap/accuracy.png",
            None,
        ),
        Picture(
            f"{OWN}residuals.png",
            f"{RECORDED}\nrcskin calibrate strip-1x5 mine.zarr -o fit",
            "What a fit of the scene to the sweeps of that skin leaves: noise of the meter.",
            "fit/residuals-left.png",
            None,
        ),
        result(
            "twin.png",
            "python benchmarks/localization/twin.py",
            "Right answers of localizers trained on simulation, on skins that they have not met; "
            "each dot is a skin.",
        ),
        result(
            "foreign_twin.png",
            "python benchmarks/localization/foreign_twin.py",
            "Right answers on skins with effects that the training lacks, by what the localizer "
            "does about them.",
        ),
    ),
    "Localization": (
        Picture(
            f"{OWN}confusion.png",
            EVALUATED,
            "One pair of foils finds the column of a touch on a 3x3 sheet, but not its row: "
            "which pixel is taken for which.",
            "evaluated/confusion.png",
            None,
        ),
        Picture(
            f"{OWN}belief.png",
            EVALUATED,
            "Stated probabilities against the share that is right, and errors against the share "
            "of sweeps that is answered.",
            "evaluated/belief.png",
            None,
        ),
        result(
            "localizers.png",
            "python benchmarks/localization/localizers.py",
            "Accuracy of the localizers on equal tasks; yellow: without the unpressed skin as "
            "reference.",
        ),
        result(
            "fingers.png",
            "python benchmarks/localization/fingers.py",
            "Columns that any localizer can get right, against the capacitance of the finger to "
            "earth.",
        ),
        result(
            "faults.png",
            "python benchmarks/localization/faults.py",
            "What a localizer answers on skins with a fault, trained without and with them.",
        ),
    ),
    "Live answers and the page": (
        result(
            "page.gif",
            "rcskin page sheet-5x5 -o skin.html\npython benchmarks/pictures/page.py",
            "A skin to press in a browser: readings, field and probabilities follow the finger.",
        ),
        result(
            "live.svg",
            "python benchmarks/pictures/commands.py",
            "The terminal while `rcskin live` answers and column 3 is pressed.",
        ),
        result(
            "live_page.png",
            "python benchmarks/live/live_page.py",
            "The page of a live session: the answer on the skin, and its history.",
        ),
        result(
            "wiring.svg",
            "python benchmarks/pictures/wiring.py",
            "How meter, switch and skin are wired.",
        ),
    ),
    "Robots": (
        result(
            "stroke.gif",
            "python docs/examples/stroke.py -o stroke.gif",
            "A finger strokes a flat skin; right, the true place of the touch and the place read "
            "from the skin.",
        ),
        result(
            "gripper.gif",
            "python docs/examples/gripper.py -o gripper.gif",
            "Two jaws with a skin each roll a ball between them.",
        ),
        result(
            "forearm.gif",
            "python docs/examples/forearm.py -o forearm.gif",
            "An arm with a skin around it turns under a ball.",
        ),
    ),
    "Accuracy and speed": (
        result(
            "work_precision.png",
            "python benchmarks/speed/work_precision.py",
            "Time against true error of one impedance, for this solver and for others.",
        ),
        result(
            "verification_orders.png",
            "python benchmarks/accuracy/verification.py",
            "Errors fall with the mesh at the order that theory gives.",
        ),
        result(
            "reduction.png",
            "python benchmarks/speed/reduction.py",
            "Size and time of reduced models.",
        ),
    ),
}
PICTURES = tuple(picture for theme in THEMES.values() for picture in theme)
DRAWN_HERE = {each.name: each for each in PICTURES if each.file.startswith(OWN)}


def make(picture: Picture, output: Path, more: str = "") -> None:
    """Draw one picture by its lines, and make it smaller where it is too large. more: options."""
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        *first, last = picture.lines.splitlines()
        for line in (*first, f"{last} {more}"):
            app(shlex.split(line)[1:], standalone_mode=False)
        shutil.copyfile(picture.made or picture.name, output)
    if output.stat().st_size > LARGEST:
        shrink(output)


def shrink(path: Path) -> None:
    """Reduce the colours of a picture; of a film also its size and number of frames."""
    with Image.open(path) as image:
        every = max(1, round(getattr(image, "n_frames", 1) / FRAMES))
        kept = [frame.copy() for frame in ImageSequence.Iterator(image)][::every]
    pauses = [every * frame.info.get("duration", 100) for frame in kept]
    frames = [frame.convert("RGB") for frame in kept]
    if len(frames) == 1:
        frames[0].quantize(COLOURS).save(path, optimize=True)
        return
    size = WIDTH, round(WIDTH * frames[0].height / frames[0].width)
    small = [frame.resize(size, Image.Resampling.LANCZOS) for frame in frames]
    every_colour = Image.fromarray(np.concatenate([np.asarray(frame) for frame in small]))
    palette = every_colour.quantize(COLOURS)
    first, *others = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in small]
    first.save(path, save_all=True, append_images=others, duration=pauses, loop=0, optimize=True)


def page() -> str:
    """The page with all pictures, what is to be seen on them, and their lines."""
    parts = [HEAD]
    for theme, pictures in THEMES.items():
        parts.append(f"## {theme}\n")
        parts += map(_entry, pictures)
    return "\n".join(parts)


def _entry(picture: Picture) -> str:
    path = Path(os.path.relpath(HERE.parent / picture.file, PAGE.parent)).as_posix()
    shown = f"[![{picture.name}]({path})]({path})"
    return f"{shown}\n\n{picture.caption}\n\n```\n{picture.lines}\n```\n"


def main(run: Run) -> None:
    """Draw the named pictures of `results/gallery`, or all."""
    folder = run.results / "gallery"
    folder.mkdir(parents=True, exist_ok=True)
    for name in run.asked.pictures or DRAWN_HERE:
        picture = DRAWN_HERE[name]
        more = run.sized("", picture.quick)
        if more is not None:
            print(name, flush=True)
            make(picture, folder / name, more)


if __name__ == "__main__":
    launch(main, {"pictures": {"nargs": "*", "metavar": "PICTURE"}})
