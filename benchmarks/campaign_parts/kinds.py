"""All kinds of scenes, by name."""

from __future__ import annotations

from collections.abc import Callable

from campaign_parts import kinds_meshes, kinds_pressing, kinds_round, kinds_skins, kinds_touches
from campaign_parts.draws import Rng
from campaign_parts.problem import Case

OF_ALL = (
    kinds_touches.rectangles,
    kinds_touches.discs,
    kinds_touches.polygons,
    kinds_touches.foils,
    kinds_touches.films,
    kinds_touches.one_sheet,
    kinds_touches.lossy,
    kinds_touches.behind_leads,
    kinds_touches.of_varied_elements,
    kinds_skins.anisotropic,
    kinds_skins.anisotropic_touched_anyhow,
    kinds_skins.gauges,
    kinds_skins.gauges_touched_anyhow,
    kinds_skins.gradients_and_random_fields,
    kinds_skins.grids,
    kinds_skins.maps_touched_anyhow,
    kinds_skins.stretched,
    kinds_skins.stretched_and_varied,
    kinds_skins.draped,
    kinds_pressing.depths,
    kinds_pressing.forces,
    kinds_pressing.spread_depths,
    kinds_pressing.spread_forces,
    kinds_pressing.gauges_under_depths,
    kinds_pressing.overlapping_depths,
    kinds_pressing.spread_pairs,
    kinds_round.fed_all_around,
    kinds_round.fed_along_arcs,
    kinds_round.holes,
    kinds_round.discs_cut_by_the_edge,
    kinds_round.outlines,
    kinds_meshes.rectangles_from_files,
    kinds_meshes.ls_from_files,
    kinds_meshes.annuli_from_files,
    kinds_meshes.bent_from_files,
    kinds_meshes.curved_from_files,
)
KINDS: dict[str, Callable[[Rng], Case]] = {each.__name__.replace("_", "-"): each for each in OF_ALL}
