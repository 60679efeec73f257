"""Film of a robot beside its unrolled skins, with true and read touches."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...simulator.sweeps import InputError
from ...simulator.view.movie import FPS, write_movie
from ...simulator.view.painting import has_display

if TYPE_CHECKING:
    from ...simulator.scene.scene import Scene
    from .robot_example import TouchRecord

Picture = NDArray[np.uint8]
HEIGHT, WIDTH = 300, 360
"""Size of the picture of the robot, pixels."""
TRAIL = 8
"""Number of sweeps whose touches are still shown."""
DPI = 100


class FilmCamera:
    """Camera that takes pictures of a model at the rate of films.

    Without a display MuJoCo needs MUJOCO_GL when it is imported; it is set here.
    """

    def __init__(self) -> None:
        if not has_display():
            os.environ.setdefault("MUJOCO_GL", "egl")
        self.pictures: list[Picture] = []
        self.times: list[float] = []
        self._renderer: Any = None

    def take(self, model: Any, data: Any, camera: str) -> None:
        """Take a picture if it is time for one. Raises InputError if nothing can draw."""
        if data.time < len(self.pictures) / FPS:
            return
        if self._renderer is None:
            self._renderer = _renderer(model)
        self._renderer.update_scene(data, camera)
        self.pictures.append(self._renderer.render().copy())
        self.times.append(data.time)

    def close(self) -> None:
        """Free the graphics."""
        if self._renderer is not None:
            self._renderer.close()


def _renderer(model: Any) -> Any:
    import mujoco

    engine: Any = mujoco
    try:
        return engine.Renderer(model, HEIGHT, WIDTH)
    except (AttributeError, ImportError, OSError, RuntimeError, engine.FatalError) as error:
        raise InputError(
            "a film of MuJoCo needs OpenGL: a display, libEGL, or libOSMesa with "
            f"MUJOCO_GL=osmesa; {' '.join(str(error).split())}"
        ) from None


def write_film(
    path: Path,
    camera: FilmCamera,
    scene: Scene,
    records: Sequence[TouchRecord],
    names: Sequence[str],
) -> None:
    """Write the pictures of a camera, each beside the skins at its time, as .gif or .mp4."""
    if path.suffix not in (".gif", ".mp4"):
        raise InputError(f"{path}: a film must be .gif or .mp4")
    write_movie(path, _frames(camera, scene, records, names), ())


def _frames(
    camera: FilmCamera, scene: Scene, records: Sequence[TouchRecord], names: Sequence[str]
) -> Iterator[Picture]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    size = 0.75 * HEIGHT * len(records) / DPI + 0.4, HEIGHT / DPI
    figure = Figure(size, dpi=DPI, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(records), squeeze=False)[0]
    for time, picture in zip(camera.times, camera.pictures, strict=True):
        for each, touches, name in zip(axes, records, names, strict=True):
            each.clear()
            _draw_skin(each, scene, touches, time, name)
        canvas.draw()
        skins = np.asarray(canvas.buffer_rgba())[..., :3]
        yield np.ascontiguousarray(np.hstack([picture, skins]))


def _draw_skin(axes: Any, scene: Scene, touches: TouchRecord, time: float, name: str) -> None:
    now = int(np.searchsorted(touches.time, time))
    shown = slice(max(now - TRAIL, 0), now)
    true, read = 1e3 * touches.true[shown], 1e3 * touches.read[shown]
    length, width = (1e3 * side for side in scene.skin.sides)
    axes.set(xlim=(0, length), ylim=(0, width), aspect="equal", title=name)
    axes.set(xlabel="x, mm", ylabel="y, mm")
    axes.plot(*true.T, "o", color="black", mfc="none", ms=13, alpha=0.25)
    axes.plot(*read.T, "o", color="tab:red", ms=4, alpha=0.25)
    axes.plot(*true[-1:].T, "o", color="black", mfc="none", ms=13, label="true")
    axes.plot(*read[-1:].T, "o", color="tab:red", ms=6, label="read")
    if not now:
        axes.plot([], [])
    axes.legend(loc="upper right", fontsize=7, framealpha=0.6)
