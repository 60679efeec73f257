"""Faults put into central lines, one at a time, each of which must move an answer that is kept.

Run: python tests/reference/mutations.py; it ends with 1 if one moves nothing.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
MUTATIONS = [  # file, the line's text, the fault
    ("simulator/fem/galerkin.py", "self.inner] + deviation", "self.inner] - deviation"),
    ("simulator/models/line.py", "(Y + s * C * T)", "(Y + s * C / T)"),
    ("simulator/models/line.py", "(1 + Y * R * T)", "(1 - Y * R * T)"),
    ("simulator/models/line.py", "tanh_ratio(s * R * C)", "tanh_ratio(2 * s * R * C)"),
    ("simulator/surroundings/rim.py", "bottom / (top + bottom)", "bottom / top"),
    ("simulator/surroundings/rim.py", "-C[0, 1] - foam", "-C[0, 1] + foam"),
    ("simulator/surroundings/rim.py", "C[:, 0].sum() - bottom", "C[:, 0].sum()"),
    ("simulator/surroundings/charges.py", "+ (permittivity - 1)", "+ (permittivity + 1)"),
    ("simulator/surroundings/panels.py", "(a + c + d) / 3", "(a + c + d) / 4"),
    ("simulator/sweeps/reading_quantities.py", "magnitude / omega", "magnitude / (1.01 * omega)"),
    ("simulator/scene/frequency.py", "(loss.tangent + 1j)", "(1.1 * loss.tangent + 1j)"),
    ("simulator/scene/foam_mechanics.py", "- strain) / (1 - strain)", "- strain)"),
    ("simulator/models/mechanics/indentation.py", "by.value / own", "by.value"),
    (
        "simulator/models/mechanics/membrane.py",
        "stress(self._strain(w)) * ",
        "stress(self._strain(w)) + 0 * ",
    ),
    ("simulator/scene/meter.py", "(1 - self.guard) *", "(1 + self.guard) * 2 *"),
    ("localization/inputs/features.py", "np.log(complex_readings", "np.sqrt(complex_readings"),
    ("localization/inputs/features.py", "2 * known.sum() <=", "2 * known.sum() >"),
    (
        "localization/parts/normal_densities.py",
        "(distance + spread) / 2",
        "(distance - spread) / 2",
    ),
    ("simulator/calibration/problem.py", "vstack([slopes", "vstack([2 * slopes"),
    ("simulator/models/cosine_modes.py", "np.array([1.0,", "np.array([1.1,"),
]


def main() -> int:
    """Try every fault in a copy of the code; 1 if one goes unseen."""
    unseen = 0
    with TemporaryDirectory() as folder:
        copy = Path(folder) / "rcskin"
        left_out = shutil.ignore_patterns(".*", "__pycache__")
        shutil.copytree(ROOT, copy, ignore=left_out)
        if _moves(copy):
            raise SystemExit("the answers are not those that are kept: no fault can be judged")
        for file, line, fault in MUTATIONS:
            path = copy / file
            text = path.read_text(encoding="utf-8")
            if text.count(line) < 1:
                raise SystemExit(f"{file}: no line has {line!r}")
            path.write_text(text.replace(line, fault, 1), encoding="utf-8")
            caught = _moves(copy)
            path.write_text(text, encoding="utf-8")
            unseen += not caught
            print(
                f"{'caught' if caught else 'NOT SEEN'}: {file}: {line!r} -> {fault!r}", flush=True
            )
    return int(unseen > 0)


def _moves(copy: Path) -> bool:
    """True if the answers of a copy are not those that are kept, or there are none."""
    command = [sys.executable, "-W", "ignore", "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    environment = os.environ | {"PYTHONPATH": str(copy.parent)}
    done = subprocess.run(
        [*command, "tests/reference"], cwd=copy, env=environment, capture_output=True, check=False
    )
    return done.returncode == 1


if __name__ == "__main__":
    raise SystemExit(main())
