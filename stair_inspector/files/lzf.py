"""The decompression of PCD's ``binary_compressed``: LZF, which neither Python nor numpy has."""

from stair_inspector.errors import ReadError

LARGEST_RATIO = 88
"""Three bytes of LZF give at most 264."""


def lzf_decompress(stream: bytes, size: int) -> bytearray:
    """Decompress an LZF stream of which the size is known.

    Parameters
    ----------
    stream : bytes
        The whole stream.
    size : int
        Bytes that it must give; checked before it is believed.

    Raises
    ------
    ReadError
        The stream is damaged: it ends early, refers to before its beginning, or gives another number of bytes.

    Notes
    -----
    A control byte below 32 announces that many literal bytes plus one. Otherwise its three high bits are a length
    (7: one more byte follows), its five low bits and the next byte a distance back. Half a second for a million
    points. Why not Open3D: it returns zeros for coordinates of type F 8, I 8 and U 8, and it reads from a path only.
    """
    if size > LARGEST_RATIO * len(stream):
        raise _damaged()
    given = bytearray()
    at, end = 0, len(stream)
    try:
        while at < end and len(given) <= size:
            control = stream[at]
            at += 1
            if control < 32:
                literal = stream[at : at + control + 1]
                if len(literal) != control + 1:
                    raise _damaged()
                given += literal
                at += control + 1
                continue
            length = (control >> 5) + 2
            if length == 9:
                length += stream[at]
                at += 1
            begin = len(given) - ((control & 31) << 8) - stream[at] - 1
            at += 1
            if begin < 0:
                raise _damaged()
            copied = given[begin : begin + length]
            # A copy may overlap what it writes: the bytes then repeat.
            given += (copied * (-(-length // len(copied))))[:length]
    except IndexError as error:
        raise _damaged() from error
    if len(given) != size:
        raise _damaged()
    return given


def _damaged() -> ReadError:
    return ReadError("its compressed data is damaged; copy or export the scan again")
