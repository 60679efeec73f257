"""Safety factors between the difference of two results and the estimated error, with their
evidence.

The error of an element solution is estimated as SAFETY * k * D. D is the difference from elements
of one order more, in Rs and in Cp (`error_estimate`, `error_history.smoothed`), and k is the ratio
of the error to D. k is 1 where the field is smooth; `error_history` estimates it where it is
singular.
"""

UNIFORM = 4.0
"""SAFETY of uniform skins, where k = 1. On 226 random skins the largest true error was 3.8 D, and
the median was D."""
VARIED = 2.0
"""SAFETY of heterogeneous skins. On 230 meshes of 50 random skins 99 % of the errors were at most
1.2 k D, and the median was k D."""
SINGULAR = 2.0
"""k of a mesh that serves all presses of a uniform skin; it multiplies UNIFORM. It covers the worst
singularities: a foil that ends at an inner corner, and a sheet that conducts far better along one
direction. A single press cannot estimate it."""
FIRST_MESH = 3.0
"""k of a first mesh, which cannot estimate it. The largest observed k was 3.7, and 2.5 at ends of
foils."""
MIN_FACTOR, MAX_FACTOR = 1.3, 4.0
"""Bounds of an estimated k. A smaller estimate may come from refining smooth regions alone. A
larger one is noise of a mesh that is far too coarse. The upper bound is raised at corners where
conductance jumps by a large factor: k is larger there."""
PREDICTED = 1.5
"""Factor on the k that the corners of a mesh predict. On about 60 meshes of 20 skins k was at most
1.6 times the prediction, except at one place where Cp changes sign: 2.2 times."""
MIN_DECREASE = 0.1
"""Relative decrease of the difference from mesh to mesh that is needed to estimate k."""
PARITY = 0.8
"""Largest share of the previous difference that is taken as the error. This covers cells far wider
than a boundary layer: every second order hardly changes the answer there, so the latest two orders
may agree by chance."""
MAX_FACTOR_BY_ORDERS = 5.0
"""Upper bound of k where lower orders give it."""
MAX_ORDER_GAIN = 10.0
"""Largest accepted gain of one order over the previous one. In a cell far wider than a boundary
layer every second order hardly changes the answer: the difference from the next order alone was a
ninth of the error there."""
DEFLECTION = 5.0
"""Error of the factor under a press over the contribution of the highest order alone. It was 4.7 at
the tip of a narrow polygon, and less at right angles and where the deflection is smooth."""
SAMPLED = 4.0
"""Largest error of all presses by depth over the largest error in a sample of them. Deep presses in
a corner next to foils had 2.9 times the largest error of the sample."""
