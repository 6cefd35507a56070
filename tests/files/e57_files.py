"""E57 files as other programs write them, field by field, for tests; and damaged ones whose checksums are right."""

import numpy as np
from pye57 import libe57

PAGE, PAYLOAD = 1024, 1020
IDENTITY = (1.0, 0.0, 0.0, 0.0)
XYZ = ("cartesianX", "cartesianY", "cartesianZ")
RGB = ("colorRed", "colorGreen", "colorBlue")


def doubles(names, rows):
    """Columns of doubles."""
    return {name: ("double", column) for name, column in zip(names, np.asarray(rows, dtype=float).T, strict=True)}


def whole(names, rows, low, high):
    """Columns of whole numbers between two limits."""
    return {name: (("integer", low, high), column) for name, column in zip(names, np.asarray(rows).T, strict=True)}


def scaled(names, rows, scale):
    """Columns of whole numbers times a scale."""
    return {name: (("scaled", scale), column) for name, column in zip(names, np.asarray(rows).T, strict=True)}


def _structure(file, values):
    made = libe57.StructureNode(file)
    for name, value in values.items():
        made.set(name, libe57.FloatNode(file, float(value)))
    return made


def _node(file, kind, column):
    if kind == "double":
        return libe57.FloatNode(file, 0.0, libe57.E57_DOUBLE)
    if kind == "single":
        return libe57.FloatNode(file, 0.0, libe57.E57_SINGLE)
    if kind[0] == "integer":
        return libe57.IntegerNode(file, int(kind[1]), int(kind[1]), int(kind[2]))
    low, high = (int(np.rint(value / kind[1])) for value in (column.min(), column.max()))
    return libe57.ScaledIntegerNode(file, low, low, high, float(kind[1]), 0.0)


def station(fields, name="", rotation=None, translation=None, limits=None):
    """One entry of data3D; ``limits`` are those of its colours, the same for all three."""
    return {"fields": fields, "name": name, "rotation": rotation, "translation": translation, "limits": limits}


def e57_bytes(path, *stations):
    """The bytes of an E57 of stations; it is written at the path."""
    file = libe57.ImageFile(str(path), "w")
    file.extensionsAdd("", libe57.E57_V1_0_URI)
    root = file.root()
    for name, text in (("formatName", "ASTM E57 3D Imaging Data File"), ("guid", "{0}")):
        root.set(name, libe57.StringNode(file, text))
    root.set("versionMajor", libe57.IntegerNode(file, 1))
    root.set("versionMinor", libe57.IntegerNode(file, 0))
    data3d = libe57.VectorNode(file, True)
    root.set("data3D", data3d)
    for each in stations:
        node = libe57.StructureNode(file)
        node.set("guid", libe57.StringNode(file, "{1}"))
        if each["name"]:
            node.set("name", libe57.StringNode(file, each["name"]))
        if each["rotation"] is not None or each["translation"] is not None:
            pose = libe57.StructureNode(file)
            if each["rotation"] is not None:
                pose.set("rotation", _structure(file, dict(zip("wxyz", each["rotation"], strict=True))))
            if each["translation"] is not None:
                pose.set("translation", _structure(file, dict(zip("xyz", each["translation"], strict=True))))
            node.set("pose", pose)
        if each["limits"] is not None:
            ends = zip(("Minimum", "Maximum"), each["limits"], strict=True)
            node.set("colorLimits", _structure(file, {f"{n}{end}": value for end, value in ends for n in RGB}))
        prototype, buffers, columns = libe57.StructureNode(file), libe57.VectorSourceDestBuffer(), []
        for name, (kind, column) in each["fields"].items():
            prototype.set(name, _node(file, kind, np.asarray(column)))
            columns.append(np.ascontiguousarray(column, dtype=np.float64))
            buffers.append(libe57.SourceDestBuffer(file, name, columns[-1], len(column), True, True))
        points = libe57.CompressedVectorNode(file, prototype, libe57.VectorNode(file, True))
        node.set("points", points)
        data3d.append(node)
        if len(columns[0]):
            writer = points.writer(buffers)
            writer.write(len(columns[0]))
            writer.close()
    file.close()
    return path.read_bytes()


def _crc_table():
    table = np.arange(256, dtype=np.uint32)
    for _ in range(8):
        table = np.where(table & 1, (table >> np.uint32(1)) ^ np.uint32(0x82F63B78), table >> np.uint32(1))
    return table.astype(np.uint32)


_CRC = _crc_table()


def with_checksums(content):
    """The same bytes with the checksum of every page as E57 wants it, and the length of the file in the header."""
    pages = np.frombuffer(content + bytes(-len(content) % PAGE), dtype=np.uint8).reshape(-1, PAGE).copy()
    pages[0, 16:24] = np.frombuffer(pages.size.to_bytes(8, "little"), dtype=np.uint8)
    crc = np.full(len(pages), 0xFFFFFFFF, dtype=np.uint32)
    for k in range(PAYLOAD):
        crc = _CRC[(crc ^ pages[:, k]) & 0xFF] ^ (crc >> np.uint32(8))
    pages[:, PAYLOAD:] = (~crc).astype(">u4").view(np.uint8).reshape(-1, 4)
    return pages.tobytes()
