"""What a viewer may say: two messages, each of a schema, and nothing else."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

MAX_MESSAGE = 1024
"""Bytes of a message."""


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class FrameDrawn(_Message):
    """A frame was drawn: the next one may come."""

    do: Literal["seen"]
    frame: Annotated[int, Field(ge=0, le=2**53)]


class PressRequest(_Message):
    """Press the skin, and hold it until the next press."""

    do: Literal["press"]
    press: Annotated[str, Field(max_length=400, pattern=r"^[a-z0-9,:.+() -]+$")]


_MESSAGES: TypeAdapter[FrameDrawn | PressRequest] = TypeAdapter(
    Annotated[FrameDrawn | PressRequest, Field(discriminator="do")]
)


def read_message(text: str | bytes) -> FrameDrawn | PressRequest:
    """The message that a text is. Raises ValueError where it is none."""
    if isinstance(text, bytes):
        raise ValueError("a message is text")
    return _MESSAGES.validate_json(text)
