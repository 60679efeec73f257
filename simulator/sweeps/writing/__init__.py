"""Writing of files: whole or not at all, with one rule for what may be replaced."""

from .failures import named_failures
from .replacing import (
    WriteContext,
    check_all_replaceable,
    check_replaceable,
    in_write_context,
    whole_file,
    write_context,
)
from .whole import PREFIX, keep_beside, kept_file, present, put, sync

__all__ = [
    "PREFIX",
    "WriteContext",
    "check_all_replaceable",
    "check_replaceable",
    "in_write_context",
    "keep_beside",
    "kept_file",
    "named_failures",
    "present",
    "put",
    "sync",
    "whole_file",
    "write_context",
]
