"""Messages of a viewer: two kinds, each with a schema."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

MAX_MESSAGE = 1024
"""Longest message, bytes."""


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class FrameDrawn(_Message):
    """The viewer has drawn a frame and is ready for the next."""

    do: Literal["seen"]
    frame: Annotated[int, Field(ge=0, le=2**53)]


class PressRequest(_Message):
    """Request to press the skin until the next press."""

    do: Literal["press"]
    press: Annotated[str, Field(max_length=400, pattern=r"^[a-z0-9,:.+() -]+$")]


_MESSAGES: TypeAdapter[FrameDrawn | PressRequest] = TypeAdapter(
    Annotated[FrameDrawn | PressRequest, Field(discriminator="do")]
)


def read_message(text: str | bytes) -> FrameDrawn | PressRequest:
    """Message in a text. Raises ValueError if it is none."""
    if isinstance(text, bytes):
        raise ValueError("a message must be text")
    return _MESSAGES.validate_json(text)
