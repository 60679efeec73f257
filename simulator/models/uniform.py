"""The uniform scene that is electrically equivalent to a stretched, bent or uniformly mapped one.

A uniform stretch of an isotropic rectangle leaves a rectangle: its sides grow, the sheets'
resistance R' = R J^(p / (1 - p)) and the foam's capacitance per area c' = c0 J^(q / (1 - q)) are
uniform again (see `materials`). Contact resistance times length of contact line is assumed
constant. Bending to a cylinder changes no length. Maps of one factor are factors.

Positions in m of a press are those of the unstretched skin, so they move with it:
`equivalent_press`. Shapes other than pixels and rectangles have no uniform scene: they are solved
on the flat, unstretched skin, with the coefficients of `materials`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NoReturn, TypeVar

from ..press.press import Press
from ..press.touch import AnyTouch, Rectangle, Touch
from ..scene.foam.foam import Foam
from ..scene.pixel_grid import Pressing
from ..scene.scene import Scene
from ..scene.skin import Sheet, SkinTable
from ..sweeps import InputError

Part = TypeVar("Part", Sheet, Foam)


def equivalent_scene(scene: Scene) -> Scene:
    """Scene with uniform parameters as far as they can represent it, see `equivalent_skin`.

    A uniform scene is returned as it is.
    """
    skin = equivalent_skin(scene.skin)
    return scene if skin is scene.skin else scene.model_copy(update={"skin": skin})


def equivalent_skin(skin: SkinTable) -> SkinTable:
    """Electrically equivalent skin.

    Uniform maps, anisotropy of ratio 1 and bending to a cylinder are always replaced; a stretch is
    replaced if the rest is uniform.
    """
    flat = _without_uniform_maps(skin)
    return _stretched(flat) if flat.beyond_uniform == ["skin.stretch"] else flat


def equivalent_press(scene: Scene, press: Press, uniform: Scene | None = None) -> Press | None:
    """Same press on `equivalent_scene(scene)`; None if press or scene are not uniform.

    uniform: `equivalent_scene(scene)`, if it is known.
    """
    if not (press.plain and (uniform or equivalent_scene(scene)).uniform):
        return None
    ratios = scene.skin.stretch.ratios if scene.skin.stretch else (1.0, 1.0)
    if ratios == (1.0, 1.0):
        return press
    return Press(tuple(_moved(touch, *ratios) for touch in press.touches))


def folded(scene: Scene, what: str, creeps: bool = False) -> Scene:
    """Equivalent scene for a feature `what` that presses by factors.

    Positions in m are those of the stretched skin if it is uniform. If a tension spreads presses by
    depth, the scene stays as it is; without tension a depth becomes the factor that it causes.
    creeps: True if the feature takes factors of foam that creeps. Raises InputError if the feature
    cannot take the way in which pixels are pressed, and what `require_static` raises.
    """
    mechanics, pressed = scene.skin.foam.mechanics, uniformly_pressed(scene, what, creeps)
    spread = not scene.press.by_factor and mechanics is not None and mechanics.tension
    return scene if spread else pressed


def uniformly_pressed(scene: Scene, what: str, creeps: bool = False) -> Scene:
    """Scene as `folded` returns it, but without the spread by a tension next to applicators."""
    if not (creeps and scene.press.by_factor):
        require_static(scene, f"{what} by `press.depth`" if creeps else what)
    if scene.press.by_factor:
        return equivalent_scene(scene)
    if scene.press.force is not None:
        return _by_depth_alone(scene, what)
    factor, spread = scene.pressed_factor, scene.press.factor_spread
    pressing = Pressing(capacitance_factor=factor, factor_spread=spread, finger=scene.press.finger)
    return scene.model_copy(update={"press": pressing, "skin": equivalent_skin(scene.skin)})


def require_static(scene: Scene, what: str) -> Scene:
    """The given scene, if its foam does not change while it is pressed.

    what: name of the feature that needs this. Raises InputError with the key of the scene that
    makes the foam change.
    """
    for key in scene.skin.foam.in_time:
        raise InputError(
            f"{scene.name}: {what} cannot take `{key}`: it takes presses as they are at once; "
            "leave the key out"
        )
    return scene


def require_uniform(scene: Scene, what: str) -> Scene:
    """The given scene, if it is uniform and has no surroundings.

    what: name of the feature that needs this. Raises InputError with the key of the scene that
    prevents it.
    """
    scene.require_sheets_alone(what)
    for key in scene.skin.beyond_uniform:
        raise InputError(
            f"{scene.name}: {what} cannot take `{key}`: it needs uniform sheets and foam on a "
            "rectangle"
        )
    return scene


def _by_depth_alone(scene: Scene, what: str) -> NoReturn:
    raise InputError(
        f"{scene.name}: {what} cannot take `press.force`: it needs `press.depth` or "
        "`press.capacitance_factor`"
    )


def _without_uniform_maps(skin: SkinTable) -> SkinTable:
    """Skin without uniform maps, without anisotropy of ratio 1, and flat if it only bends."""
    changed = {
        "top": _without_uniform_map(_without_unit_anisotropy(skin.top)),
        "bottom": _without_uniform_map(_without_unit_anisotropy(skin.bottom)),
        "foam": _without_uniform_map(skin.foam),
        "shape": None if skin.shape is not None and skin.shape.developable else skin.shape,
    }
    if all(getattr(skin, name) is part for name, part in changed.items()):
        return skin
    return skin.model_copy(update=changed)


def _without_unit_anisotropy(sheet: Sheet) -> Sheet:
    if sheet.anisotropy is None or sheet.anisotropy.ratio != 1:
        return sheet
    return sheet.model_copy(update={"anisotropy": None})


def _without_uniform_map(part: Part) -> Part:
    factor = None if part.map is None else part.map.uniform
    if factor is None:
        return part
    return _times(part, factor).model_copy(update={"map": None})


def _times(part: Part, factor: float) -> Part:
    """Part with `factor` times the resistance, or times the capacitance per area."""
    if isinstance(part, Sheet):
        return part.model_copy(update={"sheet_resistance": part.sheet_resistance * factor})
    if part.capacitance_per_area is None and part.mechanics is None:
        assert part.thickness is not None
        return part.model_copy(update={"thickness": part.thickness / factor})
    c = part.unpressed_capacitance_per_area * factor
    return part.model_copy(update={"capacitance_per_area": c, "relative_permittivity": None})


def _stretched(skin: SkinTable) -> SkinTable:
    stretch = skin.stretch
    assert stretch is not None
    along, across = stretch.ratios
    of_sheets, of_foam = ((along * across) ** power for power in stretch.thinning)
    return skin.model_copy(
        update={
            "length": skin.length * along,
            "width": skin.width * across,
            "top": _times(skin.top, of_sheets),
            "bottom": _times(skin.bottom, of_sheets),
            "foam": _thinned(skin.foam, of_foam),
            "stretch": None,
        }
    )


def _thinned(foam: Foam, factor: float) -> Foam:
    """Foam with `factor` times the capacitance per area, by its thickness if that is known."""
    thinner = _times(foam, factor)
    if foam.thickness is None:
        return thinner
    return thinner.model_copy(update={"thickness": foam.thickness / factor})


def _moved(touch: AnyTouch, along: float, across: float) -> AnyTouch:
    match touch:
        case Rectangle(x, y, width, height):
            moved = {"width": width * along, "height": height * across}
            return replace(touch, x=x * along, y=y * across, **moved)
        case _:
            assert isinstance(touch, Touch)
            return touch
