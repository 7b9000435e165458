"""Exceptions. Each has its message, which ends with a remedy, and the fields that the message names."""

from __future__ import annotations

from typing import Any


class DynoidError(Exception):
    """Why something cannot be done."""

    message: str
    """What is wrong, where, and the remedy."""
    fields: dict[str, Any]
    """What the message names: `kind`, and, where they are known, `file`, `channel`, `sample` and others."""

    def __init__(self, message: str, **fields: Any) -> None:
        super().__init__(message)
        self.message = message
        self.fields = fields

    @property
    def kind(self) -> str:
        """The fault in one word."""
        return str(self.fields.get("kind", type(self).__name__))

    @property
    def file(self) -> str | None:
        """The file, where there is one."""
        return self.fields.get("file")

    @property
    def channel(self) -> str | None:
        """The channel, where it is known."""
        return self.fields.get("channel")

    @property
    def sample(self) -> int | None:
        """Index of the sample, where it is known."""
        return self.fields.get("sample")

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), self.message, self.fields)


def _restored(kind: type[DynoidError], message: str, fields: dict[str, Any]) -> DynoidError:
    return kind(message, **fields)


class ArgumentError(DynoidError, ValueError):
    """An argument that cannot be used."""


class FileError(DynoidError, OSError):
    """A file or folder that cannot be read or written."""


class RecordingError(DynoidError, ValueError):
    """A recording that cannot be decoded."""


class DataError(DynoidError, ValueError):
    """Channels that cannot become data, or data with a fault."""


class EstimateError(DynoidError, ValueError):
    """Data from which this estimate cannot be made, or a structure that does not fit them."""


class BenchError(DynoidError, ValueError):
    """A bench file with faults, or recordings that give no study."""
