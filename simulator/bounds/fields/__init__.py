"""What a sweep of a skin under any map of capacitance is, and how it changes."""

from .answer import Answer, Maps
from .chosen import AnyFields, fields_of
from .full import CELLS_PER_PIXEL, Fields
from .reduced import TouchSize

__all__ = ["CELLS_PER_PIXEL", "AnyFields", "Answer", "Fields", "Maps", "TouchSize", "fields_of"]
