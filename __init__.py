"""Simulator of a capacitive soft sensor skin, its localizer, and the driver of its meter.

    import rcskin

    scene = rcskin.load("sheet-5x5").with_({"skin.top.sheet_resistance": 35e3})
    sweeps = rcskin.sweep(scene, ["2,3", "none"], rtol=1e-6)
    rcskin.plot(sweeps, "sweeps.png")

    recorded = rcskin.measured(sweeps, seed=1)  # with the meter's noise
    skins = rcskin.dataset(scene, 2000)
    model = rcskin.train(skins)    # or rcskin.load_model("columns.npz")
    rcskin.evaluate(model, recorded).accuracy
    rcskin.localize(model, recorded).labels

    sensor = rcskin.Sensor(scene)
    sensor.step("2,3", dt=0.1).Cp  # F, shape (skin, interface, frequency)

The names in `__all__`, and `SkinModule` and `SweepStream` of the extra `torch`, are public; all
modules of the package are internal and may change. Nothing is imported before it is used.
"""
# pyright: standard

from __future__ import annotations

from typing import TYPE_CHECKING

from .localization.api import features, load_model, write
from .localization.commands.evaluate import evaluate
from .localization.commands.gap import gap
from .localization.commands.localize import localize
from .localization.commands.train import train
from .localization.study.command import study
from .simulator.calibration.command import calibrate
from .simulator.check.command import plot
from .simulator.dataset.command import dataset
from .simulator.limits.command import limits
from .simulator.simulation import load, measured, read, reduce, sweep

if TYPE_CHECKING:
    __version__: str
    from .localization.model.localizer_model import Model
    from .localization.sweep_stream import SweepStream as SweepStream
    from .simulator.differentiable.skin_module import SkinModule as SkinModule
    from .simulator.press.press import Press
    from .simulator.robots.mujoco_skin import MujocoSkin as MujocoSkin
    from .simulator.scene.scene import Scene
    from .simulator.sensor.contacts.contact_types import DepthImage, PointContacts, PressureImage
    from .simulator.sensor.sensor import Sensor
    from .simulator.sweeps.errors import InputError, ToleranceError

__all__ = [
    "DepthImage",
    "InputError",
    "Model",
    "PointContacts",
    "Press",
    "PressureImage",
    "Scene",
    "Sensor",
    "ToleranceError",
    "__version__",
    "calibrate",
    "dataset",
    "evaluate",
    "features",
    "gap",
    "limits",
    "load",
    "load_model",
    "localize",
    "measured",
    "plot",
    "read",
    "reduce",
    "study",
    "sweep",
    "train",
    "write",
]

_CLASSES = {
    "DepthImage": "simulator.sensor.contacts.contact_types",
    "InputError": "simulator.sweeps.errors",
    "Model": "localization.model.localizer_model",
    "PointContacts": "simulator.sensor.contacts.contact_types",
    "Press": "simulator.press.press",
    "PressureImage": "simulator.sensor.contacts.contact_types",
    "Scene": "simulator.scene.scene",
    "Sensor": "simulator.sensor.sensor",
    "ToleranceError": "simulator.sweeps.errors",
}
"""The module of each class, which is imported when the class is asked for."""

_OF_EXTRAS = {
    "MujocoSkin": ("mujoco", "simulator.robots.mujoco_skin"),
    "SkinModule": ("torch", "simulator.differentiable.skin_module"),
    "SweepStream": ("torch", "localization.sweep_stream"),
}
"""The extra and the module of each class that needs one. The extra has the name of its library.
These names are public, but not in `__all__`, as `from rcskin import *` needs no extra."""


def __dir__() -> list[str]:
    return __all__


if not TYPE_CHECKING:  # a checker of types would take any name for one of the package

    def __getattr__(name: str) -> object:
        """A class or the version, looked up where it is asked for."""
        from importlib import import_module
        from importlib.metadata import version

        if name == "__version__":
            return version("rcskin")
        if name in _CLASSES:
            return getattr(import_module(f".{_CLASSES[name]}", __name__), name)
        if name in _OF_EXTRAS:
            from .simulator.sweeps.optional_packages import require_packages

            extra, module = _OF_EXTRAS[name]
            require_packages(f"rcskin.{name}", extra, extra)
            return getattr(import_module(f".{module}", __name__), name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
