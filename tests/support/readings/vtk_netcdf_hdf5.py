#!/usr/bin/python3
"""What VTK and HDF5 files hold, read with NumPy and h5py alone, for comparison with what the program reads.

Usage: vtk_netcdf_hdf5.py FOLDER_OF_VOLUMES > tests/data/readings/vtk_netcdf_hdf5.csv
"""

import base64
import re
import struct
import sys
import xml.etree.ElementTree
import zlib
from pathlib import Path

import h5py
import numpy
import xxhash

TYPES = {"u1": "u8", "i1": "i8", "u2": "u16", "i2": "i16", "i4": "i32", "f4": "f32", "f8": "f64"}
COLUMNS = "file,field,component,frame,nx,ny,nz,type,min,max,distinct,missing,xxh3"


def line(file, field, component, dims, values):
    """`values` with x fastest; one line of the table."""
    values = numpy.ascontiguousarray(values).ravel()
    values = values.astype(values.dtype.newbyteorder("<"))
    known = values[numpy.isfinite(values)] if values.dtype.kind == "f" else values
    fields = [file, field, component, "", *dims, TYPES[values.dtype.str[1:]], repr(known.min().item()),
              repr(known.max().item()), len(numpy.unique(known)), len(values) - len(known),
              xxhash.xxh3_64(values.tobytes()).hexdigest()]
    return ",".join(str(field) for field in fields)


# --- VTK XML ----------------------------------------------------------------------------------------

XML_TYPES = {"UInt8": "<u1", "Int8": "<i1", "UInt16": "<u2", "Int16": "<i2", "Int32": "<i4", "Float32": "<f4",
             "Float64": "<f8"}


def unpacked(read, width, packs):
    """The bytes behind the numbers that head them; `read(begin, size)` gives bytes from there."""
    code = "<Q" if width == 8 else "<I"

    def number(index):
        return struct.unpack(code, read(index * width, width))[0]

    if not packs:
        return read(width, number(0))
    blocks = number(0)
    at = (3 + blocks) * width
    out = b""
    for block in range(blocks):
        size = number(3 + block)
        out += zlib.decompress(read(at, size))
        at += size
    return out


def vti_arrays(path):
    raw = path.read_bytes()
    begin = raw.find(b"<AppendedData")
    text = raw if begin < 0 else raw[:begin] + b"</VTKFile>"
    appended = b"" if begin < 0 else raw[raw.index(b"_", begin) + 1:]
    root = xml.etree.ElementTree.fromstring(text)
    extent = [int(word) for word in root.find("ImageData").get("WholeExtent").split()]
    dims = [extent[2 * axis + 1] - extent[2 * axis] + 1 for axis in range(3)]
    width = 8 if root.get("header_type") == "UInt64" else 4
    packs = root.get("compressor") is not None
    for array in root.iter("DataArray"):
        if array.get("type") not in XML_TYPES or array.get("NumberOfTuples"):
            continue
        kind = numpy.dtype(XML_TYPES[array.get("type")])
        if array.get("format") == "ascii":
            values = numpy.array(array.text.split(), dtype=kind)
        elif array.get("format") == "appended":
            body = appended[int(array.get("offset")):]
            values = numpy.frombuffer(unpacked(lambda at, size: body[at:at + size], width, packs), dtype=kind)
        else:
            # The heading numbers are encoded apart from the blocks, whose encodings follow.
            encoded = "".join(array.text.split())
            heading = base64.b64decode(encoded[:4 * ((width + 2) // 3)])
            blocks = struct.unpack("<Q" if width == 8 else "<I", heading[:width])[0]
            size = (3 + blocks) * width if packs else width
            letters = 4 * ((size + 2) // 3)
            body = base64.b64decode(encoded[:letters])[:size] + base64.b64decode(encoded[letters:])
            values = numpy.frombuffer(unpacked(lambda at, count: body[at:at + count], width, packs), dtype=kind)
        components = int(array.get("NumberOfComponents", "1"))
        yield array.get("Name"), dims, values.reshape(-1, components)


# --- VTK legacy -------------------------------------------------------------------------------------

LEGACY_TYPES = {"unsigned_char": "u1", "char": "i1", "unsigned_short": "u2", "short": "i2", "int": "i4",
                "float": "f4", "double": "f8"}


def legacy_arrays(path):
    raw = path.read_bytes()
    is_binary = b"BINARY" in raw[:raw.index(b"DATASET")].upper().split()
    dims = [int(word) for word in re.search(rb"DIMENSIONS\s+(\d+)\s+(\d+)\s+(\d+)", raw).groups()]
    points = dims[0] * dims[1] * dims[2]
    begin = raw.index(b"POINT_DATA")
    for match in re.finditer(rb"(SCALARS|VECTORS) (\S+) (\S+)[^\n]*\n(LOOKUP_TABLE [^\n]*\n)?", raw[begin:]):
        if match.group(3).decode() not in LEGACY_TYPES:
            continue
        components = 3 if match.group(1) == b"VECTORS" else 1
        kind = LEGACY_TYPES[match.group(3).decode()]
        body = raw[begin + match.end():]
        if is_binary:
            values = numpy.frombuffer(body, dtype=">" + kind, count=points * components)
        else:
            words = re.split(rb"[A-Z]{2}", body)[0].split()  # up to the next keyword
            values = numpy.array(words[:points * components], dtype="<" + kind)
        yield match.group(2).decode(), dims, values.reshape(-1, components)


# --- HDF5 -------------------------------------------------------------------------------------------

def open_pmd_fields(path):
    """Fields of openPMD meshes whose axes are x, y, z in this order: x is turned to be the fastest."""
    with h5py.File(path) as file:
        found = []
        file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
        for name in found:
            labels = [label.decode() for label in file[name].parent.attrs["axisLabels"]]
            assert labels == ["x", "y", "z"], labels
            yield "/" + name, file[name].shape, file[name][...].transpose()


def main(folder):
    print(COLUMNS)
    for name in ["vti/heart.vti", "vti/isabel_02.vti", "vti/vase.vti", "vti/vase_4comp.vti", "vti/viscousfingers_001.vti"]:
        for field, dims, values in vti_arrays(folder / name):
            for component in range(values.shape[1]):
                print(line(name, field, component if values.shape[1] > 1 else "", dims, values[:, component]))
    for name in ["vtk/carotid.vtk", "vtk/heart.vtk", "vtk/ironProt.vtk"]:
        for field, dims, values in legacy_arrays(folder / name):
            for component in range(values.shape[1]):
                print(line(name, field, component if values.shape[1] > 1 else "", dims, values[:, component]))
    for field, dims, values in open_pmd_fields(folder / "hdf5/openpmd_femm_3d.h5"):
        print(line("hdf5/openpmd_femm_3d.h5", field, "", dims, values))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
