"""Writing: files that appear whole or not at all, and the one rule of what may be replaced."""

from .failures import named_failures, of_disk
from .register import note_made
from .replacing import PYTHON, Occasion, check_free, occasion, on_occasion
from .user_output import whole_file
from .whole import kept_file, put, sync

__all__ = [
    "PYTHON",
    "Occasion",
    "check_free",
    "kept_file",
    "named_failures",
    "note_made",
    "occasion",
    "of_disk",
    "on_occasion",
    "put",
    "sync",
    "whole_file",
]
