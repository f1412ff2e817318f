#!/usr/bin/python3
"""Reads DICOM files and series with pydicom, independently of the reader under test.

usage: dicom.py DATA_FOLDER FILES.csv SERIES.csv

FILES.csv is about single files, SERIES.csv about folders that are packed as archives. Slices are sorted by their
position along the normal, slope and intercept applied. The type is the one the reader promises: integers stay
integers if slope and intercept are whole and everything that the stored bits can hold fits.
"""
import csv
import pathlib
import subprocess
import sys
import tempfile

import numpy
import pydicom
import xxhash

COLUMNS = "file,field,component,frame,nx,ny,nz,type,min,max,distinct,missing,xxh3".split(",")
FILES = ["CT_small.dcm", "MR_small.dcm", "MR_small_RLE.dcm", "MR_small_bigendian.dcm", "MR_small_expb.dcm"]
SERIES = ["philips_phantom_ct_S2020", "studyforrest_t1w"]


def place(slice_):
    orientation = numpy.array([float(v) for v in slice_.ImageOrientationPatient])
    normal = numpy.cross(orientation[:3], orientation[3:])
    return float(normal @ numpy.array([float(v) for v in slice_.ImagePositionPatient]))


def rescale(slice_):
    return float(slice_.get("RescaleSlope", 1)), float(slice_.get("RescaleIntercept", 0))


def result_type(slices):
    stored = slices[0].pixel_array.dtype
    if all(rescale(s) == (1, 0) for s in slices):
        return stored.newbyteorder("<")
    if any(v != int(v) for s in slices for v in rescale(s)):
        return numpy.dtype("<f4")
    bounds = []
    for s in slices:
        bits = int(s.BitsStored)
        low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if s.PixelRepresentation else (0, (1 << bits) - 1)
        slope, intercept = rescale(s)
        bounds += [slope * low + intercept, slope * high + intercept]
    fits = min(bounds) >= -32768 and max(bounds) <= 32767
    return numpy.dtype("<i2" if fits else "<i4")


def row(name, slices):
    slices = sorted(slices, key=place)
    kind = result_type(slices)
    planes = []
    for s in slices:
        slope, intercept = rescale(s)
        values = s.pixel_array.astype(numpy.float64) * slope + intercept
        planes.append(values.astype(kind))
    volume = numpy.ascontiguousarray(numpy.stack(planes))
    nz, ny, nx = volume.shape
    short = {"i2": "i16", "u2": "u16", "i4": "i32", "u1": "u8", "i1": "i8", "f4": "f32"}[kind.str[1:]]
    return [name, "", "", "", nx, ny, nz, short, volume.min(), volume.max(), len(numpy.unique(volume)), 0,
            xxhash.xxh3_64_hexdigest(volume.tobytes())]


def write(path, rows):
    with open(path, "w", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(rows)


def main():
    data = pathlib.Path(sys.argv[1])
    write(sys.argv[2], [row(f"awkward/{name}", [pydicom.dcmread(data / "awkward" / name)]) for name in FILES])
    rows = []
    for name in SERIES:
        with tempfile.TemporaryDirectory() as folder:
            archive = data / "dicom" / f"{name}.tar.zst"
            subprocess.run(["tar", "--zstd", "-xf", archive, "-C", folder], check=True)
            paths = sorted(p for p in pathlib.Path(folder).rglob("*") if p.is_file())
            rows.append(row(f"dicom/{name}.tar.zst", [pydicom.dcmread(p) for p in paths]))
    write(sys.argv[3], rows)


main()
