"""Which form of a meter's errors fits a measured meter, and what do the limits of a skin owe to it?

One table holds the spreads of |Z| that a hand meter had on one board (32 readings; Dataset-5 of the
High-Rate SHM working group, CC BY-SA 4.0; upper bounds, since the board was shocked in between)
beside the noise by each built-in meter and by a table of spreads. The other one holds limits of the
paper's sheets with each meter, alone and without errors of the session.

Run: python benchmarks/measured/meters.py [--quick]
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from rcskin.benchmarks.bench import Run, launch
from rcskin.simulator.limits import bayes_accuracy, position_bound
from rcskin.simulator.scene.meter import meter_names
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

FREQUENCY = np.array([1e5, 1e4, 1e3, 120.0, 100.0])
IMPEDANCE = np.array([0.49e6, 5.2e6, 51e6, 417e6, 517e6])
SPREAD = np.array([0.27, 0.28, 0.34, 1.3, 2.1])
"""Of |Z|, %."""
MANY = 10**9
"""Baseline sweeps that remove the errors of a session."""


def by_range(noise: float) -> dict[str, Any]:
    """Readout by the table for the 3522-50 with less noise than accuracy."""
    return {"data_sheet": {"accuracy": "3522-50-derived", "cable": 1, "noise": noise}}


METERS: dict[str, str | dict[str, Any]] = {
    "IM3523": "IM3523",
    "3522-50-derived": "3522-50-derived",
    "3522-50-derived, noise 0.3": by_range(0.3),
    "3522-50-derived, noise 0.1": by_range(0.1),
    "E4980A": "E4980A",
}


def board() -> pd.DataFrame:
    """Spreads of the hand meter, and the noise by each form, %."""
    measured = {
        "impedance": IMPEDANCE.tolist(),
        "frequency": [1e3],
        "magnitude": (SPREAD[:, None] / 100).tolist(),
        "phase": [[1e-3]] * len(SPREAD),
    }
    readouts = {name: name for name in meter_names()} | {"spread": {"spread": measured}}
    noise = {name: 100 * _noise(readout) for name, readout in readouts.items()}
    table = pd.DataFrame({"ohm": IMPEDANCE, "Hz": FREQUENCY, "measured": SPREAD, **noise})
    return table.map("{:.3g}".format)


def _noise(readout: Any) -> np.ndarray:
    scene = load_scene("sheet-5x5").with_({"readout": readout})
    return scene.readout.noise((-1j * IMPEDANCE)[None], FREQUENCY)[0, 0]


def limits(draws: int, places: int | None) -> Iterator[dict[str, str]]:
    """Limits of the paper's sheets with each meter."""
    two = load_scene("sheet-5x5-two-interfaces")
    for name, readout in METERS.items():
        for what, scene, target in (
            ("columns 5x5", load_scene("sheet-5x5"), "column"),
            ("pixels 6x6, two interfaces", two.with_({"pixels": 6}), "pixel"),
        ):
            found = [_accuracy(scene, readout, target, draws, rests) for rests in (0, MANY)]
            yield _row(what, name, *found)
        yield _row(
            "position, two interfaces, 24 mm",
            name,
            *(_position(two, readout, places, rests) for rests in (0, MANY)),
        )


def _row(what: str, meter: str, alone: str, compared: str) -> dict[str, str]:
    return {"what": what, "meter": meter, "alone": alone, "without session errors": compared}


def _accuracy(scene: Scene, readout: Any, target: str, draws: int, rests: int) -> str:
    own = scene.with_({"readout": readout})
    share, error = bayes_accuracy(own.parts, target, draws=draws, against_rest=rests)
    return f"{100 * share:.1f} ± {100 * error:.1f} %"


def _position(scene: Scene, readout: Any, places: int | None, rests: int) -> str:
    own = scene.with_({"readout": readout})
    bound = position_bound(own.parts, size=0.024, factor=2.0, against_rest=rests, max_places=places)
    return f"{1e3 * bound.median_error():.2f} mm"


def main(run: Run) -> int:
    """Publish both; 1 where a table of spreads does not give its own numbers."""
    spreads = board()
    run.publish("meter_noise", "Spreads of |Z| of a hand meter, and noise, %", spreads)
    draws, places = run.sized((2000, None), (100, 3))
    table = pd.DataFrame(limits(draws, places)).sort_values("what", kind="stable")
    run.publish("meter_limits", "Limits of the paper's sheets by meter", table)
    return int((spreads["spread"] != spreads["measured"]).any())


if __name__ == "__main__":
    launch(main)
