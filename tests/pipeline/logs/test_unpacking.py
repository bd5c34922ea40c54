import bz2

import lz4.frame
import pytest
import zstandard

from simgap.logs.readers.unpacking import LARGEST, unpacked

CONTENT = b"some motion " * 100
PACKED = {
    "none": CONTENT,
    "bz2": bz2.compress(CONTENT),
    "lz4": lz4.frame.compress(CONTENT),
    "zstd": zstandard.compress(CONTENT),
}


@pytest.mark.parametrize("compression", PACKED)
def test_what_was_packed_comes_back(compression: str) -> None:
    assert unpacked(PACKED[compression], compression) == CONTENT
    assert unpacked(PACKED[compression], compression, len(CONTENT)) == CONTENT


@pytest.mark.parametrize("compression", PACKED)
@pytest.mark.parametrize("size", [len(CONTENT) - 1, len(CONTENT) + 1, LARGEST + 1])
def test_another_size_than_was_told_is_refused(compression: str, size: int) -> None:
    with pytest.raises(ValueError, match="too large"):
        unpacked(PACKED[compression], compression, size)


def test_another_compression_is_refused() -> None:
    with pytest.raises(ValueError, match="'rar' is not known"):
        unpacked(b"", "rar")
