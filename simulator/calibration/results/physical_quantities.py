"""Physical quantities whose logarithm is a sum of parameters: sheets, foam and surroundings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from ...models.parameters import effects_of
from ...scene.parts import Setup, Skin
from ...surroundings.rim import rim_densities
from .sheet_intervals import Product, sheets


def products(skin: Skin, setup: Setup, values: Mapping[str, float]) -> Iterator[Product]:
    """All such quantities of a scene. values: of all parameters."""
    yield from sheets(skin, setup, values)
    c, factor = skin.foam.unpressed_capacitance_per_area, math.exp(values["capacitance"])
    yield Product("foam capacitance", "F/m²", c, factor * c, {"capacitance": 1.0})
    film = math.exp(values["contact_resistance"])
    for contact in skin.contacts:
        if not contact.ideal:
            name, resistance = f"contact {contact.name}", contact.resistance
            slopes = {"contact_resistance": 1.0}
            yield Product(name, "ohm m", resistance, resistance * film, slopes)
    yield from _of_surroundings(skin, values)


def _of_surroundings(skin: Skin, values: Mapping[str, float]) -> Iterator[Product]:
    """Distances or capacitances of bodies, and capacitances of the rim."""
    around, own = skin.around, effects_of(skin)
    if around is None:
        return
    for body in around.body if "body" in own else ():
        name, factor = f"body, {body.side}", math.exp(values["body"])
        if body.distance is None:
            c = body.per_area
            yield Product(name, "F/m²", c, c * factor, {"body": 1.0})
        else:
            yield Product(name, "m", body.distance, body.distance / factor, {"body": -1.0})
    if "rim" in own:
        factor = math.exp(values["rim"])
        rim = rim_densities(skin)
        for part in ("mutual", "top", "bottom"):
            if value := getattr(rim, part):
                yield Product(f"rim, {part}", "F/m", value, value * factor, {"rim": 1.0})
