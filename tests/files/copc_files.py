"""COPC files, as laspy's reader of them takes them: laspy itself writes none."""

import io
import struct

import laspy
import lazrs
import numpy as np

SCALE = 0.0001


def octree_of(points, *, side, levels, seed=0):
    """The rows of points (n, 3) by cell, (level, i, j, k): a few of the first level, the rest in those below it."""
    rng = np.random.default_rng(seed)
    low = points.min(axis=0)
    shares = 4.0 ** np.arange(levels)
    level = rng.choice(levels, len(points), p=shares / shares.sum())
    places = np.floor((points - low) / (side / 2.0**level)[:, None]).astype(int)
    rows = {}
    for row, key in enumerate(zip(level.tolist(), *places.T.tolist(), strict=True)):
        rows.setdefault(key, []).append(row)
    return {key: np.array(rows[key]) for key in sorted(rows)}


def copc_file(points, *, side=8.0, levels=3, spacing=0.2, paged=True):
    """The bytes of a COPC of points (n, 3), coordinates on 0.1 mm, and the rows of each of its cells.

    With ``paged`` a cell of the second level and those in it stand on a page of their own.
    """
    low = points.min(axis=0)
    cells = octree_of(points, side=side, levels=levels)
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales, header.offsets = [SCALE] * 3, [0.0] * 3
    whole = laspy.LasData(header)
    whole.x, whole.y, whole.z = points.T
    whole.red = np.arange(len(points)) % 60_000
    whole.update_header()
    packer = lazrs.LazVlr.new_for_compression(7, 0, True)
    middle = low + side / 2.0
    header.vlrs.extend(
        [
            laspy.VLR("copc", 1, "", bytes(160)),
            laspy.VLR("laszip encoded", 22204, "", packer.record_data()),
        ]
    )
    header.are_points_compressed = True
    stream = io.BytesIO()
    header.write_to(stream)
    compressor = lazrs.LasZipCompressor(stream, packer)
    entries = {}
    # The first eight bytes are where the table of chunks will be: behind the last of them.
    start = begin = stream.tell() + 8
    for number, (key, rows) in enumerate(cells.items(), 1):
        compressor.compress_many(np.frombuffer(whole.points.array[rows].tobytes(), dtype=np.uint8))
        if number < len(cells):
            compressor.finish_current_chunk()
            end = stream.tell()
        else:
            compressor.done()
            end = int.from_bytes(stream.getvalue()[start - 8 : start], "little")
        entries[key] = (begin, end - begin, len(rows))
        begin = end
    packed = {key: struct.pack("<4iQ2i", *key, *entry) for key, entry in entries.items()}
    own = [key for key in packed if paged and (key == (1, 0, 0, 0) or (key[0] == 2 and max(key[1:]) < 2))]
    first, deep = [packed[key] for key in packed if key not in own], [packed[key] for key in own]
    stream.seek(0, io.SEEK_END)
    at = stream.tell() + 60
    n_first = len(first) + bool(deep)
    if deep:
        first.append(struct.pack("<4iQ2i", 1, 0, 0, 0, at + 32 * n_first, 32 * len(deep), -1))
    pages = b"".join([*first, *deep])
    stream.write(struct.pack("<H16sHQ32s", 0, b"copc", 1000, len(pages), b"") + pages)
    content = bytearray(stream.getvalue())
    content[429 : 429 + 56] = struct.pack("<5d2Q", *middle, side / 2.0, spacing, at, 32 * n_first)
    content[235:247] = struct.pack("<QI", at - 60, 1)
    return bytes(content), cells
