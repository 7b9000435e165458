"""Recordings: from files and frames, and back."""

from __future__ import annotations

import copy
import hashlib
import pickle
from pathlib import Path

import dynoid
import numpy as np
import pandas
import pyarrow
import pytest

ROWS = [(0.00, 1.0, 10.0), (0.01, 2.0, 11.0), (0.02, 3.5, 12.0), (0.03, -1.0, 13.0)]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "run.csv"
    path.write_text("time [s],T [Nm],N [rpm]\n" + "".join(f"{t},{a},{b}\n" for t, a, b in ROWS), encoding="utf-8")
    return path


def test_exact_channels_of_a_file(file: Path) -> None:
    recording = dynoid.read(file)
    assert recording.names == ["T", "N"] and len(recording) == 2 and "T" in recording and "X" not in recording
    channel = recording["T"]
    assert (channel.unit, channel.clock) == ("Nm", 0)
    assert list(channel.values) == [row[1] for row in ROWS] and list(channel.time) == [row[0] for row in ROWS]
    assert recording.format == "CSV" and len(recording.sha256) == 64
    assert dynoid.read(file, ["N*"]).names == ["N"]


def test_exact_the_hash_is_of_the_file_as_it_was_read(file: Path) -> None:
    expected = hashlib.sha256(file.read_bytes()).hexdigest()
    early, late = dynoid.read(file), dynoid.read(file)
    data = late.dataset("N", "T")
    assert early.sha256 == expected
    file.write_text(file.read_text(encoding="utf-8") + "0.04,1.0,2.0\n", encoding="utf-8")
    assert early.sha256 == expected
    with pytest.raises(dynoid.errors.FileError, match="has changed since it was read") as changed:
        _ = late.sha256
    assert changed.value.file == str(file)
    # What was read stays usable.
    assert pickle.loads(pickle.dumps(data)).samples == 4 and pickle.loads(pickle.dumps(late)).names == late.names


def test_exact_arrays_are_the_decoders_own(file: Path) -> None:
    recording = dynoid.read(file)
    first, second = recording["T"].values, recording["T"].values
    assert np.shares_memory(first, second)
    with pytest.raises(ValueError, match="read-only"):
        first[0] = 0.0
    frame = recording.to_pandas("T", "N")
    assert frame.index.name == "time" and list(frame["N"]) == [row[2] for row in ROWS]


def test_exact_frames_come_and_go(file: Path) -> None:
    recording = dynoid.read(file)
    again = dynoid.from_frame(recording.to_pandas(), units={"T": "Nm"})
    assert again.names == recording.names and again["T"].unit == "Nm"
    assert np.array_equal(again["N"].values, recording["N"].values)
    dated = pandas.DataFrame({"T": [1.0, 2.0]}, index=pandas.to_datetime(["2026-01-01T00:00:00.0", "2026-01-01T00:00:00.5"]))
    assert list(dynoid.from_frame(dated)["T"].time) == [0.0, 0.5]
    table = recording.to_arrow("T")
    assert isinstance(table, pyarrow.Table) and table.schema.field("T").metadata == {b"unit": b"Nm"}
    assert list(dynoid.from_frame(table, time="time")["T"].values) == [row[1] for row in ROWS]
    frame = recording.to_polars()
    assert frame.columns == ["time", "T", "N"]
    assert np.array_equal(dynoid.from_frame(frame, time="time")["N"].values, recording["N"].values)


def test_exact_copies_are_the_same(file: Path) -> None:
    recording = dynoid.read(file)
    data = recording.dataset("N", "T", detrend="mean")
    for other in [pickle.loads(pickle.dumps(recording)), copy.deepcopy(recording)]:
        assert repr(other) == repr(recording) and np.array_equal(other["T"].values, recording["T"].values)
    for other in [pickle.loads(pickle.dumps(data)), copy.copy(data)]:
        assert repr(other) == repr(data) and np.array_equal(other.y, data.y) and np.array_equal(other.time, data.time)


def test_exact_datasets_of_recordings(file: Path) -> None:
    recording = dynoid.read(file)
    data = recording.dataset(u="T", y="N")
    assert (data.inputs, data.outputs, data.samples) == (["T"], ["N"], 4)
    assert data.sample_time == pytest.approx(0.01) and data.units == {"T": "Nm", "N": "rpm"}
    assert list(data.u[:, 0]) == [row[1] for row in ROWS]
    assert data.detrend().y.mean() == pytest.approx(0.0, abs=1e-12)
    first, second = data.split(0.5)
    assert (first + second).samples == 4 and len((first + second).experiments) == 2
    assert second.time[0] == pytest.approx(0.02)


def test_regress_faults_name_file_and_channel(file: Path, tmp_path: Path) -> None:
    with pytest.raises(dynoid.errors.FileError) as missing:
        dynoid.read(tmp_path / "none.mf4")
    assert missing.value.file == str(tmp_path / "none.mf4") and isinstance(missing.value, OSError)
    (tmp_path / "empty.csv").write_bytes(b"")
    with pytest.raises(dynoid.errors.RecordingError, match="the file is empty"):
        dynoid.read(tmp_path / "empty.csv")
    recording = dynoid.read(file)
    with pytest.raises(dynoid.errors.DataError) as unknown:
        recording.dataset("N", "TT")
    assert unknown.value.channel == "TT" and "T" in unknown.value.fields["closest"]
    with pytest.raises(KeyError, match="closest"):
        recording["TT"]
    with pytest.raises(dynoid.errors.ArgumentError, match="4 time stamps"):
        dynoid.Recording.from_arrays(np.arange(4), {"T": np.zeros(3)})
