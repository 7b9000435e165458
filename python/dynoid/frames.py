"""Recordings from and to frames. pandas, polars and pyarrow are imported when they are needed."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _dynoid
from ._dynoid import Dataset, Recording
from .errors import ArgumentError
from .results import Channel, Floats

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow


def read(
    path: str | os.PathLike[str],
    channels: Sequence[str] | None = None,
    *,
    row_time: float | None = None,
    progress: Callable[[float, str], object] | None = None,
) -> Recording:
    """Reads a recording: MDF, CSV, MATLAB, HDF5, Parquet or Arrow.

    `channels` are names, or patterns such as `"T_*"`. Text without a time column needs `row_time`, the seconds from row to row. `progress` is
    called with the part that is done, from 0 to 1, and with the step under way.
    """
    wanted = None if channels is None else list(channels)
    return _dynoid.read(path, wanted, row_time, progress)


def from_frame(
    frame: Any,
    *,
    time: str | None = None,
    units: Mapping[str, str] | None = None,
    name: str = "frame",
) -> Recording:
    """A recording of the numeric columns of a frame of pandas or polars, or of an Arrow table.

    `time` names the column of time stamps. Without it, the index of a pandas frame is the time. Dates count in seconds from the first.
    """
    columns: dict[str, Any]
    if hasattr(frame, "column_names"):
        columns = {column: frame[column].to_numpy() for column in frame.column_names}
    else:
        columns = {str(column): frame[column].to_numpy() for column in frame.columns}
    if time is not None:
        if time not in columns:
            raise ArgumentError(f'time="{time}": the frame has no such column; it has {", ".join(columns)}')
        stamps = columns.pop(time)
    elif hasattr(frame, "index"):
        stamps = frame.index.to_numpy()
    else:
        raise ArgumentError("the frame has no index; name the column of time stamps with `time`")
    numeric = {column: values for column, values in columns.items() if np.issubdtype(values.dtype, np.number)}
    return Recording.from_arrays(_seconds(stamps), numeric, dict(units or {}), name)


def _seconds(stamps: Any) -> Floats:
    stamps = np.asarray(stamps)
    if np.issubdtype(stamps.dtype, np.datetime64):
        return np.asarray((stamps - stamps[0]) / np.timedelta64(1, "ns") * 1e-9, dtype=np.float64)
    if np.issubdtype(stamps.dtype, np.timedelta64):
        return np.asarray(stamps / np.timedelta64(1, "ns") * 1e-9, dtype=np.float64)
    return np.asarray(stamps, dtype=np.float64)


def to_pandas(recording: Recording, names: Sequence[str]) -> pandas.DataFrame:
    """Channels that share a clock, with the time in seconds as the index."""
    import pandas

    channels = _on_one_clock(recording, names)
    index = pandas.Index(channels[0].time, name="time")
    return pandas.DataFrame({channel.name: channel.values for channel in channels}, index=index, copy=False)


def to_polars(recording: Recording, names: Sequence[str]) -> polars.DataFrame:
    """Channels that share a clock, and the column `time`."""
    import polars

    channels = _on_one_clock(recording, names)
    return polars.DataFrame({"time": channels[0].time} | {channel.name: channel.values for channel in channels})


def to_arrow(recording: Recording, names: Sequence[str]) -> pyarrow.Table:
    """Channels that share a clock, and the column `time`, with units as metadata."""
    import pyarrow

    channels = _on_one_clock(recording, names)
    fields = [pyarrow.field("time", pyarrow.float64(), metadata={"unit": "s"})]
    fields += [pyarrow.field(c.name, pyarrow.float64(), metadata={"unit": c.unit}) for c in channels]
    arrays = [channels[0].time] + [channel.values for channel in channels]
    return pyarrow.table([pyarrow.array(array) for array in arrays], schema=pyarrow.schema(fields))


def dataset_to_pandas(data: Dataset) -> pandas.DataFrame:
    """Inputs and outputs, with the time in seconds as the index."""
    import pandas

    columns = dict(zip(data.inputs, data.u.T, strict=True)) | dict(zip(data.outputs, data.y.T, strict=True))
    return pandas.DataFrame(columns, index=pandas.Index(data.time, name="time"))


def _on_one_clock(recording: Recording, names: Sequence[str]) -> list[Channel]:
    channels = [recording[name] for name in names] or recording.channels
    clocks = sorted({channel.clock for channel in channels})
    if not channels:
        raise ArgumentError(f"{recording.file}: the recording has no channel")
    if len(clocks) > 1:
        lists = "; ".join(", ".join(c.name for c in channels if c.clock == clock) for clock in clocks)
        raise ArgumentError(
            f"{recording.file}: these channels are on {len(clocks)} clocks; name channels of one ({lists}), or use `dataset`"
        )
    return channels
