"""Fingers at point contacts: capacitances to earth on the cells of their patches."""

from __future__ import annotations

import numpy as np

from ...arrays import Real
from ...mesh.pixel_coverage import with_fingers_at
from ...press.batch import PressBatch
from ...press.finger import finger_over
from ...press.rasterized import Footprints
from ...scene.parts import Pressing, Skin
from .contact_types import PointContacts


def with_fingers(
    skin: Skin,
    pressing: Pressing,
    contacts: PointContacts,
    batch: PressBatch,
    outer: Real,
    grid: tuple[int, int],
) -> PressBatch:
    """Presses with the scene's finger on the patch of each contact, as parts of M that rise by F.

    outer: radius of each patch, m, shape (press, contact); 0 for rectangles.
    """
    x, y, _, _, _, width, height = np.moveaxis(contacts.values, -1, 0)
    disc = outer > 0
    width, height = np.where(disc, 2 * outer, width), np.where(disc, 2 * outer, height)
    left, right = (np.clip(x + side * width / 2, 0.0, skin.length) for side in (-1, 1))
    low, high = (np.clip(y + side * height / 2, 0.0, skin.width) for side in (-1, 1))
    area = np.where(disc, np.pi * outer**2, (right - left) * (high - low))
    there = (np.arange(x.shape[1]) < contacts.counts[:, None]) & (area > 0)
    finger = np.where(there, finger_over(skin, area, pressing.finger), 0.0)
    placed = Footprints(disc, x, y, width, height, np.ones(x.shape), finger)
    return with_fingers_at(skin, batch, contacts.counts, placed, grid)
