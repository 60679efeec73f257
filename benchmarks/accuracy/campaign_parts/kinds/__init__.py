"""All kinds of scenes, by name."""

from __future__ import annotations

from collections.abc import Callable

from rcskin.benchmarks.accuracy.campaign_parts.draws import Rng
from rcskin.benchmarks.accuracy.campaign_parts.kinds import (
    circles,
    meshes,
    pressing,
    skins,
    touches,
)
from rcskin.benchmarks.accuracy.campaign_parts.problem import Case

OF_ALL = (
    touches.rectangles,
    touches.discs,
    touches.polygons,
    touches.foils,
    touches.films,
    touches.one_sheet,
    touches.lossy,
    touches.behind_leads,
    touches.of_varied_elements,
    skins.anisotropic,
    skins.anisotropic_touched_anyhow,
    skins.gauges,
    skins.gauges_touched_anyhow,
    skins.gradients_and_random_fields,
    skins.grids,
    skins.maps_touched_anyhow,
    skins.stretched,
    skins.stretched_and_varied,
    skins.draped,
    pressing.depths,
    pressing.forces,
    pressing.spread_depths,
    pressing.spread_forces,
    pressing.gauges_under_depths,
    pressing.overlapping_depths,
    pressing.spread_pairs,
    circles.fed_all_around,
    circles.fed_along_arcs,
    circles.holes,
    circles.discs_cut_by_the_edge,
    circles.outlines,
    meshes.rectangles_from_files,
    meshes.ls_from_files,
    meshes.annuli_from_files,
    meshes.bent_from_files,
    meshes.curved_from_files,
)
KINDS: dict[str, Callable[[Rng], Case]] = {each.__name__.replace("_", "-"): each for each in OF_ALL}
EVEN = ("rectangles", "foils", "films", "one-sheet", "lossy", "behind-leads")
"""Kinds of rectangles with even sheets and foam, touched by rectangles."""
NOT_EVEN = tuple(name for name in KINDS if name not in EVEN)
