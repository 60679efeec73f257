"""Impedance of a skin with any map of capacitance, and its derivatives."""

from ..touches.cells import TouchSize
from .chosen import AnyFields, fields_of
from .full import CELLS_PER_PIXEL, FullFields, Maps

__all__ = ["CELLS_PER_PIXEL", "AnyFields", "FullFields", "Maps", "TouchSize", "fields_of"]
