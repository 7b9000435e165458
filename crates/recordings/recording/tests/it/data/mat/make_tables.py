"""Small MAT-files of levels 5 and 7.3 with tables and timetables from made-up numbers, by mat-io."""

import sys

import numpy as np
import pandas as pd
from matio import save_to_mat
from matio.utils.converters.mattables import timetable_to_mat
from matio.utils.matclass import MatlabOpaque

folder = sys.argv[1]
n = 6
rows = np.arange(n)
speed = 1000.0 + rows
torque = np.array([-3, -2, -1, 0, 1, 2], dtype=np.int16)


def table(columns, index=None, name=None):
    return pd.DataFrame(columns, index=None if index is None else pd.Index(index, name=name))


def texts(*words):
    return np.array([[np.array([word]) for word in words]], dtype=object).reshape(1, -1)


def timetable(frame, units=None, row_times=None):
    """A timetable with what mat-io does not write of its own: units, and times in equal steps."""
    content = timetable_to_mat(frame)["any"]
    if units:
        content[0, 0]["varUnits"] = texts(*units)
    if row_times:
        record = np.empty((1, 1), dtype=[(key, object) for key in row_times])
        for key, value in row_times.items():
            record[0, 0][key] = value
        content[0, 0]["rowTimes"] = record
    return MatlabOpaque({"any": content}, "timetable")


def duration(milliseconds):
    return MatlabOpaque({"millis": np.array([[float(milliseconds)]]), "fmt": "s"}, "duration")


elapsed = pd.to_timedelta(rows * 500, unit="ms")
later = pd.to_timedelta(rows * 0, unit="ms")
clock = pd.date_range("2024-03-01T10:00:00.250", periods=n, freq="250ms")
steps = dict(origin=duration(2000), specifiedAsRate=np.bool_(False), stepSize=duration(125), sampleRate=np.float64(8))
rates = dict(origin=duration(0), specifiedAsRate=np.bool_(True), stepSize=duration(0), sampleRate=np.float64(1000))
variables = {
    "time": rows * 0.01,
    "plain": rows * 2.0,
    "run": timetable(table({"speed": speed, "torque": torque}, elapsed, "Time"), ("rpm", "")),
    "dated": table({"load": rows * 10.0}, clock, "When"),
    "stepped": timetable(table({"a": rows * 3.0}, later), row_times=steps),
    "rated": timetable(table({"b": rows * 4.0}, later), row_times=rates),
    "list": table({"t_ms": rows * 20.0, "v": rows**2.0, "label": ["a", "b", "c", "d", "e", "f"]}),
    "log": {"t": elapsed.to_numpy().reshape(-1, 1), "n": rows * 5.0, "since": elapsed.to_numpy().reshape(-1, 1)},
    "stamped": table({"Date": clock, "w": rows * -1.0}),
}
save_to_mat(f"{folder}/tables.mat", variables, version="v7")
# Tables take much space there.
few = {name: variables[name] for name in ("time", "plain", "run", "dated", "stepped")}
save_to_mat(f"{folder}/tables73.mat", few, version="v7.3")
