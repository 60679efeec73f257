"""Loads the scene that a command requests, with warnings and notes for the user."""

from __future__ import annotations

from ..models.validity import earth_left_out, warnings
from ..scene.parts import Meter, Setup, Skin
from ..scene.scene import Scene
from ..scene.scene_files import load_scene
from .console import note, warn
from .plausibility import suspicious_values

INTENDED = "plausible = false, above the first table, states that unusual numbers are intended"
"""Note below warnings of unusual numbers."""


def requested_scene(name: str) -> Scene:
    """The scene of that name or path; warns of implausible values. Raises as `load_scene`."""
    scene = load_scene(name)
    slips = suspicious_values(scene)
    for slip in slips:
        warn(f"{name}: {slip}")
    if slips:
        note(f"{name}: {INTENDED}")
    return scene


def warn_of_model(name: str, scene: Scene) -> None:
    """Warns where touching foils connect terminals, and where thin sheets are no valid model."""
    for warning in (
        *scene.parts.driven_by_touch,
        *warnings(scene.parts.skin.electrical, scene.parts.setup, scene.press),
    ):
        warn(f"{name}: {warning}")


def warn_of_earth(name: str, skin: Skin) -> None:
    """Warns of the effect of earth if the scene of a measured skin has no [surroundings]."""
    warning = earth_left_out(skin.electrical)
    if warning is not None:
        warn(f"{name}: {warning}")


def note_if_noise_free(name: str, setup: Setup, meter: Meter) -> None:
    """Prints a note if the meter of a scene reads without error."""
    if text := noise_free(setup, meter):
        note(f"{name}: {text}")


def noise_free(setup: Setup, meter: Meter) -> str:
    """Text that says so if the meter of a scene reads without error, else empty."""
    if not meter.readout.exact:
        return ""
    given = (
        "[readout.converter] sets noise in volts or bits"
        if setup.gain
        else 'readout = "IM3523", above the first table, sets those of such a meter'
    )
    return f"the readout is free of noise because [readout] sets no errors; {given}"
