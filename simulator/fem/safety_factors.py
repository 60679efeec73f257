"""Safety factors between the difference of two results and the estimated error, with their
evidence.

The error of an element solution is estimated as SAFETY * k * D. D is the difference from elements
of one order more, in Rs and in Cp (`error_estimate`, `error_history.smoothed`), and k is the ratio
of the error to D. k is 1 where the field is smooth; `error_history` estimates it where it is
singular.
"""

UNIFORM = 4.0
"""SAFETY of uniform skins, k = 1: on 226 random skins the true error was at most 3.8 D, and D in
the median."""
VARIED = 2.0
"""SAFETY of heterogeneous skins: on 230 meshes of 50 random skins the error was at most 1.2 times k
D in 99 %, and equal to it in half of them."""
SINGULAR = 2.0
"""k on top of UNIFORM for a mesh that serves all presses, for the worst singularities: a foil that
ends at an inner corner, or a sheet that conducts far better along one direction. No single press
gives an estimate of it."""
UNSEEN = 3.0
"""k of a first mesh. The largest observed was 3.7, and 2.5 at ends of foils."""
LEAST, MOST = 1.3, 4.0
"""Bounds of k. Below: smooth regions alone may have been refined. Above: k is noise where a mesh is
far too coarse. k is larger at corners where conductance jumps by a large factor."""
FORESEEN = 1.5
"""Factor on the k that corners predict for a mesh: on some 60 meshes of 20 skins k was at most 1.6
times the prediction, and 2.2 times at one place where Cp changes sign."""
TELLS = 0.1
"""Relative decrease of the difference from mesh to mesh that is needed to estimate k."""
PARITY = 0.8
"""Share of the previous difference that counts where the latest two orders agree and those before
did not gain: in a cell far wider than a layer every second order hardly changes the answer."""
MOST_BY_ORDERS = 5.0
"""Upper bound of k where lower orders give it."""
MOST_GAINED = 10.0
"""Largest gain of one order over the previous one that is accepted. In a cell far wider than a
layer every second order hardly changes the answer: there the next order alone showed a ninth of the
error."""
DEFLECTION = 5.0
"""Error of the factor under a press over the part that the highest order alone holds: 4.7 at the
point of a narrow polygon, less at right angles and where the deflection is smooth."""
SAMPLED = 4.0
"""Error of presses by depth over the largest in a sample: deep presses in a corner next to foils
were observed at 2.9 times that."""
