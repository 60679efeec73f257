"""Writing of files: whole or not at all, with one rule for what may be overwritten."""

from .failures import named_failures, of_disk
from .register import note_made
from .replacing import PYTHON, WriteContext, check_replaceable, in_write_context, write_context
from .user_output import whole_file
from .whole import kept_file, put, sync

__all__ = [
    "PYTHON",
    "WriteContext",
    "check_replaceable",
    "kept_file",
    "named_failures",
    "note_made",
    "write_context",
    "of_disk",
    "in_write_context",
    "put",
    "sync",
    "whole_file",
]
