"""Mounted skins: time of a reading of one skin and of many, in a step with contacts.

A step takes as long as a reading of the meter. Its contact is another one each time, or stays.
Readings without noise are compared with the full model first. Rows of MuJoCo are of a strip under a
finger, for a step of the engine: the engine's own time, and that with the skin. Times are of the
processor, the shortest of many runs, because other programs change the clock on the wall more.

Run: OMP_NUM_THREADS=1 python benchmarks/speed/sensor.py [--quick]
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from itertools import cycle, repeat
from typing import Any

import numpy as np
import rcskin
from rcskin.benchmarks.bench import Run, launch

STEPS, RUNS = 20, 40
STRIP, SETTLED = "strip-1x4", 500
STRIP_CHANGES = {
    "skin.foam": {
        "thickness": 4e-3,
        "mechanics": {
            "porosity": 0.67,
            "solid_permittivity": 2.79,
            "modulus": 100e3,
            "plateau_stress": 20e3,
        },
    },
}
READING = 0.005
"""Duration of a reading at the frequencies of these scenes, s."""


def touches(scene: rcskin.Scene, skins: int, count: int) -> list[rcskin.PointContacts]:
    """Random touches of a fingertip, one on each skin."""
    random, (length, width) = np.random.default_rng(1), scene.skin.sides
    shape = (skins, 1)
    return [
        rcskin.PointContacts(
            x=length * random.uniform(0.1, 0.9, shape),
            y=width * random.uniform(0.25, 0.75, shape),
            factor=random.uniform(1.2, 3.0, shape),
            radius=np.full(shape, 0.004),
        )
        for _ in range(count)
    ]


def checked(name: str, rtol: float) -> float:
    """Largest relative error of Rs and Cp of some touches; raises AssertionError beyond rtol."""
    sensor = rcskin.Sensor(name, noise=False, rtol=rtol)
    worst, random = 0.0, np.random.default_rng(2)
    length, width = sensor.scene.skin.sides
    for _ in range(6):
        x, y = length * random.uniform(0.1, 0.9), width * random.uniform(0.3, 0.7)
        press = f"disc({x:.6f},{y:.6f},0.004):{random.uniform(1.2, 3.0):.3f}"
        reading, exact = sensor.step(press, 1.0), rcskin.sweep(name, [press], rtol=0.05 * rtol)
        for quantity in ("Rs", "Cp"):
            off = np.abs(getattr(reading, quantity)[0] / exact[quantity].values[0] - 1)
            worst = max(worst, float(off.max()))
    if worst > rtol:
        raise AssertionError(f"{name}: asked {rtol:g}, off by {worst:.1e}")
    return worst


def processor_time(work: Callable[[], object], runs: int) -> float:
    """Shortest time of the processor of some runs, s, after one that is not counted."""
    work()
    times = []
    for _ in range(runs):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def of_steps(sensor: rcskin.Sensor, contacts: Iterator[object], runs: int) -> float:
    """Time of a step, s."""

    def steps() -> None:
        for _ in range(STEPS):
            sensor.step(next(contacts), READING)

    return processor_time(steps, runs) / STEPS


def measured(name: str, skins: int, rtol: float, runs: int) -> list[dict[str, object]]:
    """Rows of one scene and number of skins: microseconds for a skin and reading."""
    session = "nominal" if skins == 1 else "drawn"
    sensor = rcskin.Sensor(name, skins=skins, session=session, rtol=rtol)
    every = touches(sensor.scene, skins, 50)
    changing = of_steps(sensor, cycle(every), runs)
    constant = of_steps(sensor, repeat(every[0]), runs)
    reader, mounted, given = sensor._press, sensor._mounted, sensor._press(every[0])
    contacts = processor_time(lambda: [reader(each) for each in every], runs) / len(every)
    physics = processor_time(lambda: [mounted.readings(given.batch, 0) for _ in range(STEPS)], runs)
    shared = {"scene": name, "skins": skins}
    parts = {
        "contact stays": constant,
        "new contact at each reading": changing,
        "of it: contact to cells": contacts,
        "of it: physics, all frequencies": physics / STEPS,
    }
    return [
        shared | {"what": what, "us a skin and reading": f"{1e6 * spent / skins:.3g}"}
        for what, spent in parts.items()
    ]


def mounted_strip() -> tuple[rcskin.MujocoSkin, Any]:
    """A strip that a multisine reads, on an arm under a finger, and the engine's data."""
    import mujoco

    scene = rcskin.load(STRIP).with_(STRIP_CHANGES)
    length, width = scene.skin.sides
    engine: Any = mujoco
    model = engine.MjModel.from_xml_string(
        f"""<mujoco><worldbody><body name="arm">
        <geom type="box" size="{length / 2} {width / 2} .005" pos="0 0 -.005"/><site name="skin"/>
        </body><body name="finger" pos="0 0 .012">
        <joint name="down" type="slide" axis="0 0 -1" damping="1"/>
        <geom type="capsule" euler="90 0 0" size=".008 .004" mass=".05"/></body></worldbody>
        <actuator><motor joint="down"/></actuator></mujoco>"""
    )
    return rcskin.MujocoSkin(model, scene, "skin"), engine.MjData(model)


def of_engine(runs: int) -> list[dict[str, object]]:
    """Rows of a skin on MuJoCo: microseconds for a step of the engine with and without the skin."""
    import mujoco

    skin, data = mounted_strip()
    rows: list[dict[str, object]] = []
    engine: Any = mujoco
    for what, push in (("untouched", -0.5), ("pressed", 1.5)):
        data.ctrl = push
        for _ in range(SETTLED):
            engine.mj_step(skin.model, data)
            skin.step(data)
        touches = skin.contacts(data).count
        if touches != (push > 0):
            raise AssertionError(f"{touches} contacts of a strip that is {what}")

        def alone() -> None:
            for _ in range(STEPS):
                engine.mj_step(skin.model, data)

        def mounted() -> None:
            for _ in range(STEPS):
                engine.mj_step(skin.model, data)
                skin.step(data)

        for part, work in (
            ("a step of MuJoCo", alone),
            ("a step of MuJoCo with the skin", mounted),
        ):
            spent = 1e6 * processor_time(work, runs) / STEPS
            given = {"scene": f"{STRIP}, {what}", "skins": 1, "what": part}
            rows.append(given | {"us a skin and reading": f"{spent:.3g}"})
    return rows


def main(run: Run) -> None:
    """Check, measure, print, write the table."""
    rtol, runs = 1e-3, run.sized(RUNS, 2)
    rows = []
    for name in run.sized(("strip-1x4", "sheet-5x5"), ("strip-1x4",)):
        worst = checked(name, rtol)
        print(f"{name}: largest error {worst:.1e}, tolerance {rtol:g}")
        for skins in run.sized((1, 200), (1, 5)):
            rows += measured(name, skins, rtol, runs)
    if find_spec("mujoco"):
        rows += of_engine(runs)
    title = "Mounted skins: processor time of a reading"
    run.publish("sensor", title, rows)


if __name__ == "__main__":
    launch(main)
