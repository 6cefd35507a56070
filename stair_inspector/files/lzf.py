"""The decompression of PCD's ``binary_compressed``: LZF, which neither Python nor numpy has."""

from stair_inspector.errors import ReadError

LARGEST_RATIO = 88
"""Three bytes of LZF give at most 264."""


def lzf_decompress(stream: bytes, size: int) -> bytes:
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
        The stream is damaged: it ends early, refers to before its beginning, or gives another number of bytes. Or there
        is no decompressor.

    Notes
    -----
    Why not Open3D: it returns zeros for coordinates of type F 8, I 8 and U 8, and it reads from a path only.
    """
    if size > LARGEST_RATIO * len(stream):
        raise _damaged()
    try:
        import lzf
    except ImportError as error:
        raise ReadError(
            "is a compressed PCD, for which the package python-neo-lzf is missing; install it or export as binary PCD"
        ) from error
    try:
        given: bytes | None = lzf.decompress(stream, size)
    except ValueError as error:
        raise _damaged() from error
    # Nothing is given, and nothing raised, where there would be more bytes than the size.
    if given is None or len(given) != size:
        raise _damaged()
    return given


def _damaged() -> ReadError:
    return ReadError("its compressed data is damaged; copy or export the scan again")
