"""Writing of files: whole or not at all, with one rule for what may be replaced."""

from .failures import named_failures, of_disk
from .replacing import (
    WriteContext,
    check_all_replaceable,
    check_replaceable,
    in_write_context,
    whole_file,
    write_context,
)
from .whole import keep_beside, kept_file, present, put, sync

__all__ = [
    "WriteContext",
    "check_all_replaceable",
    "check_replaceable",
    "in_write_context",
    "keep_beside",
    "kept_file",
    "named_failures",
    "of_disk",
    "present",
    "put",
    "sync",
    "whole_file",
    "write_context",
]
