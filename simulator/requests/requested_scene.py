"""The scene that a command is asked for, with what its user should know of it."""

from __future__ import annotations

from ..models.plain import electrical
from ..models.validity import earth_left_out, warnings
from ..scene.scene import Scene
from ..scene.scene_files import load_scene
from .console import note, warn
from .plausibility import suspicious_values


def requested_scene(name: str) -> Scene:
    """The scene of that name or path; tells of slips. Raises InputError as `load_scene`."""
    scene = load_scene(name)
    for slip in suspicious_values(scene):
        warn(f"{name}: {slip}")
    return scene


def warn_of_model(name: str, scene: Scene) -> None:
    """Tells where foils join what the scene has apart, and where thin sheets are no model of it."""
    even = electrical(scene)
    for warning in (*scene.driven_by_touch, *warnings(even)):
        warn(f"{name}: {warning}")


def warn_of_earth(name: str, scene: Scene) -> None:
    """Tells what earth may do to a measured skin, where its scene says nothing of surroundings."""
    told = earth_left_out(electrical(scene))
    if told is not None:
        warn(f"{name}: {told}")


def note_if_noise_free(name: str, scene: Scene) -> None:
    """A note where the meter of a scene reads without error."""
    if scene.readout.exact:
        note(
            f"{name}: the readout is free of noise: [readout] gives none "
            '(readout = "IM3523", above the first table, would be that of such a meter)'
        )
