"""Scenes by the name of their kind, coarse in pixels and frequencies, to be cheap."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import meshio
import numpy as np
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

LEFT_PAIR = {"top-left": {}, "bottom-left": {}}


def build_scene(
    contacts=LEFT_PAIR,
    interfaces=None,
    *,
    length=0.10,
    width=0.08,
    top=50e3,
    bottom=30e3,
    c=5e-9,
    loss_tangent=0.0,
    rows=1,
    columns=1,
    frequencies=(1e3, 1e4, 1e5),
    factor=2.0,
):
    """A scene in SI units.

    contacts: further keys by name, ELECTRODE-EDGE with an optional -SUFFIX. interfaces: (high, low)
    by name, either one contact's name or several; by default the first contact and the second.
    """
    return Scene.model_validate(
        {
            "name": "scene",
            "skin": {
                "length": length,
                "width": width,
                "top": {"sheet_resistance": top},
                "bottom": {"sheet_resistance": bottom},
                "foam": {"capacitance_per_area": c, "loss_tangent": loss_tangent},
            },
            "contact": [_contact(name, more) for name, more in contacts.items()],
            "interface": [
                {"name": name, "high": _listed(high), "low": _listed(low)}
                for name, (high, low) in (interfaces or {"meter": list(contacts)[:2]}).items()
            ],
            "pixels": {"rows": rows, "columns": columns},
            "press": {"capacitance_factor": factor},
            "sweep": {"frequencies": list(frequencies)},
        }
    )


def _contact(name, more):
    electrode, edge = name.split("-")[:2]
    return {"name": name, "electrode": electrode, "edge": edge, **more}


def _listed(names):
    return [names] if isinstance(names, str) else list(names)


SIDE, HALF = 0.12, 0.06
HEXAGON = [[0.03, 0], [0.09, 0], [SIDE, HALF], [0.09, SIDE], [0.03, SIDE], [0, HALF]]
L = [[0, 0], [SIDE, 0], [SIDE, HALF], [HALF, HALF], [HALF, SIDE], [0, SIDE]]
READOUT = dict.fromkeys(("magnitude_noise", "phase_noise"), 1e-3)
THICK = {
    "skin.foam.capacitance_per_area": None,
    "skin.foam.thickness": 4e-3,
    "skin.foam.relative_permittivity": 2.2,
}
COVER = {"thickness": 1e-3, "relative_permittivity": 1.0}
EARTH = {
    "low": "virtual earth",
    "body": {"distance": 5e-3},
    "cover": COVER,
    "rim": {"mutual": 5e-12, "top": 11e-12, "bottom": 6e-12},
    "thickness": True,
}
WALLED = {"body": {"distance": 5e-3}, "cover": COVER, "thickness": True, "edges": True}
FLOATING_BODY = {
    "low": "floating",
    "body": {"distance": 5e-3, "potential": "floating"},
    "cover": {"thickness": 1e-3, "relative_permittivity": 3.0},
    "rim": {"mutual": 5e-12, "top": 6e-12, "bottom": 4e-12},
}
"""Two potentials that float in common: the body's, and that of all against earth."""

ALIKE = {
    "readout": {"display_digits": 12},
    "dataset.session": {
        "sweeps_per_session": 20,
        **dict.fromkeys(
            ("sheet_resistance", "sheet_mismatch", "capacitance", "contact_resistance"), 1.0
        ),
        **dict.fromkeys(
            ("unevenness", "foam_spread", "loss_tangent", "stray_capacitance", "lead_resistance"),
            0.0,
        ),
    },
}
"""Keys of data sets whose skins are all the scene's own, read without errors."""


def uneven(seed):
    return {"map": {"kind": "random", "deviation": 0.2, "correlation_length": 0.06, "seed": seed}}


def skin_of(name, skin, edges, *, top=(), bottom=(), foam=(), pixels=2, film=0.0, **tables):
    """A scene of one meter between a contact on each sheet. edges: of top and bottom."""
    foils = zip(("top", "bottom"), edges, strict=True)
    return Scene.model_validate(
        {
            "name": name,
            "skin": {
                "length": SIDE,
                "width": SIDE,
                "top": {"sheet_resistance": 50e3, **dict(top)},
                "bottom": {"sheet_resistance": 40e3, **dict(bottom)},
                "foam": dict(foam) or {"capacitance_per_area": 4.861e-9},
                **skin,
            },
            "contact": [
                {"name": sheet, "electrode": sheet, "edge": edge, "resistance": film}
                for sheet, edge in foils
            ],
            "interface": [{"name": "meter", "high": ["top"], "low": ["bottom"]}],
            "pixels": {"rows": pixels, "columns": pixels} if isinstance(pixels, int) else pixels,
            "press": {"factor_spread": 0.1},
            "sweep": {"frequencies": [1e3, 1e4, 1e5]},
            "readout": READOUT,
            **tables,
        }
    )


def foam_strip(tension=20.0, bottom=40e3, **tables):
    """Three pixels in a row on foam whose skins spread a press by depth."""
    mechanics = {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": 30e3, "tension": tension}
    return skin_of(
        "foam strip",
        {"length": 0.09, "width": 0.03},
        ("left", "left"),
        bottom={"sheet_resistance": bottom},
        foam={"thickness": 4e-3, "mechanics": mechanics},
        pixels={"rows": 1, "columns": 3},
        **{"press": {"depth": 2e-3, "factor_spread": 0.1}, **tables},
    )


def _written_mesh(path):
    """Triangles of an oblong: groups `near` and `far`, to be pixels, and others between them."""
    lines = np.linspace(0, SIDE, 7), np.linspace(0, HALF, 4)
    x, y = (each.ravel() for each in np.meshgrid(*lines))
    i, j = (each.ravel() for each in np.meshgrid(np.arange(6), np.arange(3)))
    low = 7 * j + i
    cells = np.concatenate([[low, low + 1, low + 8], [low, low + 8, low + 7]], axis=1).T
    column = np.tile(i, 2)
    blocks, tags = [], []
    for tag, members in enumerate((column < 2, (column > 1) & (column < 4), column > 3), 1):
        blocks.append(("triangle", cells[members]))
        tags.append(np.full(members.sum(), tag))
    for tag, line in ((4, 0.0), (5, SIDE)):
        along = np.flatnonzero(x == line)
        blocks.append(("line", np.stack([along[:-1], along[1:]], axis=1)))
        tags.append(np.full(len(along) - 1, tag))
    points = np.stack([x, y, np.zeros_like(x)], axis=1)
    names = {"near": [1, 2], "far": [3, 2], "left": [4, 1], "right": [5, 1]}
    mesh = meshio.Mesh(
        points,
        blocks,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array(each) for name, each in names.items()},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=False)


def _grouped(folder):
    path = folder / "oblong.msh"
    if not path.exists():
        _written_mesh(path)
    groups = {"rows": 1, "columns": 2, "groups": [["near", "far"]]}
    return skin_of("mesh", {"mesh": str(path), "width": HALF}, ("left", "right"), pixels=groups)


def _near(bare, surroundings, *frequencies):
    """A function of the folder: another scene with thick foam near earth."""
    few = {"sweep.frequencies": list(frequencies)}
    return lambda folder: bare(folder).with_({**THICK, "surroundings": surroundings, **few})


def _always(make, *given, **keywords):
    return lambda _: make(*given, **keywords)


def _fed(contacts, surroundings=None):
    """Six pixels read between the first two of the contacts."""
    pair = tuple(contacts)[:2]
    scene = partial(build_scene, contacts, {"meter": pair}, rows=2, columns=3)
    return lambda _: scene().with_({"surroundings": surroundings} if surroundings else {})


def _two_interfaces(_):
    few = {"pixels": 2, "sweep.frequencies": [1e3, 1e4, 2e5]}
    return load_scene("sheet-5x5-two-interfaces").with_(few)


@dataclass(frozen=True)
class Kind:
    """What a law is tried on.

    make: the scene, of a folder for files that it names. rtol: tolerance of reduced models.
    presses: texts of presses that these are trained on. factors: range that they are trained on.
    slow: True if it takes long.
    """

    make: Callable[[Path], Scene]
    rtol: float
    presses: tuple[str, ...]
    factors: tuple[float, float] = (1.0, 3.0)
    slow: bool = False


SIX = "none", "1,2:1.8", "2,3:2.5", "2,1:1.3+1,3:2.9", "1,1:2.0+1,2:1.1", "1,3:1.05+2,3:2.9"
FOUR, TWO = ("1,2:2.4", "1,1:1.3+2,1:2.8"), ("1,2:2.4", "1,1:1.3+1,2:2.8")
BY_FINGERS = "none", "2,2:2", "1,2:touch", "2,1:1.6:3pF+1,2:1.3:rod"
AT_WALLS = "2,1:1.7:rod", "1,1:2.6:3pF+1,2:1.4:rod", "2,2:1.2:3pF+1,1:2.9:3pF"
AT_GROUPS = "1,2:1.7:rod", "1,1:2.6:3pF+1,2:1.4:rod"
DEPTHS = "1,1:0.9mm", "1,2:2.1mm", "1,1:0.5mm+1,3:2mm", "1,1:1.2mm+1,2:0.8mm"

_sheet = _always(lambda: load_scene("sheet-5x5").with_({"pixels": 2}))
_hexagon = _always(
    skin_of, "hexagon", {"outline": {"points": HEXAGON}}, ("outline.2", "outline.5"), film=20.0
)
_strip = _always(
    build_scene,
    {"top-right": {"resistance": 200.0}, "bottom-right": {"resistance": 120.0}},
    columns=3,
)
KINDS = {
    "one field": Kind(_fed(LEFT_PAIR), 1e-5, SIX),
    "crossed": Kind(_fed({"top-left": {}, "bottom-bottom": {}}), 1e-5, SIX),
    "floating foils": Kind(_fed({**LEFT_PAIR, "top-right": {}, "bottom-right": {}}), 1e-5, SIX),
    "films": Kind(
        _fed({"top-left": {"resistance": 300.0}, "bottom-top": {"resistance": 20.0}}), 1e-5, SIX
    ),
    "a floating sheet": Kind(_fed({"top-left": {}, "top-right": {}}), 1e-5, SIX),
    "a floating body": Kind(_fed(LEFT_PAIR, FLOATING_BODY), 1e-5, SIX),
    "a line": Kind(_strip, 1e-5, ("none", "1,3:1.8", "1,1:1.3+1,2:2.9")),
    "two interfaces": Kind(_two_interfaces, 1e-3, FOUR),
    "stretched": Kind(
        _always(lambda: build_scene(rows=2, columns=2).with_({"skin.stretch": {"x": 1.2}})),
        1e-4,
        FOUR,
    ),
    "hexagon": Kind(_hexagon, 1e-3, FOUR),
    "l with a hole": Kind(
        _always(
            skin_of,
            "l with a hole",
            {"outline": {"points": L, "holes": [{"circle": [0.03, 0.03, 0.012]}]}},
            ("outline.6", "hole1"),
        ),
        1e-3,
        FOUR,
        slow=True,
    ),
    "uneven": Kind(
        _always(
            skin_of,
            "uneven",
            {},
            ("left", "left"),
            top=uneven(1),
            bottom=uneven(2),
            foam={"capacitance_per_area": 4.861e-9, **uneven(3)},
        ),
        1e-3,
        FOUR,
    ),
    "piezoresistive": Kind(
        _always(
            skin_of,
            "piezoresistive",
            {"stretch": {"x": 1.2}, "width": 0.03},
            ("left", "left"),
            top={"piezoresistance": 2.0},
            pixels={"rows": 1, "columns": 2},
        ),
        1e-3,
        TWO,
    ),
    "mesh": Kind(_grouped, 1e-3, TWO),
    "draped": Kind(
        _always(
            skin_of, "draped", {"shape": {"kind": "sphere", "radius": 0.1}}, ("left", "bottom")
        ),
        1e-3,
        FOUR,
    ),
    "near a virtual earth": Kind(_near(_sheet, EARTH, 1e3, 1e4, 5e4, 2e5), 1e-3, BY_FINGERS),
    "floating near earth": Kind(
        _near(_sheet, EARTH | {"low": "floating"}, 1e3, 1e4, 5e4, 2e5), 1e-3, BY_FINGERS
    ),
    "guarded": Kind(
        _near(
            _sheet, EARTH | {"body": {"distance": 5e-3, "potential": "high"}}, 1e3, 1e4, 5e4, 2e5
        ),
        1e-3,
        BY_FINGERS,
    ),
    "fingers alone": Kind(_near(_sheet, {"cover": COVER}, 1e3, 1e4, 5e4, 2e5), 1e-3, BY_FINGERS),
    "hexagon near earth": Kind(
        _near(_hexagon, EARTH | {"thickness": False, "low": "floating"}, 1e3, 1e4, 5e4, 2e5),
        1e-3,
        BY_FINGERS,
    ),
    "walls": Kind(_near(_sheet, WALLED, 1e3, 2e4, 2e5), 2e-3, AT_WALLS),
    "walls of a hexagon": Kind(_near(_hexagon, WALLED, 1e3, 2e4, 2e5), 2e-3, AT_WALLS),
    "walls of groups": Kind(_near(_grouped, WALLED, 1e3, 2e4, 2e5), 2e-3, AT_GROUPS),
    "by depth": Kind(_always(foam_strip), 1e-3, DEPTHS, factors=(1.1, 4.0)),
    "by depth near earth": Kind(
        _always(
            lambda: load_scene("foam").with_(
                {
                    "pixels": {"rows": 1, "columns": 2},
                    "sweep.frequencies": [1e3, 1e5],
                    "surroundings": EARTH | {"thickness": False},
                }
            )
        ),
        1e-2,
        ("1,1:0.5mm:1pF+1,2:1mm:5pF", "1,2:0.8mm:3pF"),
    ),
}
