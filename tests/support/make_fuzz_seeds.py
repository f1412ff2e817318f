#!/usr/bin/python3
"""Small sound files for the fuzz targets to start from.

  make_fuzz_seeds.py FOLDER [ISOSLIDER_CLI]     FOLDER: tests/fuzz/seeds

Everything is made here, byte by byte or by libraries that know nothing of this project; indexes and OM meshes by
isoslider-cli, where it is named. The same bytes every time, but for those of the libraries' own versions.
"""
import bz2
import gzip
import io
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import zlib

import netCDF4
import nibabel
import numpy
import pydicom
import tifffile
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.encaps import encapsulate
from pydicom.pixel_data_handlers.rle_handler import rle_encode_frame

FOLDER = pathlib.Path(sys.argv[1])
X, Y, Z = 5, 4, 3
SAMPLES = (numpy.arange(X * Y * Z) * 37 % 251).astype("<u2").reshape(Z, Y, X)


def put(target, name, content):
    (FOLDER / target).mkdir(parents=True, exist_ok=True)
    (FOLDER / target / name).write_bytes(content if isinstance(content, bytes) else content.encode("latin-1"))


def packed(content):
    return gzip.compress(content, mtime=0)


def meta_images():
    head = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
    place = "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 1 2 3\nCenterOfRotation = 0 0 0\nAnatomicalOrientation = RAI\n"
    size = f"ElementSpacing = 1 1.5 2\nDimSize = {X} {Y} {Z}\n"
    plain = SAMPLES.tobytes()
    put("meta_image", "plain.mha", (head + place + size + "ElementType = MET_USHORT\nElementDataFile = LOCAL\n").encode() + plain)
    deflated = zlib.compress(plain)
    put("meta_image", "deflated.mha", (head + f"CompressedData = True\nCompressedDataSize = {len(deflated)}\n" + size +
                                       "ElementType = MET_USHORT\nElementDataFile = LOCAL\n").encode() + deflated)
    put("meta_image", "text.mha", head.replace("True", "False", 1) + size + "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n" +
        " ".join(str(v / 4) for v in SAMPLES.flat))
    put("meta_image", "channels.mhd", head + f"HeaderSize = 8\nElementNumberOfChannels = 3\nDimSize = {X} {Y} {Z}\n" +
        "ElementType = MET_SHORT\nElementDataFile = data.raw\n")
    put("meta_image", "list.mhd", head + size + "ElementType = MET_UCHAR\nElementDataFile = LIST 2\n" + "data.raw\n" * 3)
    put("meta_image", "pattern.mhd", head + "DimSize = 8 8 2\nElementByteOrderMSB = True\nElementType = MET_DOUBLE\n"
        "ElementDataFile = data%d.raw 1 2 1\n")
    put("meta_image", "four.mha", (head.replace("3", "4", 1) + "DimSize = 3 2 2 2\nElementType = MET_CHAR\nElementDataFile = LOCAL\n").encode()
        + bytes(range(24)))


def nrrds():
    place = "space: left-posterior-superior\nspace directions: (1,0,0) (0,1.5,0) (0,0,2)\nspace origin: (1,2,3)\n"
    head = f"NRRD0005\n# made\ntype: uint16\ndimension: 3\nsizes: {X} {Y} {Z}\nendian: little\n"
    plain = SAMPLES.tobytes()
    put("nrrd", "raw.nrrd", (head + place + "encoding: raw\nkey:=value\n\n").encode() + plain)
    put("nrrd", "gzip.nrrd", (head + "spacings: 1 2 3\nencoding: gzip\n\n").encode() + packed(plain))
    put("nrrd", "bzip2.nrrd", (head + "axis mins: 0 0 1\ncenters: cell node ???\nencoding: bzip2\n\n").encode() + bz2.compress(plain))
    put("nrrd", "hex.nrrd", head + "encoding: hex\n\n" + plain.hex("\n", 16))
    put("nrrd", "text.nrrd", head.replace("uint16", "float") + "thicknesses: nan nan 1\nencoding: text\n\n" +
        " ".join(str(v) for v in SAMPLES.flat))
    put("nrrd", "detached.nhdr", head + "encoding: raw\nbyte skip: 16\nline skip: 0\ndata file: data.raw\n")
    put("nrrd", "list.nhdr", head + "encoding: raw\nbyte skip: -1\ndata file: LIST 2\n" + "data.raw\n" * Z)
    put("nrrd", "vectors.nrrd", ("NRRD0004\ntype: int8\ndimension: 4\nsizes: 3 2 2 2\nkinds: vector domain domain domain\n"
        "space: RAS\nspace units: \"mm\" \"mm\" \"mm\"\nmeasurement frame: (1,0,0) (0,1,0) (0,0,1)\n"
        "space directions: none (1,0,0) (0,1,0) (0,0,1)\nlabels: \"v\" \"x\" \"y\" \"z\"\nencoding: raw\n\n").encode() + bytes(24))
    put("nrrd", "list_axis.nrrd", ("NRRD0004\ntype: double\nendian: big\ndimension: 4\nsizes: 2 2 2 3\nkinds: space space space list\n"
                                   "encoding: raw\n\n").encode() + numpy.arange(24, dtype=">f8").tobytes())


def niftis():
    affine = numpy.array([[0, -1.5, 0, 1], [1, 0, 0, 2], [0, 0, 2, 3], [0, 0, 0, 1]], float)
    image = nibabel.Nifti1Image(SAMPLES.T.astype("<i2"), affine)
    put("nifti", "one.nii", image.to_bytes())
    put("nifti", "one.nii.gz", packed(image.to_bytes()))
    image.header.extensions.append(nibabel.nifti1.Nifti1Extension(6, b"a comment"))
    image.header.set_slope_inter(0.5, -3)
    put("nifti", "extension.nii", image.to_bytes())
    series = nibabel.Nifti1Image(numpy.arange(3 * 2 * 2 * 3, dtype=">f4").reshape(3, 2, 2, 3), affine)
    put("nifti", "series.nii", nibabel.Nifti1Image(series.get_fdata(), affine, series.header.as_byteswapped()).to_bytes())
    put("nifti", "two.nii", nibabel.Nifti2Image(SAMPLES.T.astype("<f8"), affine).to_bytes())
    colours = numpy.zeros((3, 2, 2), [("R", "u1"), ("G", "u1"), ("B", "u1")])
    put("nifti", "colours.nii", nibabel.Nifti1Image(colours, affine).to_bytes())
    head = bytearray(348)  # Analyze: the pair in one
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 4, X, Y, Z, 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 4, 16)
    struct.pack_into("<8f", head, 76, 1, 1, 1.5, 2, 0, 0, 0, 0)
    put("nifti", "analyze.hdr", bytes(head) + SAMPLES.tobytes())
    struct.pack_into("<f", head, 108, 0)
    head[344:348] = b"ni1\0"
    put("nifti", "pair.hdr", bytes(head) + SAMPLES.tobytes())


def mrcs():
    for name, mode, kind, order in (("short.mrc", 1, "i2", "<"), ("float.mrc", 2, "f4", "<"), ("swapped.mrc", 6, "u2", ">"),
                                    ("half.mrc", 12, "f2", "<"), ("byte.mrc", 0, "i1", "<")):
        head = bytearray(1024)
        struct.pack_into(order + "4i3i3i3f3f3i3f2i", head, 0, X, Y, Z, mode, -1, 0, 2, X, Y, Z, 5, 6, 7, 90, 90, 90, 1, 2, 3,
                         0, 250, 100, 0, 80 if mode == 2 else 0)
        struct.pack_into(order + "3f", head, 196, 1, 2, 3)
        head[208:212] = b"MAP "
        head[212:216] = b"\x44\x44\0\0" if order == "<" else b"\x11\x11\0\0"
        extra = b"x, y, z".ljust(80) if mode == 2 else b""
        content = bytes(head) + extra + SAMPLES.astype(order + kind).tobytes()
        put("mrc", name, content)
        if mode == 2:
            put("mrc", name + ".gz", packed(content))


def cubes():
    head = "A cube\nof density\n    2    0.0    1.0    -2.0\n" + "".join(
        f"{n:5d}{a:12.6f}{b:12.6f}{c:12.6f}\n" for n, a, b, c in ((2, 0.3, 0, 0), (3, 0, 0.3, 0), (4, 0, 0, 0.3)))
    atoms = "    1    1.0    0.0 0.0 0.0\n    8    8.0    0.0 0.0 1.0\n"
    numbers = "\n".join(" ".join(f"{v / 7:12.5E}" for v in row) for row in numpy.arange(24).reshape(4, 6))
    put("cube", "density.cube", head + atoms + numbers + "\n")
    put("cube", "fortran.cube", (head + atoms + numbers.replace("E", "D")).replace("    2    3", "   -2    3"))
    orbitals = head.replace("\n    2 ", "\n   -2 ", 1) + atoms + "    2   5   6\n" + numbers + "\n" + numbers + "\n"
    put("cube", "orbitals.cube", orbitals)
    put("cube", "packed.cube.gz", packed((head + atoms + numbers).encode()))


def dicoms():
    def image(syntax, frames=1):
        meta = FileMetaDataset()
        meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.4"
        meta.MediaStorageSOPInstanceUID = "1.2.3.4"
        meta.ImplementationClassUID = "1.2.3"
        meta.TransferSyntaxUID = syntax
        data = Dataset()
        data.file_meta = meta
        data.SOPClassUID, data.SOPInstanceUID, data.SeriesInstanceUID = meta.MediaStorageSOPClassUID, "1.2.3.4", "1.2.3.5"
        data.Modality, data.SeriesDescription, data.SeriesNumber, data.InstanceNumber = "MR", "seed", 2, 1
        data.ImagePositionPatient, data.ImageOrientationPatient = [1, 2, 3], [1, 0, 0, 0, 1, 0]
        data.PixelSpacing, data.SliceThickness = [1.5, 1], 2
        data.Rows, data.Columns, data.SamplesPerPixel, data.PhotometricInterpretation = Y, X, 1, "MONOCHROME2"
        data.BitsAllocated, data.BitsStored, data.HighBit, data.PixelRepresentation = 16, 12, 11, 0
        data.RescaleSlope, data.RescaleIntercept = "0.5", "-10"
        if frames > 1:
            data.NumberOfFrames = frames
        return data

    def save(name, data, little=True, implicit=False):
        data.is_little_endian, data.is_implicit_VR = little, implicit
        out = io.BytesIO()
        pydicom.dcmwrite(out, data, write_like_original=False)
        put("dicom", name, out.getvalue())

    plain = image("1.2.840.10008.1.2.1")
    plain.PixelData = SAMPLES[0].tobytes()
    save("explicit.dcm", plain)
    implicit = image("1.2.840.10008.1.2", Z)
    implicit.PixelData = SAMPLES.tobytes()
    save("implicit.dcm", implicit, implicit=True)
    big = image("1.2.840.10008.1.2.2")
    big.PixelData = SAMPLES[0].astype(">u2").tobytes()
    save("big.dcm", big, little=False)
    deflated = image("1.2.840.10008.1.2.1.99")
    deflated.PixelData = SAMPLES[0].tobytes()
    save("deflated.dcm", deflated)
    enhanced = image("1.2.840.10008.1.2.1", Z)
    groups = []
    for z in range(Z):
        group, position, measures = Dataset(), Dataset(), Dataset()
        position.ImagePositionPatient = [0, 0, 2 * z]
        measures.PixelSpacing, measures.SliceThickness = [1, 1], 2
        group.PlanePositionSequence, group.PixelMeasuresSequence = [position], [measures]
        groups.append(group)
    enhanced.PerFrameFunctionalGroupsSequence = groups
    enhanced.PixelData = SAMPLES.tobytes()
    save("enhanced.dcm", enhanced)
    runs = image("1.2.840.10008.1.2.5", Z)
    runs.PixelData = encapsulate([rle_encode_frame(SAMPLES[z]) for z in range(Z)])
    runs["PixelData"].is_undefined_length = True
    save("runs.dcm", runs)
    colours = image("1.2.840.10008.1.2.1")
    colours.SamplesPerPixel, colours.PhotometricInterpretation, colours.PlanarConfiguration = 3, "RGB", 1
    colours.BitsAllocated, colours.BitsStored, colours.HighBit = 8, 8, 7
    colours.PixelData = bytes(range(3 * X * Y))
    save("colours.dcm", colours)


def tiffs():
    def save(name, samples, **options):
        out = io.BytesIO()
        tifffile.imwrite(out, samples, software="", datetime=None, **options)
        put("tiff", name, re.sub(rb"(?<=urn:uuid:)[-0-9a-f]{36}", b"0" * 36, out.getvalue()))

    save("plain.tif", SAMPLES, photometric="minisblack", metadata=None)
    save("big.tif", SAMPLES.astype(">f4"), bigtiff=True, byteorder=">", photometric="minisblack", metadata=None)
    save("imagej.tif", SAMPLES, imagej=True, metadata={"spacing": 2.0, "unit": "um", "axes": "ZYX"})
    save("deflated.tif", SAMPLES, compression="zlib", photometric="minisblack", rowsperstrip=2, metadata=None)
    save("tiles.tif", numpy.arange(40 * 20, dtype="u1").reshape(20, 40), tile=(16, 16), photometric="minisblack", metadata=None)
    save("colours.tif", numpy.arange(60, dtype="u1").reshape(4, 5, 3), photometric="rgb", metadata=None)
    save("ome.ome.tif", SAMPLES, photometric="minisblack", ome=True, metadata={"axes": "ZYX", "PhysicalSizeX": 0.5})
    save("bits.tif", SAMPLES[0] > 100, photometric="minisblack", metadata=None)


def vtk_files():
    def xml(kind, grid, point_data, more="", appended=""):
        return (f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt32">\n'
                f'<{kind} {grid}>\n<Piece {more}>\n{point_data}</Piece>\n</{kind}>\n{appended}</VTKFile>\n')

    extent = f"0 {X - 1} 0 {Y - 1} 0 {Z - 1}"
    words = " ".join(str(v) for v in SAMPLES.flat)
    text = f'<PointData Scalars="v">\n<DataArray type="UInt16" Name="v" format="ascii">\n{words}\n</DataArray>\n</PointData>\n'
    image = f'WholeExtent="{extent}" Origin="0 0 0" Spacing="1 1.5 2"'
    put("vtk_xml", "text.vti", xml("ImageData", image, text, f'Extent="{extent}"'))
    offsets = ('<PointData>\n<DataArray type="UInt16" Name="v" format="appended" offset="0"/>\n'
               '<DataArray type="Float32" Name="w" NumberOfComponents="3" format="ascii">0</DataArray>\n</PointData>\n<CellData/>\n')
    data = (struct.pack("<I", SAMPLES.nbytes) + SAMPLES.tobytes()).decode("latin-1")
    put("vtk_xml", "appended.vti", xml("ImageData", image, offsets, f'Extent="{extent}"',
                                       f'<AppendedData encoding="raw">\n_{data}\n</AppendedData>\n'))
    axes = "".join(f'<DataArray type="Float32" Name="{a}" format="ascii">{" ".join(map(str, range(n)))}</DataArray>\n'
                   for a, n in zip("xyz", (X, Y, Z)))
    put("vtk_xml", "axes.vtr", xml("RectilinearGrid", f'WholeExtent="{extent}"', text + f"<Coordinates>\n{axes}</Coordinates>\n",
                                   f'Extent="{extent}"'))
    places = " ".join(f"{x} {y} {z}" for z in range(Z) for y in range(Y) for x in range(X))
    points = f'<Points>\n<DataArray type="Float32" NumberOfComponents="3" format="ascii">{places}</DataArray>\n</Points>\n'
    put("vtk_xml", "points.vts", xml("StructuredGrid", f'WholeExtent="{extent}"', text + points, f'Extent="{extent}"'))
    cells = ('<Cells>\n<DataArray type="Int64" Name="connectivity" format="ascii">0 1 5 20</DataArray>\n'
             '<DataArray type="Int64" Name="offsets" format="ascii">4</DataArray>\n'
             '<DataArray type="UInt8" Name="types" format="ascii">10</DataArray>\n</Cells>\n')
    put("vtk_xml", "cells.vtu", xml("UnstructuredGrid", "", text + points + cells,
                                    f'NumberOfPoints="{X * Y * Z}" NumberOfCells="1"'))
    put("vtk_xml", "binary.vti", xml("ImageData", image, '<PointData Scalars="b"><DataArray type="UInt8" Name="b" format="binary" '
        'RangeMin="0" RangeMax="9">\nPAAAAA==' + "QUJD" * 20 + "\n</DataArray></PointData>", f'Extent="{extent}"'))

    head = "# vtk DataFile Version 3.0\nseed\n"
    size = f"DIMENSIONS {X} {Y} {Z}\n"
    data = f"POINT_DATA {X * Y * Z}\nSCALARS v unsigned_short 1\nLOOKUP_TABLE default\n"
    image = "DATASET STRUCTURED_POINTS\n" + size + "ORIGIN 0 0 0\nSPACING 1 1 2\n"
    put("vtk_legacy", "text.vtk", head + "ASCII\n" + image + data + words + "\nVECTORS w float\n" + "1 2 3\n" * (X * Y * Z))
    put("vtk_legacy", "binary.vtk", (head + "BINARY\n" + image + data).encode() + SAMPLES.astype(">u2").tobytes() +
        b"\nFIELD FieldData 2\na 1 60 unsigned_char\n" + bytes(60) + b"\nb 2 60 int\n" + bytes(480) + b"\n")
    axes = "".join(f"{a}_COORDINATES {n} float\n{' '.join(map(str, range(n)))}\n" for a, n in zip("XYZ", (X, Y, Z)))
    put("vtk_legacy", "axes.vtk", head + "ASCII\nDATASET RECTILINEAR_GRID\n" + size + axes + data + words + "\n")
    put("vtk_legacy", "points.vtk", head + "ASCII\nDATASET STRUCTURED_GRID\n" + size + f"POINTS {X * Y * Z} float\n{places}\n" + data + words +
        "\nCELL_DATA 24\nSCALARS c int\nLOOKUP_TABLE default\n" + "1 " * 24)
    put("vtk_legacy", "cells.vtk", head + f"ASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {X * Y * Z} double\n{places}\n"
        "CELLS 1 5\n4 0 1 5 20\nCELL_TYPES 1\n10\n" + data + words + "\nMETADATA\nINFORMATION 0\n\n")
    put("vtk_legacy", "offsets.vtk", head.replace("3.0", "5.1") + f"ASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {X * Y * Z} float\n{places}\n"
        "CELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 5 20\nCELL_TYPES 1\n10\n" + data + words + "\n")


def plot3d_files():
    places = numpy.arange(3 * X * Y * Z)
    values = numpy.arange(5 * X * Y * Z)
    size = (X, Y, Z)

    def record(content, order):
        mark = struct.pack(order + "I", len(content))
        return mark + content + mark

    grid = struct.pack("<3i", *size) + places.astype("<f4").tobytes()
    solution = struct.pack("<3i4f", *size, 0, 0, 0, 0) + values.astype("<f4").tobytes()
    put("plot3d", "grid.bin", grid)
    put("plot3d", "solution.bin", solution)
    put("plot3d", "pair.bin", grid + solution)
    put("plot3d", "marks.bin", record(struct.pack(">i", 1), ">") + record(struct.pack(">3i", *size), ">") +
        record(places.astype(">f8").tobytes() + bytes(4 * X * Y * Z), ">"))
    put("plot3d", "marks_q.bin", record(struct.pack("<3i", *size), "<") + record(bytes(16), "<") + record(values.astype("<f4").tobytes(), "<"))


def netcdfs():
    for name, kind in (("classic.nc", "NETCDF3_CLASSIC"), ("offset64.nc", "NETCDF3_64BIT_OFFSET"), ("data64.nc", "NETCDF3_64BIT_DATA")):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / name
            with netCDF4.Dataset(path, "w", format=kind) as file:
                file.title = "seed"
                for axis, extent in zip("tzyx", (None, Z, Y, X)):
                    file.createDimension(axis, extent)
                variable = file.createVariable("v", "f4", ("z", "y", "x"))
                variable.scale_factor, variable.units = numpy.float32(0.5), "K"
                variable[:] = SAMPLES
                file.createVariable("x", "f8", ("x",))[:] = numpy.arange(X)
                file.createVariable("s", "i2", ("t", "y"))[:2] = 7
                file.createVariable("b", "i1", ("t", "x"))[:2] = 1
            put("netcdf", name, path.read_bytes())


def raws():
    def layout(dims, kind, big=0, skip=0, spacing=(256, 256, 512), flags=0):
        return struct.pack("<3hBBH3hB", *dims, kind, big, skip, *spacing, flags)

    for kind, letter in enumerate(("u1", "i1", "u2", "i2", "i4", "f4", "f8")):
        put("raw", f"{letter}.bin", layout((X, Y, Z), kind) + SAMPLES.astype("<" + letter).tobytes())
    put("raw", "big.bin", layout((X, Y, Z), 2, 1, 7, flags=4) + bytes(7) + SAMPLES.astype(">u2").tobytes() + b"more")


def decoders():
    plain = SAMPLES.tobytes()
    put("decoders", "plain", b"\0\0" + plain)
    put("decoders", "gzip", b"\1\0" + packed(plain) + packed(plain))
    put("decoders", "zlib", b"\1\0" + zlib.compress(plain))
    put("decoders", "bzip2", b"\2\0" + bz2.compress(plain) + bz2.compress(plain))
    put("decoders", "hex", b"\3\0" + plain.hex("\n", 8).encode())
    for kind in range(11):
        put("decoders", f"text{kind}", bytes([4, kind]) + b"1, 2 -3\n4.5e1,nan 1D2 0.25 -inf 70000 1.0-300")
    put("decoders", "words", b"\5\0" + b"one 1.5D+02\r\n  -1-301 .5 +7 \n\n1e999 0x10")
    put("decoders", "deflate", b"\6\0" + zlib.compress(plain)[2:-4])


def meshes():
    points = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    faces = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
    rows = "".join("%g %g %g\n" % p for p in points)
    ply = ("ply\nformat {} 1.0\ncomment seed\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 4\nproperty list uchar int vertex_indices\nend_header\n")
    put("mesh", "text.ply", ply.format("ascii") + rows + "".join("3 %d %d %d\n" % f for f in faces))
    for order, name in (("<", "little"), (">", "big")):
        put("mesh", name + ".ply", ply.format(f"binary_{name}_endian").encode() + b"".join(struct.pack(order + "3f", *p) for p in points) +
            b"".join(struct.pack(order + "B3i", 3, *f) for f in faces))
    put("mesh", "more.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
        "property uchar red\nelement edge 1\nproperty int a\nproperty list uint8 float32 b\nelement face 1\n"
        "property list uint16 uint32 vertex_index\nend_header\n" + rows.replace("\n", " 7\n") + "1 2 0.5 0.5\n4 0 1 2 3\n")
    put("mesh", "normals.obj", "# seed\no a\n" + "".join("v %g %g %g\n" % p for p in points) + "vn 0 0 1\nvt 0 0\nusemtl m\ns off\n" +
        "f 1//1 3//1 2//1\nf 1 2 4\nf 2/1 3/1 4/1\nf -4/1/1 -1/1/1 -2/1/1\n")
    put("mesh", "plain.off", "OFF\n# seed\n4 4 6\n" + rows + "".join("3 %d %d %d\n" % f for f in faces))
    put("mesh", "colours.off", "COFF\n4 1 0\n" + rows.replace("\n", " 255 0 0 255\n") + "4 0 1 2 3 0.5 0.5 0.5\n")
    put("mesh", "text.stl", "solid seed\n" + "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % points[v] for v in f) +
        "endloop\nendfacet\n" for f in faces) + "endsolid seed\n")
    put("mesh", "binary.stl", b"seed".ljust(80) + struct.pack("<I", 4) +
        b"".join(struct.pack("<12fH", 0, 0, 0, *(c for v in f for c in points[v]), 0) for f in faces))


def messages():
    def text(value):
        return struct.pack("<I", len(value)) + value.encode()

    options = (b"\0" + text("field") + b"\1" + struct.pack("<i", 1) + b"\1" + struct.pack("<q", 2) + struct.pack("<3q", 0, 0, 0) + b"\0\1")
    put("messages", "open", b"\0" + text("/a/b.vti") + options + struct.pack("<2q", 0, 0))
    raw = b"\1" + struct.pack("<3qB3dQB", X, Y, Z, 2, 1, 1, 2, 7, 0)
    put("messages", "open_raw", b"\1" + text("/a/b.raw") + raw + options[1:] + struct.pack("<2q", 0, 0))
    put("messages", "slab", b"\3" + text("") + b"\0" + text("") + b"\0\0" + struct.pack("<3q", 0, 0, 0) + b"\0\0" + struct.pack("<2q", 1, 3))
    put("messages", "progress", b"\0" + struct.pack("<d", 0.5) + text("reading"))
    put("messages", "failed", b"\1\1" + text("is damaged") + text("/a/b.vti") + b"\1" + struct.pack("<Q", 17))
    place = struct.pack("<3q3d3d9d", X, Y, Z, 1, 1, 2, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
    put("messages", "info", b"\2" + place + b"\5" + text("VTK image") + text("v") + struct.pack("<I", 2) + text("a note") + text("b") +
        b"\1" + struct.pack("<2q3dq", 60, 50, 0.5, 0.25, 0.1, 10))
    field = (text("v") + text("") + struct.pack("<3q", X, Y, Z) + text("float32") + struct.pack("<iI", 2, 2) + text("x") + text("y") +
             b"\1" + struct.pack("<q", 3) + b"\0" + text(""))
    put("messages", "contents", b"\3" + text("VTK image") + struct.pack("<I", 2) + field + field + struct.pack("<Q", 1) + b"\1")
    put("messages", "samples", b"\4")


def without_histogram(index):
    """Most of a small index; targets set its checksums right by themselves."""
    meta = struct.unpack_from("<Q", index, 16)[0]
    bins = meta + 2 + 18 * 8 + 5 * 8
    bins += 4 + struct.unpack_from("<I", index, bins)[0] + 2 * 8
    count = struct.unpack_from("<I", index, bins)[0]
    return index[:bins] + struct.pack("<I", 1) + index[bins + 4:bins + 20] + index[bins + 4 + 16 * count:], bins + 20


def parts_of(index):
    """Of an index without histogram: its pages and chunks of samples."""
    index, at = without_histogram(index)
    meta = struct.unpack_from("<Q", index, 16)[0]
    kind, scalar, *dims = struct.unpack_from("<BB3q", index, meta)
    head = struct.pack("<5B", scalar, *dims, 0)
    levels = struct.unpack_from("<I", index, at)[0]
    at += 4
    parts = []
    for _ in range(levels):
        pages, blocks = struct.unpack_from("<2Q", index, at + 48)
        at += 64
        for page in range(pages):
            begin, _, size = struct.unpack_from("<2QI", index, at + 44 * page + 16)
            parts.append(("page", b"\0" + head + index[begin:begin + size]))
        at += 44 * pages + 32 * blocks
    at += 8
    if struct.unpack_from("<Q", index, at)[0] > 0:
        begin, size = struct.unpack_from("<2Q", index, at + 8)
        samples = struct.unpack_from("<H", index, begin + size)[0]
        parts.append(("chunk", b"\1" + head + index[begin:begin + samples]))
    return parts


def of_program(program):
    random = numpy.random.default_rng(1)
    volumes = {"u8": random.integers(0, 9, (3, 4, 10)).astype("u1"), "f32": random.normal(size=(4, 4, 4)).astype("f4"),
               "u16": (numpy.indices((4, 3, 17)).sum(axis=0) * 7).astype("u2"), "f64": random.normal(size=(3, 3, 3))}
    volumes["f32"][1, 2, 1] = numpy.nan
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for name, samples in volumes.items():
            (folder / "a.raw").write_bytes(samples.tobytes())
            for kind, options in (("edges", []), ("merged", ["--lod-error", "9c"]), ("metacells", [])):
                options += ["--index", "metacells" if kind == "metacells" else "edges"]
                subprocess.run([program, "build", folder / "a.raw", "-o", folder / "a.isx", "--raw-type", name,
                                "--raw-dims", ",".join(map(str, samples.shape[::-1])), *options], check=True, capture_output=True)
                index = (folder / "a.isx").read_bytes()
                put("index", f"{name}_{kind}", without_histogram(index)[0])
                for part, content in parts_of(index):
                    put("index_parts", f"{name}_{kind}_{part}", content)
        put("index", "whole", index)
        subprocess.run([program, "extract", folder / "a.isx", "--isovalue", "0.1", "-o", folder / "a.om"], check=True, capture_output=True)
        put("mesh", "own.om", (folder / "a.om").read_bytes())


for make in (meta_images, nrrds, niftis, mrcs, cubes, dicoms, tiffs, vtk_files, plot3d_files, netcdfs, raws, decoders, meshes, messages):
    make()
if len(sys.argv) > 2:
    of_program(sys.argv[2])
