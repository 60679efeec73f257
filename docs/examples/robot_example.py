"""A robot with skins: a localizer trained on simulation reads where it is touched."""

import argparse
import os
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
import PIL.Image
import rcskin
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

RTOL = 1e-2
BASELINE = 0.2
"""Time for which the unpressed skins are read before the robot moves, s."""
TOUCHED = "1"
"""Answer of a localizer of positions to a sweep with one touch."""
MIN_FORCE = 0.2
"""Force from which a touch is compared, N."""
FPS = 8
HEIGHT, WIDTH, DPI = 300, 360, 100
"""Size of the film's picture of the robot, pixels, and pixels per inch of the skins beside it."""
TRAIL = 8
"""Number of sweeps whose touches are still shown."""
COLOURS = 128


@dataclass(frozen=True)
class RobotExample:
    """A robot and its motion.

    xml: model of MuJoCo, with a camera `film`. sites: of the skins. control: sets the controls of
    the engine's data at a time in s. changes: of the keys of palm.toml.
    """

    xml: str
    sites: tuple[str, ...]
    control: Callable
    changes: Mapping[str, object] = field(default_factory=dict)

    def load_scene(self):
        """Scene of the skins."""
        return rcskin.load(Path(__file__).with_name("palm.toml")).with_(self.changes)


class TouchRecord(NamedTuple):
    """Touches of one skin, one row a sweep of its meter.

    time: middle of the sweep, s. true, read: places on the skin, m, (sweep, 2), NaN where nothing
    presses, or nothing was found. force: N.
    """

    time: np.ndarray
    true: np.ndarray
    read: np.ndarray
    force: np.ndarray

    def __str__(self):
        """Number of touches and their errors in words."""
        errors = 1e3 * self.error
        if not errors.size:
            return f"{self.touched} sweeps under a touch, none found"
        middle, most = np.quantile(errors, [0.5, 0.9])
        return (
            f"{self.touched} sweeps under a touch, {errors.size} found; "
            f"median error {middle:.1f} mm, 90 % below {most:.1f} mm"
        )

    @property
    def error(self):
        """Distances of read from true places, m, for the touches that were found."""
        distance = np.linalg.norm(self.true - self.read, axis=1)
        return distance[np.isfinite(distance)]

    @property
    def touched(self):
        """Number of sweeps under a touch."""
        return np.isfinite(self.true).all(axis=1).sum()


def trained(example, sweeps):
    """Localizer of positions, trained on simulated sweeps of random skins and touches."""
    return rcskin.train(rcskin.dataset(example.load_scene(), sweeps, rtol=RTOL), "position")


def simulate(example, model, duration, film=None):
    """Touches of each skin while the robot moves, true and as read by the localizer.

    Pictures of the robot are appended to film. Raises InputError if nothing can draw them.
    """
    import mujoco

    engine = mujoco.MjModel.from_xml_string(example.xml)
    data = mujoco.MjData(engine)
    renderer = None if film is None else _renderer(mujoco, engine)
    skins = [
        rcskin.MujocoSkin(engine, example.load_scene(), site, seed=seed, rtol=RTOL, session="drawn")
        for seed, site in enumerate(example.sites, 11)
    ]
    for skin in skins:
        skin.sensor.step(None, BASELINE)
    unpressed = [skin.sensor.sweeps() for skin in skins]
    history = [[] for _ in skins]
    while data.time < duration:
        example.control(data, data.time)
        mujoco.mj_step(engine, data)
        for skin, known in zip(skins, history, strict=True):
            skin.step(data)
            known.append(_resultant(skin, data))
        if renderer and data.time >= len(film) / FPS:
            renderer.update_scene(data, "film")
            film.append(renderer.render().copy())
    if renderer:
        renderer.close()
    each = zip(skins, unpressed, history, strict=True)
    return [_record(model, skin, rest, np.array(known)) for skin, rest, known in each]


def _renderer(mujoco, engine):
    try:
        return mujoco.Renderer(engine, HEIGHT, WIDTH)
    except (AttributeError, ImportError, OSError, RuntimeError, mujoco.FatalError) as error:
        raise rcskin.InputError(
            "a film needs OpenGL: a display, libEGL, or libOSMesa with MUJOCO_GL=osmesa; "
            f"{' '.join(str(error).split())}"
        ) from None


def _resultant(skin, data):
    """Time, place and force of all contacts together: s, m, m, N."""
    contacts = skin.contacts(data)
    force = contacts.force.sum()
    place = contacts.x @ contacts.force / force if force > MIN_FORCE else np.full(2, np.nan)
    return np.array([data.time, *place, force])


def _record(model, skin, rest, known):
    sweeps = skin.sensor.sweeps().isel(sweep=slice(rest.sizes["sweep"], None))
    touched = rcskin.localize(model, sweeps, rest).labels == TOUCHED
    time = sweeps["time"].values - BASELINE
    rows = np.abs(known[:, :1] - time).argmin(axis=0)
    places, _ = model.positions(sweeps, rest)
    read = np.where(touched[:, None], 1e-3 * places[:, :2], np.nan)
    return TouchRecord(time, known[rows, 1:3], read, known[rows, 3])


def write_film(path, film, example, records):
    """Write pictures of the robot, each beside its skins at that time, as .gif."""
    size = 0.75 * HEIGHT * len(records) / DPI + 0.4, HEIGHT / DPI
    figure = Figure(size, dpi=DPI, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(records), squeeze=False)[0]
    sides = 1e3 * np.array(example.load_scene().skin.sides)
    frames = []
    for k, picture in enumerate(film):
        for each, touches, site in zip(axes, records, example.sites, strict=True):
            each.clear()
            _draw_skin(each, sides, touches, k / FPS, site)
        canvas.draw()
        frames.append(np.hstack([picture, np.asarray(canvas.buffer_rgba())[..., :3]]))
    palette = PIL.Image.fromarray(np.vstack(frames[:: max(len(frames) // 6, 1)])).quantize(COLOURS)
    first, *others = (
        PIL.Image.fromarray(each).quantize(palette=palette, dither=PIL.Image.Dither.NONE)
        for each in frames
    )
    first.save(path, save_all=True, append_images=others, duration=1000 // FPS, loop=0)


def _draw_skin(axes, sides, touches, time, site):
    now = int(np.searchsorted(touches.time, time))
    shown = slice(max(now - TRAIL, 0), now)
    true, read = 1e3 * touches.true[shown], 1e3 * touches.read[shown]
    axes.set(xlim=(0, sides[0]), ylim=(0, sides[1]), aspect="equal", title=site)
    axes.set(xlabel="x, mm", ylabel="y, mm")
    axes.plot(*true.T, "o", color="black", mfc="none", ms=13, alpha=0.25)
    axes.plot(*read.T, "o", color="tab:red", ms=4, alpha=0.25)
    axes.plot(*true[-1:].T, "o", color="black", mfc="none", ms=13, label="true")
    axes.plot(*read[-1:].T, "o", color="tab:red", ms=6, label="read")
    axes.legend(loc="upper right", fontsize=7, framealpha=0.6)


def main(example, arguments=None):
    """Train a localizer, move the robot, print errors, and write a film."""
    parser = argparse.ArgumentParser()
    parser.add_argument("-o", "--output", type=Path, help="film: .gif")
    parser.add_argument("--sweeps", type=int, default=1500, help="sweeps for training")
    parser.add_argument("--duration", type=float, default=4.0, help="s")
    options = parser.parse_args(arguments)
    if options.output and options.output.suffix != ".gif":
        parser.error(f"{options.output}: a film must be .gif")
    if options.output and options.output.exists():
        parser.error(f"{options.output}: already exists")
    if options.output and sys.platform == "linux" and "DISPLAY" not in os.environ:
        os.environ.setdefault("MUJOCO_GL", "egl")  # read when mujoco is imported
    film = [] if options.output else None
    try:
        records = simulate(example, trained(example, options.sweeps), options.duration, film)
    except rcskin.InputError as error:
        parser.error(str(error))
    for site, touches in zip(example.sites, records, strict=True):
        print(f"{site}: {touches}")
    if film:
        write_film(options.output, film, example, records)
