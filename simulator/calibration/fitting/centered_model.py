"""Differentiable model of a fit: the exact line where a scene is one, otherwise `Forward`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...arrays import Integer, Real
from ...models.cosine_modes import NO_MODES, FittedModes
from ...models.heterogeneous.elements_model import single_field
from ...models.line_slopes import LineModel
from ...models.parameters import EFFECTS, FACTORS, own_values, parts_with
from ...models.reduced.forward import REACH, Forward
from ...models.solution import Response
from ...models.terminals import reduced_for
from ...progress import ProgressCallback, silent
from ...scene.parts import SceneParts, Setup, Skin
from ...sweeps import InputError

FAR = 30.0
"""Largest factor on a body or a rim: M is exact in these factors, and the error is certified."""
UNLIMITED = 50.0
"""Logarithm of the largest factor of a model that is valid for any factor."""


Model = Forward | LineModel
"""Both have `respond`, `respond_together`, `certificate` and `cells`, and list the parameters that
are `free`."""


def model_of(
    parts: SceneParts,
    rtol: float,
    progress: ProgressCallback = silent,
    uneven: FittedModes = NO_MODES,
) -> Model:
    """The cheapest model of a scene. rtol: largest relative error of Rs and Cp at the skin.

    uneven: cosine modes among its parameters. Modes of the sheets need two fields.
    """
    try:
        if parts.plan.press.by_factor and uneven == NO_MODES:
            return LineModel(parts.skin, parts.setup)
    except InputError:
        pass
    return Forward(parts, rtol=rtol, progress=progress, train=reduced_for, modes=uneven.modes)


class CenteredModel:
    """A scene's model, trained around parameter values that may be far from the scene's own."""

    def __init__(
        self, model: Model, center: Mapping[str, float], uneven: FittedModes = NO_MODES
    ) -> None:
        """model: the scene's model with its factors at `center`, which are logarithms, and with
        the cosine modes of `uneven`."""
        self.model, self.uneven = model, uneven
        own = own_values(model.skin, model.setup)
        self.center = {name: center.get(name, 0.0) for name in FACTORS if name in own}

    def reach(self, name: str) -> float:
        """Largest distance of the logarithm of a factor from `center`."""
        if isinstance(self.model, LineModel):
            return UNLIMITED
        return math.log(FAR if name in EFFECTS else REACH)

    def own(self, values: Mapping[str, float]) -> dict[str, float]:
        """Values of the scene's parameters, relative to the model's center."""
        return {name: value - self.center.get(name, 0.0) for name, value in values.items()}

    def respond(self, cells: Integer, rises: Real, values: Mapping[str, float]) -> Response:
        """Response to one press; `by_cell` is the derivative by the rises here."""
        own = self.own(values)
        response = self.model.respond(cells, rises, own)
        unpressed = self.model.unpressed_factors(own)[: response.by_cell.shape[-1]]
        by_rise = unpressed * response.by_cell + response.by_gauge
        return replace(response, by_cell=by_rise)

    def respond_together(
        self, cells: Integer, rises: Real, values: Mapping[str, float]
    ) -> Response:
        """Responses to presses that all touch the same number of cells, shape (press, touch).

        Arrays are those of `respond` with a first axis (press,); `by_cell` has the touched cells
        only.
        """
        own = self.own(values)
        if self.model.allows_batches(own):
            response = self.model.respond_together(cells, rises, own)
            unpressed = self.model.unpressed_factors(own)[cells][:, None, None]
            return replace(response, by_cell=unpressed * response.by_cell)
        pairs = zip(cells, rises, strict=True)
        each = [(touched, self.respond(touched, raised, values)) for touched, raised in pairs]
        names = each[0][1].by_parameter
        return Response(
            np.stack([found.Z for _, found in each]),
            {name: np.stack([found.by_parameter[name] for _, found in each]) for name in names},
            np.stack([found.by_cell[..., touched] for touched, found in each]),
            np.stack([found.by_term for _, found in each]),
        )

    def certificate(self, cells: Integer, rises: Real, values: Mapping[str, float]) -> float:
        """See `Model.certificate`."""
        return self.model.certificate(cells, rises, self.own(values))


def centered_model(
    parts: SceneParts,
    values: Mapping[str, float],
    rtol: float,
    progress: ProgressCallback = silent,
    uneven: FittedModes = NO_MODES,
) -> CenteredModel:
    """The scene's model around parameter values. uneven: see `model_of`."""
    center = {name: values.get(name, 0.0) for name in trainable_factors(parts.skin, parts.setup)}
    return CenteredModel(
        model_of(parts_with(parts, center), rtol, progress, uneven), center, uneven
    )


def trainable_factors(skin: Skin, setup: Setup) -> list[str]:
    """Factors that a model may be trained around.

    The mismatch of two sheets that one field describes is none: it would make the field two.
    """
    single = single_field(skin, setup) is not None
    factors = [name for name in own_values(skin, setup) if name in FACTORS]
    return [name for name in factors if not (single and name == "sheet_mismatch")]


def checked_model(model: Model, skin: Skin, setup: Setup, uneven: FittedModes = NO_MODES) -> Model:
    """Returns the model if it has a scene's pixels, interfaces, frequencies and surroundings.

    It must also have the cosine modes of `uneven`. Raises InputError where it does not fit.
    """
    for name, same in (
        ("sweep", np.array_equal(model.setup.frequency, setup.frequency)),
        ("interfaces", model.setup.interfaces == setup.interfaces),
        ("pixels", model.skin.pixels == skin.pixels),
        ("surroundings", model.skin.around == skin.around),
    ):
        if not same:
            raise InputError(f"the model's {name} differ from the measured ones")
    if isinstance(model, Forward) and model.cells_per_pixel != 1:
        raise InputError(f"`cells_per_pixel` of the model must be 1, got {model.cells_per_pixel}")
    if isinstance(model, LineModel) and uneven != NO_MODES:
        raise InputError("cosine modes need a `Forward` model, got the exact line")
    if isinstance(model, Forward) and model.modes < uneven.modes:
        raise InputError(
            f"`modes` of the model must be {uneven.modes} for cosine modes of the sheets, "
            f"got {model.modes}"
        )
    return model
