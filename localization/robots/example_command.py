"""Command line of the examples of robots."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...simulator.sweeps import InputError, checked_output, require_packages
from ...simulator.sweeps.writing import WriteContext, in_write_context
from .robot_example import SWEEPS, RobotExample, TouchRecord, simulate, trained
from .touch_film import FilmCamera, write_film


def run(example: RobotExample, arguments: Sequence[str] | None = None) -> int:
    """Train a localizer, move the robot, print errors, and write a film; the exit code."""
    parser = argparse.ArgumentParser(prog=f"python -m rcskin.localization.robots.{example.name}")
    parser.add_argument("-o", "--output", type=Path, help="film: .gif or .mp4")
    parser.add_argument("--overwrite", action="store_true", help="replace a film that exists")
    parser.add_argument("--sweeps", type=int, default=SWEEPS, help="sweeps for training")
    parser.add_argument("--duration", type=float, default=example.duration, help="s")
    options = parser.parse_args(arguments)
    try:
        require_packages(f"the example {example.name}", "mujoco", "mujoco", "gymnasium")
        with in_write_context(WriteContext(options.overwrite)):
            _run(example, options.output, options.sweeps, options.duration)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def _run(example: RobotExample, output: Path | None, sweeps: int, duration: float) -> None:
    camera = FilmCamera() if output and checked_output(output, (".gif", ".mp4")) else None
    records = simulate(example, trained(example, sweeps), duration, camera)
    for site, touches in zip(example.sites, records, strict=True):
        print(summary(site, touches))
    if output and camera:
        write_film(output, camera, example.load_scene(), records, example.sites)
        camera.close()


def summary(site: str, touches: TouchRecord) -> str:
    """Number of touches and their errors in words."""
    errors = 1e3 * touches.error
    if not errors.size:
        return f"{site}: {touches.touched} sweeps under a touch, none found"
    middle, most = np.quantile(errors, [0.5, 0.9])
    return (
        f"{site}: {touches.touched} sweeps under a touch, {errors.size} found; median error "
        f"{middle:.1f} mm, 90 % below {most:.1f} mm"
    )
