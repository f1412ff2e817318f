#!/usr/bin/env python3
"""A second reader of the index format, written from core/index/format/FORMAT.md alone, in Python's standard library and
the zstd program. It shares nothing with the one in C++: where both agree, the document says what the bytes are.

    read_index.py INDEX facts            what meta states, as JSON
    read_index.py INDEX edges            each edge of level 0: x y z axis lower upper (of an index of edges)
    read_index.py INDEX bricks           each brick of level 0: x y z least greatest (of metacells)
    read_index.py INDEX records LEVEL    all of a level's pages, a line for each record: form, id and key, then of each
                                         entry its edge number and key; numbers only. Where directions stand for
                                         keys, 1 for an end with a greater key, else 0. In version 4 keys are followed
                                         by normals
    read_index.py INDEX samples          the bytes of all samples, in hexadecimal digits, a line for each row
    read_index.py INDEX planes           bytes of each level's planes by column, as JSON
    read_index.py INDEX active VALUE...  active edges at isovalues, from edges or from samples, as JSON

Checksums are not compared: XXH3 is not in the standard library. `isoslider-cli validate` does that.
"""

import json
import struct
import subprocess
import sys

MAGIC = b"ISOSLIDE\r\n\x1a\n"
TYPES = ["u8", "i8", "u16", "i16", "i32", "f32", "f64"]
SAMPLE = {"u8": "B", "i8": "b", "u16": "H", "i16": "h", "i32": "i", "f32": "f", "f64": "d"}
LOWEST = {"u8": 0, "i8": -(2**7), "u16": 0, "i16": -(2**15), "i32": -(2**31)}
KEY_BYTES = {"u8": 2, "i8": 2, "u16": 2, "i16": 2, "i32": 4, "f32": 4, "f64": 8}


def fail(message):
    sys.exit("read_index.py: " + message)


def unpack_frames(frames, sizes):
    """zstd frames one after the other; each unpacks to its size."""
    if not frames:
        return []
    done = subprocess.run(["zstd", "-dc"], input=b"".join(frames), stdout=subprocess.PIPE, check=True).stdout
    if len(done) != sum(sizes):
        fail("compressed planes have another length")
    parts, at = [], 0
    for size in sizes:
        parts.append(done[at : at + size])
        at += size
    return parts


class Fields:
    """Little-endian fields, one after the other."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def get(self, kind):
        value = struct.unpack_from("<" + kind, self.data, self.at)
        self.at += struct.calcsize("<" + kind)
        return value[0] if len(value) == 1 else list(value)

    def bytes(self, count):
        if self.at + count > len(self.data):
            fail("meta is cut off")
        self.at += count
        return self.data[self.at - count : self.at]

    def text(self):
        return self.bytes(self.get("I")).decode("utf-8", "replace")


class Index:
    def __init__(self, path):
        with open(path, "rb") as file:
            self.data = file.read()
        if self.data[:12] != MAGIC:
            fail("not an index")
        self.major, self.minor, meta_at, meta_bytes, _, self.file_bytes, _, _ = struct.unpack_from("<HHQQQQQQ", self.data, 12)
        if self.major not in (4, 5, 6, 7):
            fail("version %d" % self.major)
        self.read_meta(Fields(self.data[meta_at : meta_at + meta_bytes]))

    def read_meta(self, meta):
        self.kind = ["edges", "metacells"][meta.get("B")]
        if self.kind == "edges" and self.major < 6:
            fail("edges of version %d" % self.major)
        self.type = TYPES[meta.get("B")]
        self.dims = meta.get("3q")
        self.spacing, self.origin, self.direction = meta.get("3d"), meta.get("3d"), meta.get("9d")
        self.min, self.max = meta.get("2d")
        self.distinct, self.missing_samples = meta.get("2Q")
        self.redundancy, self.name = meta.get("d"), meta.text()
        meta.get("2d")
        bins = [meta.get("2Q") for _ in range(meta.get("I"))]
        self.histogram, self.curve = [b[0] for b in bins], [b[1] for b in bins]
        self.levels = []
        for _ in range(meta.get("I")):
            level = dict(zip(("blocks", "points", "edges", "activated", "bytes", "redundant"), meta.get("6Q")))
            pages, blocks = meta.get("2Q")
            level["page_entries"] = [meta.get("4Q") + meta.get("3I") for _ in range(pages)]
            level["block_entries"] = [meta.get("4Q") for _ in range(blocks)]
            self.levels.append(level)
        if self.major < 6 and meta.get("Q") != 0:
            fail("metacells with pages of hidden corners")
        self.chunk_bytes = meta.get("Q")
        self.groups = [meta.get("3Q") for _ in range(meta.get("Q"))]
        count, packed = meta.get("2Q")
        plain = unpack_frames([meta.bytes(packed)], [68 * count])[0] if count else meta.bytes(packed) and b""
        self.missing = {}
        for i in range(count):
            brick, *cells = struct.unpack_from("<I8Q", plain, 68 * i)
            self.missing[brick] = cells
        self.error_in_cells, self.error = meta.get("B"), meta.get("d")
        self.unit = meta.text() if self.minor >= 1 else ""
        self.resampling = meta.text() if self.minor >= 2 else ""
        self.is_patient_space = self.minor >= 3 and meta.get("B") == 1
        if meta.at != len(meta.data) and self.minor <= 3:
            fail("bytes behind meta")
        self.bricks = [(n + 7) // 8 for n in self.dims]

    def scalar(self, key):
        if self.type in LOWEST:
            return key + LOWEST[self.type]
        size = 4 if self.type == "f32" else 8
        sign = 1 << (8 * size - 1)
        bits = key & ~sign if key & sign else ~key & (2 * sign - 1)
        return struct.unpack("<" + SAMPLE[self.type], bits.to_bytes(size, "little"))[0]

    def coords(self, point):
        brick, local = divmod(point, 512)
        bx, by = self.bricks[0], self.bricks[1]
        at = (brick % bx, brick // bx % by, brick // (bx * by))
        return tuple(8 * b + (local >> 3 * a & 7) for a, b in enumerate(at))

    def planes(self, data, at, counts):
        """Byte planes behind their table, unpacked: one for each of `counts`, to the end of the data."""
        table = struct.unpack_from("<%dI" % len(counts), data, at)
        at, frames, parts = at + 4 * len(counts), [], []
        for word, count in zip(table, counts):
            length, mode = word & (1 << 30) - 1, word >> 30
            part = data[at : at + length]
            at += length
            if mode == 0:
                parts.append(part * count)
            elif mode == 1:
                parts.append(part)
            else:
                parts.append(None)
                frames.append((part, count))
        if at != len(data):
            fail("bytes after the last plane")
        unpacked = iter(unpack_frames([f for f, _ in frames], [n for _, n in frames]))
        return iter([next(unpacked) if part is None else part for part in parts])

    def page(self, entry):
        """Records of a page: (key, id, form, {edge: far key, or direction}, normal, {edge: far normal}), normals only of
        earlier versions."""
        data = self.data[entry[2] : entry[2] + entry[4]]
        points, edges, base, key_bytes, id_bytes, order, flags, planes = struct.unpack_from("<IIQBBBBI", data, 0)
        id_count = 512 * self.bricks[0] * self.bricks[1] * self.bricks[2]
        turned = 0 if flags & 8 else 2
        if self.major >= 5 and turned:
            fail("a page of version %d with normals" % self.major)
        has_forms, has_directions = flags >> 2 & 1, flags >> 4 & 1
        if has_directions != (self.kind == "edges" and self.major >= 7):
            fail("directions or keys of far ends in another version")
        far_width = 0 if has_directions and not has_forms else key_bytes
        if key_bytes + id_bytes + 1 + has_forms + has_directions + turned + far_width + turned != planes:
            fail("number of planes")
        # How many far keys there are follows from masks and forms where directions stand for those of points.
        near = key_bytes + id_bytes + 1 + has_forms
        far_count = self.far_count(data, planes, near, points, has_forms) if has_directions else edges
        counts = [points] * (near + has_directions + turned) + [far_count] * far_width + [edges] * turned
        parts = self.planes(data, 32, counts)

        def column(width, count):
            cut = [next(parts) for _ in range(width)]
            return [int.from_bytes(bytes(p[i] for p in cut), "little") for i in range(count)]

        keys, ids, masks = column(key_bytes, points), column(id_bytes, points), column(1, points)
        forms = column(1, points) if has_forms else [0] * points
        rising = column(1, points) if has_directions else [0] * points

        def plus(a, b):
            return (a + b & 0xFF) | ((a >> 8) + (b >> 8) & 0xFF) << 8

        turns = column(turned, points)
        far, bends = iter(column(far_width, far_count)), iter(column(turned, edges))
        modulus, records, key, point, normal = 1 << 8 * key_bytes, [], base, 0, 0
        for i in range(points):
            key = ((key if order == 0 else base) + keys[i]) % modulus
            point = (point + ids[i]) % id_count
            normal = plus(normal, turns[i]) if turned else None
            numbers = [e for e in range(6) if masks[i] >> e & 1]
            if has_directions and forms[i] == 0:
                if rising[i] & ~masks[i]:
                    fail("directions of edges that are not there")
                records.append((key, point, 0, {e: rising[i] >> e & 1 for e in numbers}, None, {}))
                continue
            differences = {e: (lambda z: z >> 1 if z % 2 == 0 else -(z >> 1) - 1)(next(far)) for e in numbers}
            ends = {e: (key + d) % modulus for e, d in differences.items()}
            bent = {e: next(bends) for e in numbers} if turned else {}
            normals = {e: plus(normal, d) for e, d in bent.items()}
            for e in (0, 2, 4):
                if e in ends and e + 1 in ends:
                    if flags & 1:
                        ends[e] = (2 * key - ends[e + 1] + differences[e]) % modulus
                    if turned and flags & 2:
                        opposite = (-(normals[e + 1] & 0xFF) & 0xFF) | (-(normals[e + 1] >> 8) & 0xFF) << 8
                        normals[e] = plus(plus(plus(normal, normal), opposite), bent[e])
            records.append((key, point, forms[i], ends, normal, normals))
        return records

    def far_count(self, data, planes, near, points, has_forms):
        """Far keys of a page with directions: those of records of other forms."""
        if not has_forms:
            return 0
        table = struct.unpack_from("<%dI" % planes, data, 32)
        at = 32 + 4 * planes
        spans = []
        for word in table[:near]:
            spans.append((at, word))
            at += word & (1 << 30) - 1

        def plane(at, word):
            length, mode = word & (1 << 30) - 1, word >> 30
            part = data[at : at + length]
            return part * points if mode == 0 else part if mode == 1 else unpack_frames([part], [points])[0]

        masks, forms = plane(*spans[near - 2]), plane(*spans[near - 1])
        return sum(bin(mask).count("1") for mask, form in zip(masks, forms) if form != 0)

    def plane_bytes(self):
        """Encoded bytes of each level: by column, low byte first, and of heads and tables."""
        levels = []
        for level in self.levels:
            sums = {"heads": 0}
            for entry in level["page_entries"]:
                key_bytes, id_bytes, _, flags, planes = struct.unpack_from("<BBBBI", self.data, entry[2] + 16)
                names = ["keys"] * key_bytes + ["ids"] * id_bytes + ["masks"] + ["forms"] * (flags >> 2 & 1)
                names += ["directions"] * (flags >> 4 & 1) + ["normals"] * (0 if flags & 8 else 2)
                names += ["far keys"] * (0 if flags & 20 == 16 else key_bytes) + ["far normals"] * (0 if flags & 8 else 2)
                table = struct.unpack_from("<%dI" % planes, self.data, entry[2] + 32)
                for name, word in zip(names, table):
                    sums[name] = sums.get(name, 0) + (word & (1 << 30) - 1)
                sums["heads"] += 32 + 4 * planes
            levels.append(sums)
        return levels

    def records(self, level=0):
        for entry in self.levels[level]["page_entries"]:
            yield from self.page(entry)

    def edges(self):
        """(x, y, z, axis, lower end's scalar, upper end's scalar), once for each edge."""
        values = self.samples() if self.major >= 7 else None
        steps = [1, self.dims[0], self.dims[0] * self.dims[1]]
        for key, point, form, ends, _, _ in self.records():
            if form != 0:
                fail("has merged cells: its edges are intervals")
            at = self.coords(point)
            here = sum(a * b for a, b in zip(at, steps))
            for edge, far in ends.items():
                if edge % 2 == 0:
                    continue
                lower, upper = self.scalar(key), values[here + steps[edge // 2]] if values else self.scalar(far)
                if values and (lower != values[here] or (upper > lower) != bool(far)):
                    fail("an edge of other samples")
                yield (*at, edge // 2, lower, upper)

    def brick_list(self):
        for key, point, _, ends, _, _ in self.records():
            far = next(iter(ends.values()))
            if key < far:
                yield (*(c // 8 for c in self.coords(point)), self.scalar(key), self.scalar(far))

    def samples(self):
        """What the chunks hold, x fastest."""
        letter = SAMPLE[self.type]
        nx, ny, nz = self.dims
        sides = [(n + 15) // 16 for n in self.dims]
        values = [0] * (nx * ny * nz)
        count = sides[0] * sides[1] * sides[2]
        for group, (offset, size, _) in enumerate(self.groups):
            at, table = offset, offset + size
            for i in range(min(256, count - 256 * group)):
                length = struct.unpack_from("<H", self.data, table + 10 * i)[0]
                chunk = 256 * group + i
                place = (chunk % sides[0], chunk // sides[0] % sides[1], chunk // (sides[0] * sides[1]))
                extent = [min(16, n - 16 * p) for n, p in zip(self.dims, place)]
                cube = self.chunk(self.data[at : at + length], extent, letter)
                at += length
                for z in range(extent[2]):
                    for y in range(extent[1]):
                        to = 16 * place[0] + nx * (16 * place[1] + y + ny * (16 * place[2] + z))
                        start = extent[0] * (y + extent[1] * z)
                        values[to : to + extent[0]] = cube[start : start + extent[0]]
        return values

    def chunk(self, data, extent, letter):
        head = struct.unpack_from("<H", data)[0]
        mode, stated = head & 15, [(head >> 4 * (a + 1) & 15) + 1 for a in range(3)]
        if stated != extent:
            fail("chunk of another extent")
        width, count = struct.calcsize("<" + letter), extent[0] * extent[1] * extent[2]
        if mode == 0:
            return list(struct.unpack_from("<%d%s" % (count, letter), data, 2))
        if mode == 1:
            return [struct.unpack_from("<" + letter, data, 2)[0]] * count
        table = struct.unpack_from("<%dH" % width, data, 2)
        at, planes = 2 + 2 * width, []
        for word in table:
            length, how = word & (1 << 14) - 1, word >> 14
            part = data[at : at + length]
            at += length
            planes.append(part * count if how == 0 else part if how == 1 else unpack_frames([part], [count])[0])
        bits = self.undo([int.from_bytes(bytes(p[i] for p in planes), "little") for i in range(count)], mode, extent, width)
        return list(struct.unpack("<%d%s" % (count, letter), b"".join(b.to_bytes(width, "little") for b in bits)))

    @staticmethod
    def undo(coded, mode, extent, width):
        if mode == 2:
            return coded
        (nx, ny, _), modulus, out = extent, 1 << 8 * width, []
        for i, value in enumerate(coded):
            x, y, z = i % nx, i // nx % ny, i // (nx * ny)
            difference = value >> 1 if value % 2 == 0 else -(value >> 1) - 1
            if mode == 3:
                guess = out[i - 1] if x else out[i - nx] if y else out[i - nx * ny] if z else 0
            else:

                def step(dx, dy, dz):
                    return out[i - dx - nx * (dy + ny * dz)] if x >= dx and y >= dy and z >= dz else 0

                guess = step(1, 0, 0) + step(0, 1, 0) + step(0, 0, 1) - step(1, 1, 0) - step(1, 0, 1) - step(0, 1, 1) + step(1, 1, 1)
            out.append((guess + difference) % modulus)
        return out

    def usable_edges_of_samples(self):
        """(scalar, scalar) of each pair of neighbours; all cells must have eight finite corners."""
        if self.missing_samples:
            fail("samples are missing: which edges are usable is not worked out here")
        if min(self.dims) < 2:
            return
        values, (nx, ny, nz) = self.samples(), self.dims
        for i, value in enumerate(values):
            if i % nx + 1 < nx:
                yield value, values[i + 1]
            if i // nx % ny + 1 < ny:
                yield value, values[i + nx]
            if i // (nx * ny) + 1 < nz:
                yield value, values[i + nx * ny]

    def active(self, isovalues):
        edges = [e[4:] for e in self.edges()] if self.kind == "edges" else list(self.usable_edges_of_samples())
        return [sum((a >= v) != (b >= v) for a, b in edges) for v in isovalues]

    def facts(self):
        levels = []
        for number, level in enumerate(self.levels):
            records = list(self.records(number))
            entries = sum(len(record[3]) for record in records)
            levels.append({"points": len(records), "edges": entries, "stated_edges": level["edges"]})
        return {
            "kind": self.kind,
            "dims": self.dims,
            "scalar_type": self.type,
            "min": self.min,
            "max": self.max,
            "distinct_values": self.distinct,
            "index_bytes": self.file_bytes,
            "finite": sum(self.histogram),
            "levels": levels,
        }


def main(words):
    if len(words) < 2 or words[1] not in ("facts", "edges", "bricks", "records", "samples", "planes", "active"):
        fail("usage: read_index.py INDEX facts|edges|bricks|records|samples|planes|active [LEVEL|VALUE...]")
    index = Index(words[0])
    if words[1] == "facts":
        print(json.dumps(index.facts()))
    elif words[1] == "planes":
        print(json.dumps(index.plane_bytes()))
    elif words[1] == "active":
        print(json.dumps(index.active([float(w) for w in words[2:]])))
    elif words[1] == "records":
        for key, point, form, ends, normal, normals in index.records(int(words[2])):
            entries = ((e, ends[e]) if normal is None else (e, ends[e], normals[e]) for e in sorted(ends))
            print(form, point, key, *([] if normal is None else [normal]), *(n for entry in entries for n in entry))
    elif words[1] == "samples":
        letter, nx, values = SAMPLE[index.type], index.dims[0], index.samples()
        for row in range(0, len(values), nx):
            print(struct.pack("<%d%s" % (nx, letter), *values[row : row + nx]).hex())
    else:
        for line in {"edges": index.edges, "bricks": index.brick_list}[words[1]]():
            print(*line)


main(sys.argv[1:])
