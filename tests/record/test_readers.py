"""A finished file as ncdump, h5py and both xarray engines see it, and a live reader beside a running writer.
Usage: test_readers.py WRITER"""
import subprocess
import sys
import tempfile
import time
import warnings

import h5netcdf  # noqa: F401  imported here so that only what our file provokes can warn below
import h5py
import netCDF4  # noqa: F401
import numpy as np
import xarray

from known_rows import (DIMENSIONS, LATE_DIMENSIONS, check_fixed, check_late, check_other_readers, check_rows,
                        ncdump_header, numbers, open_file)

ROWS = 1000  # seven full chunks along time and a part of one


def h5py_sees_everything(path):
    with open_file(path) as file:
        assert check_rows(file) == (ROWS, (ROWS + 2) // 3)
        check_fixed(file)
        check_late(file)
        assert file.attrs["status"] == "complete" and file.attrs["verdict"] == "pass"
        status = file.attrs.get_id("status").get_type()
        assert status.is_variable_str() and status.get_cset() == h5py.h5t.CSET_UTF8
        found = []

        def look(name, item):
            flags = item.id.get_create_plist().get_attr_creation_order()
            assert flags == h5py.h5p.CRT_ORDER_TRACKED | h5py.h5p.CRT_ORDER_INDEXED, name
            if isinstance(item, h5py.Group):
                assert item.id.get_create_plist().get_link_creation_order() == flags, name
                return
            found.append(name)
            assert item.attrs["long_name"], name
            assert not item.id.get_create_plist().get_obj_track_times(), name
            assert item.dtype.kind != "b" and h5py.check_enum_dtype(item.dtype) is None, name
            assert h5py.h5ds.is_scale(item.id) or all(len(dimension) == 1 for dimension in item.dims), name
            if item.maxshape and item.maxshape[0] is None:
                assert item.shuffle and item.compression == "gzip", name

        file.visititems(look)
        # Noise is stored past the filters, a column that repeats itself through them.
        noise, constant = file["operational_space/Lambda"], file["solver/order"]
        assert noise.id.get_chunk_info(0).filter_mask != 0 and constant.id.get_chunk_info(0).filter_mask == 0
        assert set(DIMENSIONS) < set(found)
        for name, dimensions in DIMENSIONS.items():
            if not h5py.h5ds.is_scale(file[name].id):
                assert tuple(dimension[0].name for dimension in file[name].dims) == tuple("/" + d for d in dimensions)
        assert file["time"].attrs["units"] == "s" and file["energy/total"].attrs["units"] == "J"
        assert "units" not in file["trajectory/joint_position"].attrs
        assert np.isnan(file["operational_space/Lambda"].attrs["_FillValue"][0])
        assert "_FillValue" not in file["trajectory/joint_position"].attrs
        verdict = file["verdict"]
        assert list(verdict["claim"].asstr()) == ["energy balance", "gravity-free rest"]
        assert list(verdict["equation"].asstr()) == ["(12)", "(7)"]
        assert list(verdict["reason"].asstr()) == ["", "gravity is on"]
        assert verdict["result"].dtype == np.int8 and list(verdict["result"]) == [1, -1]
        assert list(verdict["checked_steps"]) == [100, 0] and list(verdict["undecided_steps"]) == [3, 0]
        np.testing.assert_array_equal(verdict["worst"], [1e-12, np.nan])
        np.testing.assert_array_equal(verdict["at_time"], [0.5, np.nan])
        assert file["timing/simulation"][()] == 0.25 and file["timing/simulation"].attrs["units"] == "s"


def ncdump_names_everything(path):
    text = ncdump_header(path)
    for line in ("time = UNLIMITED ; // (1000 currently)", "double joint_position(time, joint) ;",
                 "double Lambda(time, spatial, spatial_column) ;", "string joint(joint) ;", "byte order(step) ;",
                 "int64 rhs_evaluations(step) ;", 'string time:units = "s" ;', "byte result(claim) ;", "claim = 2 ;",
                 "double temperature(step, height) ;", "double gain(frequency, joint) ;", "double coupling(spatial, mode) ;",
                 'string frequency:units = "Hz" ;', "frequency = 4 ;", 'string :status = "complete" ;', "string experiment ;"):
        assert line in text, line


def xarray_needs_no_help(path):
    check_other_readers(path, DIMENSIONS | LATE_DIMENSIONS)
    for engine in ("h5netcdf", "netcdf4"):
        with xarray.open_dataset(path, engine=engine) as root:
            assert list(root["joint"].values) == ["shoulder", "elbow", "wrist \u03b8"]
            assert root["time"].dtype == np.float64 and root["time"].attrs["units"] == "s"
            assert root.attrs["status"] == "complete"
            assert {"time", "step"} == set(root.encoding["unlimited_dims"])
            with xarray.open_dataset(path, engine=engine, group="trajectory") as trajectory:
                both = xarray.merge([root, trajectory])
                assert both["joint_position"].sel(joint="elbow").shape == (ROWS,)
                assert trajectory["joint_position"].attrs["long_name"] == "joint coordinates"
            assert float(root["temperature"].sel(height=0.25).isel(step=3)) == numbers(4, [2])[3, 0]
            assert float(root["coupling"].sel(spatial="wz", mode="fast")) == 5
        with xarray.open_dataset(path, engine=engine, group="response") as response:
            assert list(response["gain"].sel(frequency=8).values) == [7, 8, 9]
            assert np.isnan(response["gain"].sel(frequency=32)[2])
            assert response["frequency"].attrs["units"] == "Hz"
        with xarray.open_dataset(path, engine=engine, group="verdict") as verdict:
            assert list(verdict["reason"].values) == ["", "gravity is on"]
            assert verdict["result"].dtype == np.int8
        with xarray.open_dataset(path, engine=engine, group="provenance") as provenance:
            assert str(provenance["experiment"].values) == "name: known\nrows: many\n"


def a_live_reader_follows(writer, path):
    process = subprocess.Popen([writer, "run", path, str(12 * ROWS), "3000"], stdout=subprocess.DEVNULL)
    while True:
        try:
            file = h5py.File(path, "r", libver="latest", swmr=True)
            break
        except FileNotFoundError:
            assert process.poll() is None
            time.sleep(0.01)
    with file:
        assert file.attrs["status"] == "running"
        seen = []
        while process.poll() is None:
            for name in ("time", "trajectory/joint_position", "operational_space/Lambda"):
                file[name].id.refresh()
            rows = len(file["time"])
            assert len(file["trajectory/joint_position"]) >= rows  # the reader may see it before, never after
            np.testing.assert_array_equal(file["time"][:], np.arange(rows) / 1024)
            seen.append(rows)
            time.sleep(0.1)
    assert process.returncode == 0
    assert len(set(seen)) >= 3, seen
    with open_file(path) as finished:  # although a reader was there at the end
        assert finished.attrs["status"] == "complete"
        assert check_rows(finished)[0] == 12 * ROWS


def main(writer):
    warnings.simplefilter("error")
    with tempfile.TemporaryDirectory() as directory:
        path = directory + "/finished.h5"
        subprocess.run([writer, "run", path, str(ROWS), "0"], stdout=subprocess.DEVNULL, check=True)
        h5py_sees_everything(path)
        ncdump_names_everything(path)
        xarray_needs_no_help(path)
        a_live_reader_follows(writer, directory + "/live.h5")
    print("readers: ok")


main(sys.argv[1])
