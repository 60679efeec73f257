"""Types of arrays by what they contain: real and complex numbers, integers, or a mask."""

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Integer = NDArray[np.int64]
Mask = NDArray[np.bool_]
