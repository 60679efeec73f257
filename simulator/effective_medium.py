"""Relative permittivity of air in a solid, by the laws of effective media.

Each law takes the porosity, the part of the volume that is air, 0..1 of any shape, and the relative
permittivity of the solid, >= 1. All rise from the solid's at porosity 0 down to 1 at porosity 1.
A. Sihvola, Electromagnetic Mixing Formulas and Applications, IEE 1999, chapters 3 and 9.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Law = Callable[[NDArray[np.float64], float], NDArray[np.float64]]


def looyenga(porosity: NDArray[np.float64], solid: float) -> NDArray[np.float64]:
    """eps^(1/3) mixes by volume: H. Looyenga, Physica 31 (1965) 401."""
    return ((1 - porosity) * np.cbrt(solid) + porosity) ** 3


def bruggeman(porosity: NDArray[np.float64], solid: float) -> NDArray[np.float64]:
    """Spheres of both in the mixture itself, (1-p)(s-e)/(s+2e) + p(1-e)/(1+2e) = 0: D. A. G.
    Bruggeman, Annalen der Physik 416 (1935) 636."""
    half = (2 - 3 * porosity) * solid + 3 * porosity - 1
    return (half + np.sqrt(half**2 + 8 * solid)) / 4


def lichtenecker(porosity: NDArray[np.float64], solid: float) -> NDArray[np.float64]:
    """ln eps mixes by volume: K. Lichtenecker, Physikalische Zeitschrift 27 (1926) 115."""
    return solid ** (1 - porosity)


def maxwell_garnett(porosity: NDArray[np.float64], solid: float) -> NDArray[np.float64]:
    """Closed round cells of air in the solid, the upper bound of Hashin and Shtrikman: J. C.
    Maxwell Garnett, Philosophical Transactions A 203 (1904) 385."""
    rise = 2 * solid + 1
    return solid * (rise + 2 * porosity * (1 - solid)) / (rise - porosity * (1 - solid))


LAWS: dict[str, Law] = {
    "looyenga": looyenga,
    "bruggeman": bruggeman,
    "lichtenecker": lichtenecker,
    "maxwell-garnett": maxwell_garnett,
}
