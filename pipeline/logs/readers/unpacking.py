"""Unpacking of compressed parts of a file, never to more than is sensible."""

LARGEST = 1 << 28  # bytes of one part; recorders write parts of 1 to 4 MB, with one image in them some more


def unpacked(data: bytes, compression: str, size: int | None = None) -> bytes:
    """Return what was compressed.

    Args:
        data: compressed.
        compression: none, bz2, lz4 or zstd.
        size: bytes that it must have; None where that is not known.

    Raises:
        ValueError: when it is damaged, too large or of another compression.
    """
    limit = LARGEST if size is None else size
    if limit > LARGEST:
        raise ValueError(f"a part of {limit} bytes is too large")
    result = data if compression == "none" else _unpacked(data, compression, limit)
    if len(result) > limit or (size is not None and len(result) != size):
        raise ValueError("a compressed part is damaged, or too large")
    return result


def _unpacked(data: bytes, compression: str, limit: int) -> bytes:
    """Return at most one byte more than the limit."""
    if compression == "bz2":
        import bz2

        return bz2.BZ2Decompressor().decompress(data, limit + 1)
    if compression == "lz4":
        from lz4.frame import LZ4FrameDecompressor

        return bytes(LZ4FrameDecompressor().decompress(data, limit + 1))
    if compression == "zstd":
        import io

        import zstandard

        return zstandard.ZstdDecompressor().stream_reader(io.BytesIO(data)).read(limit + 1)
    raise ValueError(f"compression {compression!r} is not known")
