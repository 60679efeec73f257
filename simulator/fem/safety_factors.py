"""From what results differ by to how far one is off: every factor, and what it was seen on.

An error of elements is estimated as SAFETY * k * D: D is the difference from elements of one order
more, in Rs and in Cp (`estimate`, `effect.evened`), and k how much more than it the error is. Where
the field is smooth k is 1; `effect` tells it where it is singular.
"""

UNIFORM = 4.0
"""SAFETY of uniform skins, k = 1: on 226 random skins the true error was at most 3.8 D, and D in
the median."""
VARIED = 2.0
"""SAFETY of heterogeneous skins: of 230 meshes of 50 random skins the error was at most 1.2 times
k D in 99 %, in half equal to it."""
SINGULAR = 2.0
"""k beside UNIFORM of a mesh that serves all presses, at the worst of singularities: where a foil
ends at an inner corner, or in a sheet that conducts far better along one direction. None of those
presses tells how much."""
UNSEEN = 3.0
"""k of a first mesh. At worst 3.7 was seen, 2.5 at ends of foils."""
LEAST, MOST = 1.3, 4.0
"""Of k: what is smooth may have been refined alone; where a mesh is far too coarse k is noise. It
is larger at corners where conductance jumps far."""
FORESEEN = 1.5
"""Times k that corners tell of a mesh in advance: of some 60 meshes of 20 skins k was at most 1.6
times that, and 2.2 times at one place where Cp changes sign."""
TELLS = 0.1
"""Of a difference: by how much it has to fall from mesh to mesh for k to be told."""
PARITY = 0.8
"""Of the difference before, where the latest two orders agree and those before did not gain: in a
cell far wider than a layer every second order hardly changes the answer."""
MOST_BY_ORDERS = 5.0
"""Of k, where orders below tell it."""
MOST_GAINED = 10.0
"""What an order is believed to gain on the one before it, at most. In a cell far wider than a layer
every second order hardly changes the answer: there the next one alone told a ninth of the error."""
DEFLECTION = 5.0
"""Error of the factor under a press over what the highest order alone holds of it: 4.7 at the point
of a narrow polygon, less at right angles and where all is smooth."""
SAMPLED = 4.0
"""What presses by depth may be off by, over the largest of a sample: deep ones in a corner beside
foils were seen at 2.9 times that."""
