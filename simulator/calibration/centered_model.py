"""The differentiable model that a fit asks: the exact line where a scene is one, else `Forward`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..models.cosine_modes.amplitudes import NO_MODES, FittedModes
from ..models.effects import EFFECTS
from ..models.heterogeneous.mesh_choice import single_field
from ..models.line_slopes import LineModel
from ..models.network.terminals import reduced_for
from ..models.parameters import FACTORS, own_values, scene_with
from ..models.reduced.forward import REACH, Forward
from ..models.response import Response
from ..progress import ProgressCallback, silent
from ..scene.scene import Scene
from ..sweeps import InputError

FAR = 30.0
"""Times a body or a rim: M knows any factor of them, and what it then leaves out is certified."""
ANYWHERE = 50.0
"""Logarithm of the largest factor of a model that knows no reach."""


Model = Forward | LineModel
"""Both answer `respond`, `respond_together`, `certificate` and `cells` alike, and know what is
`free`."""


def model_of(
    scene: Scene, rtol: float, progress: ProgressCallback = silent, uneven: FittedModes = NO_MODES
) -> Model:
    """The cheapest one that serves. rtol: largest relative error of Rs and Cp at the skin.

    uneven: what slow waves are to be among its parameters. Those of sheets take two fields.
    """
    try:
        if scene.press.by_factor and uneven == NO_MODES:
            return LineModel(scene)
    except InputError:
        pass
    return Forward(scene, rtol=rtol, progress=progress, train=reduced_for, modes=uneven.modes)


class Around:
    """A scene's model, trained about values of its parameters that may be far from the scene's."""

    def __init__(
        self, model: Model, about: Mapping[str, float], uneven: FittedModes = NO_MODES
    ) -> None:
        """model: of the scene with its factors at `about`, which are logarithms, and with slow
        waves where it is `uneven`."""
        self.model, self.uneven = model, uneven
        own = own_values(model.scene)
        self.about = {name: about.get(name, 0.0) for name in FACTORS if name in own}

    def reach(self, name: str) -> float:
        """How far the logarithm of a factor may be from `about`."""
        if isinstance(self.model, LineModel):
            return ANYWHERE
        return math.log(FAR if name in EFFECTS else REACH)

    def own(self, values: Mapping[str, float]) -> dict[str, float]:
        """Values of the scene's parameters as the model counts them."""
        return {name: value - self.about.get(name, 0.0) for name, value in values.items()}

    def respond(
        self, cells: NDArray[np.int64], rises: NDArray[np.float64], values: Mapping[str, float]
    ) -> Response:
        """Of one press; `by_cell` is to the rises here."""
        own = self.own(values)
        response = self.model.respond(cells, rises, own)
        at_rest = self.model.factors_at_rest(own)[: response.by_cell.shape[-1]]
        by_rise = at_rest * response.by_cell + response.by_gauge
        return replace(response, by_cell=by_rise)

    def respond_together(
        self, cells: NDArray[np.int64], rises: NDArray[np.float64], values: Mapping[str, float]
    ) -> Response:
        """Of presses that touch as many cells each, shape (press, touch).

        As `respond`, with an axis (press,) first; `by_cell` of the touched ones alone.
        """
        own = self.own(values)
        if self.model.alike(own):
            response = self.model.respond_together(cells, rises, own)
            at_rest = self.model.factors_at_rest(own)[cells][:, None, None]
            return replace(response, by_cell=at_rest * response.by_cell)
        pairs = zip(cells, rises, strict=True)
        each = [(touched, self.respond(touched, raised, values)) for touched, raised in pairs]
        names = each[0][1].by_parameter
        return Response(
            np.stack([found.Z for _, found in each]),
            {name: np.stack([found.by_parameter[name] for _, found in each]) for name in names},
            np.stack([found.by_cell[..., touched] for touched, found in each]),
            np.stack([found.by_term for _, found in each]),
        )

    def certificate(
        self, cells: NDArray[np.int64], rises: NDArray[np.float64], values: Mapping[str, float]
    ) -> float:
        """See `Model.certificate`."""
        return self.model.certificate(cells, rises, self.own(values))


def around(
    scene: Scene,
    values: Mapping[str, float],
    rtol: float,
    progress: ProgressCallback = silent,
    uneven: FittedModes = NO_MODES,
) -> Around:
    """The scene's model about values of its parameters. uneven: as of `model_of`."""
    about = {name: values.get(name, 0.0) for name in movable(scene)}
    return Around(model_of(scene_with(scene, about), rtol, progress, uneven), about, uneven)


def movable(scene: Scene) -> list[str]:
    """Factors that a model may be trained about: not such that one field would become two."""
    single = single_field(scene) is not None
    factors = [name for name in own_values(scene) if name in FACTORS]
    return [name for name in factors if not (single and name == "sheet_mismatch")]


def checked_model(model: Model, scene: Scene, uneven: FittedModes = NO_MODES) -> Model:
    """The same model, if it is of the pixels, interfaces, frequencies and surroundings of a scene,
    and has slow waves where they are asked for.

    Raises InputError where it is not.
    """
    for name in ("sweep", "interfaces", "pixels", "surroundings"):
        if getattr(model.scene, name) != getattr(scene, name):
            raise InputError(f"the model has other {name} than were measured")
    if isinstance(model, Forward) and model.cells_per_pixel != 1:
        raise InputError(f"`cells_per_pixel` of the model must be 1, got {model.cells_per_pixel}")
    if isinstance(model, LineModel) and uneven != NO_MODES:
        raise InputError("the model must be a `Forward` for slow waves, got the exact line")
    if isinstance(model, Forward) and model.modes < uneven.modes:
        raise InputError(
            f"`modes` of the model must be {uneven.modes} for slow waves of the sheets, "
            f"got {model.modes}"
        )
    return model
