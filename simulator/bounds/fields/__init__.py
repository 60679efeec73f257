"""Impedance of a skin with any map of capacitance, and its derivatives."""

from ..touches.touch_rasterizers import TouchSize
from .field_choice import AnyFields, fields_of
from .full_fields import CELLS_PER_PIXEL, FullFields, Maps

__all__ = ["CELLS_PER_PIXEL", "AnyFields", "FullFields", "Maps", "TouchSize", "fields_of"]
