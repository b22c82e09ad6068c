"""The rows that writer.cpp writes, for the tests that read them back, and checks common to these tests."""
import re
import subprocess

import h5py
import numpy as np
import xarray

TIME_CHUNK = 128  # rows: 36 doubles of Lambda in at most 64 KiB
STEP_CHUNK = 256
DIMENSIONS = {
    "time": ("time",),
    "step": ("step",),
    "joint": ("joint",),
    "spatial": ("spatial",),
    "spatial_column": ("spatial_column",),
    "height": ("height",),
    "trajectory/joint_position": ("time", "joint"),
    "operational_space/Lambda": ("time", "spatial", "spatial_column"),
    "energy/total": ("time",),
    "temperature": ("step", "height"),
    "solver/order": ("step",),
    "solver/rhs_evaluations": ("step",),
    "position_unit": ("joint",),
    "provenance/experiment": (),
    "provenance/git_commit": (),
}


# What `finish` adds.
LATE_DIMENSIONS = {
    "response/frequency": ("frequency",),
    "response/gain": ("frequency", "joint"),
    "coupling": ("spatial", "mode"),
    "mode_kind": ("mode",),
}


def numbers(rows, components):
    """(rows, components) array of the numbers in [0, 1) that writer.cpp calls number(row, component)."""
    row = np.arange(rows, dtype=np.uint64)[:, None]
    component = np.asarray(components, dtype=np.uint64)[None, :]
    return ((row * 2654435761 + component * 40503) % 4294967296).astype(float) / 4294967296.0


def check_rows(file):
    """Compares every recorded value, bit for bit. Returns the numbers of rows along time and step."""
    rows, steps = len(file["time"]), len(file["step"])
    instants = np.arange(rows)
    np.testing.assert_array_equal(file["time"][:], instants / 1024)
    np.testing.assert_array_equal(file["trajectory/joint_position"][:], numbers(rows, range(1, 4)))
    expected = numbers(rows, range(4, 40)).reshape(rows, 6, 6)
    expected[instants % 10 == 7] = np.nan
    np.testing.assert_array_equal(file["operational_space/Lambda"][:], expected)
    np.testing.assert_array_equal(file["energy/total"][:], numbers(rows, [40])[:, 0])
    step = np.arange(steps)
    np.testing.assert_array_equal(file["step"][:], step / 512)
    np.testing.assert_array_equal(file["temperature"][:], numbers(steps, [1, 2]))
    np.testing.assert_array_equal(file["solver/order"][:], step % 13)
    np.testing.assert_array_equal(file["solver/rhs_evaluations"][:], step * 7)
    return rows, steps


def check_fixed(file):
    """The content that does not grow."""
    assert list(file["joint"].asstr()) == ["shoulder", "elbow", "wrist \u03b8"]
    assert list(file["height"]) == [0.125, 0.25] and file["height"].attrs["units"] == "m"
    assert list(file["position_unit"].asstr()) == ["rad", "rad", "m"]
    assert file["provenance/experiment"].asstr()[()] == "name: known\nrows: many\n"
    assert file["provenance/git_commit"].asstr()[()] == ""
    assert file.attrs["title"] == "rows of known numbers"
    assert file.attrs["Conventions"] == "CF-1.8"
    assert file.attrs["component_order"] == "angular,linear"


def check_late(file):
    """The content that the end of a run adds."""
    np.testing.assert_array_equal(file["response/frequency"][:], [0.5, 2, 8, 32])
    assert file["response/frequency"].attrs["units"] == "Hz"
    gain = np.arange(1.0, 13).reshape(4, 3)
    gain[3, 2] = np.nan
    np.testing.assert_array_equal(file["response/gain"][:], gain)
    np.testing.assert_array_equal(file["coupling"][:], np.arange(12).reshape(6, 2))
    assert list(file["mode"].asstr()) == ["slow", "fast"]
    assert list(file["mode_kind"].asstr()) == ["real", "pair"]
    assert "_FillValue" not in file["coupling"].attrs
    assert np.isnan(file["response/gain"].attrs["_FillValue"][0])
    assert file["response/gain"].dims[0][0].name == "/response/frequency"
    assert file["response/gain"].dims[1][0].name == "/joint"
    assert file["coupling"].dims[1][0].name == "/mode"


def ncdump_header(path):
    """The text of `ncdump -h`; fails on an error or on a dimension without a name of its own."""
    run = subprocess.run(["ncdump", "-h", path], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert "phony" not in run.stdout
    return run.stdout


def check_other_readers(path, dimensions_of=DIMENSIONS):
    """ncdump and both xarray engines open the file and name every dimension."""
    text = ncdump_header(path)
    rows = {}
    for engine in ("h5netcdf", "netcdf4"):
        for name, dimensions in dimensions_of.items():
            group, _, variable = name.rpartition("/")
            with xarray.open_dataset(path, engine=engine, group=group or None) as data:
                assert data[variable].dims == dimensions, (engine, name, data[variable].dims)
                rows.setdefault(name, []).append(data[variable].shape)
    for name, shapes in rows.items():
        assert shapes[0] == shapes[1], (name, shapes)
    for axis in ("time", "step"):
        printed = int(re.search(rf"\b{axis} = UNLIMITED ; // \((\d+) currently\)", text).group(1))
        assert (printed,) == rows[axis][0]


def recover(writer, source, target):
    return subprocess.run([writer, "recover", source, target], capture_output=True, text=True, timeout=60)


def open_file(path):
    return h5py.File(path, "r")
