#!/usr/bin/python3
"""Readings of volumes with text and small binary headers, taken without this project's readers.

  headers.py FOLDER > tests/data/readings/headers.csv
  headers.py --places FOLDER > tests/data/readings/places/headers.csv

NIfTI is read with nibabel; MetaImage, NRRD, MRC and cube with numpy, zlib and Python's own float().
Columns: the file below FOLDER; the choice of field, component and frame; dims; the type that samples
have in memory; least and largest finite value, distinct finite values, values that are not finite;
XXH3-64 of all samples, little-endian, x fastest. Places: the rows of the matrix that takes an index to
the world, left-posterior-superior for medical files.
"""
import csv
import gzip
import pathlib
import re
import sys
import zlib

import nibabel
import numpy
import xxhash

TYPES = {"u1": "u8", "i1": "i8", "u2": "u16", "i2": "i16", "i4": "i32", "f4": "f32", "f8": "f64"}


def in_memory(samples):
    """Samples as the project keeps them: other integers are widened."""
    kind = samples.dtype.str[1:]
    samples = samples.astype("<" + kind if kind in TYPES else "<f8")
    return samples, TYPES.get(kind, "f64")


def row(file, samples, component="", frame=""):
    """`samples` has the axes x, y, z."""
    samples, name = in_memory(samples)
    while samples.ndim < 3:
        samples = samples[..., None]
    flat = samples.ravel(order="F")
    finite = flat[numpy.isfinite(flat)] if name[0] == "f" else flat
    least, most = finite.min(), finite.max()
    return [file, "", component, frame, *samples.shape, name,
            float(least) if name[0] == "f" else int(least),
            float(most) if name[0] == "f" else int(most),
            len(numpy.unique(finite)), flat.size - finite.size, xxhash.xxh3_64_hexdigest(flat.tobytes())]


def length(components):
    squares = 0.0
    for component in components:
        squares = squares + component.astype("f8") ** 2
    return numpy.sqrt(squares).astype("f4")


def nifti(path):
    image = nibabel.load(path)
    if (image.dataobj.slope, image.dataobj.inter) == (1.0, 0.0):
        return numpy.asanyarray(image.dataobj.get_unscaled())
    return image.get_fdata(dtype="f8").astype("f4")


META_TYPES = {"UCHAR": "u1", "CHAR": "i1", "USHORT": "u2", "SHORT": "i2", "UINT": "u4", "INT": "i4", "FLOAT": "f4",
              "DOUBLE": "f8"}


def meta_image(path):
    """Axes: channels, then x, y, z."""
    raw = path.read_bytes()
    end = re.search(rb"ElementDataFile\s*=[^\n]*\n?", raw).end()
    fields = dict(line.split("=", 1) for line in raw[:end].decode().splitlines() if "=" in line)
    fields = {key.strip(): value.strip() for key, value in fields.items()}
    name = fields["ElementDataFile"]
    data = raw[end:] if name == "LOCAL" else (path.parent / name).read_bytes()
    if fields.get("CompressedData", "False") == "True":
        data = zlib.decompress(data)
    isBig = "True" in (fields.get("BinaryDataByteOrderMSB"), fields.get("ElementByteOrderMSB"))
    kind = (">" if isBig else "<") + META_TYPES[fields["ElementType"][4:]]
    shape = [int(fields.get("ElementNumberOfChannels", 1))] + [int(n) for n in fields["DimSize"].split()]
    return numpy.frombuffer(data, kind, numpy.prod(shape)).reshape(shape, order="F")


NRRD_TYPES = {"uchar": "u1", "unsigned char": "u1", "short": "i2", "ushort": "u2", "unsigned short": "u2", "int": "i4",
              "float": "f4", "double": "f8"}


def nrrd(path):
    raw = path.read_bytes()
    header, _, data = raw.partition(b"\n\n")
    fields = dict(re.findall(r"^([^#:\n]+): *(.*?)\s*$", header.decode(), re.M))
    if "data file" in fields:
        name = fields["data file"].split()
        names = [name[0]] if len(name) == 1 else [name[0] % i for i in range(int(name[1]), int(name[2]) + 1, int(name[3]))]
        data = b"".join((path.parent / one).read_bytes() for one in names)
    if fields["encoding"] == "gzip":
        data = gzip.decompress(data)
    kind = (">" if fields.get("endian") == "big" else "<") + NRRD_TYPES[fields["type"]]
    shape = [int(n) for n in fields["sizes"].split()]
    return numpy.frombuffer(data, kind, numpy.prod(shape)).reshape(shape, order="F")


def mrc(path):
    """In the order of the file: columns, rows, sections."""
    raw = gzip.decompress(path.read_bytes())
    words = numpy.frombuffer(raw, "<i4", 24)
    kind = {0: "<i1", 1: "<i2", 2: "<f4", 6: "<u2"}[int(words[3])]
    return numpy.frombuffer(raw, kind, numpy.prod(words[:3]), 1024 + int(words[23])).reshape(words[:3], order="F")


def cube(path):
    lines = path.read_text().splitlines()
    atoms = abs(int(lines[2].split()[0]))
    shape = [abs(int(line.split()[0])) for line in lines[3:6]]
    numbers = [float(word) for line in lines[6 + atoms:] for word in line.split()]
    return numpy.array(numbers, "f8").reshape(shape)  # the third axis is the fastest


def readings(folder):
    for name in ["nifti/avg152T1_RL_nifti.nii.gz", "nifti/mricron_ch2.nii.gz", "nifti/mricron_inia19-t1-brain.nii.gz",
                 "awkward/niivue_minimal.nii.gz", "awkward/space_AIL.nii.gz", "awkward/space_LPI.nii.gz",
                 "awkward/space_PSR.nii.gz", "awkward/space_RAS.nii.gz", "awkward/space_SAL.nii.gz"]:
        yield row(name, nifti(folder / name))
    for name, frames in [("awkward/example_nifti2.nii.gz", [0, 1]), ("awkward/img4d_11f.nii.gz", range(11))]:
        series = nifti(folder / name)
        for frame in frames:
            yield row(name, series[..., frame], frame=frame)
    name = "awkward/tensor_rgb.nii.gz"
    vectors = [nifti(folder / name)[:, :, :, 0, i] for i in range(3)]
    for i, component in enumerate(vectors):
        yield row(name, component, component=i)
    yield row(name, length(vectors), component="magnitude")
    for name in ["mha/blob0.mha", "mha/blob4.mha", "mha/fuel.mha", "mha/hydrogenAtom.mha", "mha/marschnerlobb.mha",
                 "mha/neghip.mha", "mha/nucleon.mha", "mha/silicium.mha", "mhd/HeadMRVolume.mhd", "mhd/cranium.mhd",
                 "awkward/nan_seg.mha", "awkward/niivue_mha.mha"]:
        yield row(name, meta_image(folder / name)[0])
    name = "awkward/itkBrainSliceComplex.mha"
    channels = meta_image(folder / name)
    yield row(name, channels[0], component=0)
    yield row(name, channels[1], component=1)
    yield row(name, length(channels), component="magnitude")
    for name in ["nrrd/dcmqi_pm-example-float.nrrd", "nrrd/headsq/quarter.nhdr", "nrrd/pyradiomics_brain1_image.nrrd",
                 "nrrd/tooth/tooth.nhdr", "awkward/BrainProtonDensitySliceBorder20DirectionPlus30.nhdr"]:
        yield row(name, nrrd(folder / name))
    yield row("density/JMJD2DA-x336_event2.ccp4.gz", mrc(folder / "density/JMJD2DA-x336_event2.ccp4.gz"))
    yield row("density/m4_TotalDensity.cube", cube(folder / "density/m4_TotalDensity.cube"))


def mrc_place(path):
    words = numpy.frombuffer(gzip.decompress(path.read_bytes()), "<i4", 256)
    real = words.view("<f4")
    assert (real[13:16] == 90).all() and (real[49:52] == 0).all()
    matrix = numpy.zeros((3, 4))
    for column, axis in enumerate(words[16:19] - 1):
        step = float(real[10 + axis]) / int(words[7 + axis])
        matrix[axis, column] = step
        matrix[axis, 3] = step * int(words[4 + column])
    return matrix


def cube_place(path):
    rows = [[float(word) for word in line.split()[1:4]] for line in path.read_text().splitlines()[2:6]]
    return numpy.array(rows[1:] + rows[:1]).T


def nrrd_place(path):
    """Of files in left-posterior-superior, or in no space at all."""
    fields = dict(re.findall(r"^([^#:\n]+): *(.*?)\s*$", path.read_bytes().partition(b"\n\n")[0].decode(), re.M))
    assert fields.get("space") in (None, "left-posterior-superior", "3D-left-handed")
    numbers = [[float(n) for n in vector.split(",")]
               for key in ("space directions", "space origin") for vector in re.findall(r"\(([^)]*)\)", fields.get(key, ""))]
    if not numbers:
        numbers = numpy.vstack([numpy.diag([float(n) for n in fields["spacings"].split()]), numpy.zeros(3)])
    return numpy.array(numbers).T


def places(folder):
    flip = numpy.diag([-1.0, -1.0, 1.0])
    for name in ["nifti/avg152T1_RL_nifti.nii.gz", "nifti/mricron_ch2.nii.gz", "nifti/mricron_inia19-t1-brain.nii.gz",
                 "awkward/space_AIL.nii.gz", "awkward/space_LPI.nii.gz", "awkward/space_PSR.nii.gz",
                 "awkward/space_RAS.nii.gz", "awkward/space_SAL.nii.gz", "awkward/example_nifti2.nii.gz",
                 "awkward/img4d_11f.nii.gz", "awkward/tensor_rgb.nii.gz"]:
        yield name, flip @ nibabel.load(folder / name).affine[:3]
    yield "density/JMJD2DA-x336_event2.ccp4.gz", mrc_place(folder / "density/JMJD2DA-x336_event2.ccp4.gz")
    yield "density/m4_TotalDensity.cube", cube_place(folder / "density/m4_TotalDensity.cube")
    for name in ["nrrd/dcmqi_pm-example-float.nrrd", "nrrd/headsq/quarter.nhdr", "nrrd/pyradiomics_brain1_image.nrrd",
                 "nrrd/tooth/tooth.nhdr"]:
        yield name, nrrd_place(folder / name)


if __name__ == "__main__":
    out = csv.writer(sys.stdout, lineterminator="\n")
    if sys.argv[1] == "--places":
        out.writerow(["file"] + [row + column for row in "xyz" for column in "ijk1"])
        for name, matrix in places(pathlib.Path(sys.argv[2])):
            out.writerow([name, *map(float, matrix.ravel())])
        sys.exit()
    out.writerow("file field component frame nx ny nz type min max distinct missing xxh3".split())
    for line in readings(pathlib.Path(sys.argv[1])):
        out.writerow(line)
