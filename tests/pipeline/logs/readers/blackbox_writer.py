"""A writer of blackbox logs, after the documented format, for tests of the reader."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

START = b"H Product:Blackbox flight data recorder by Nicholas Sherlock\nH Data version:2\n"
END = b"E\xffEnd of log\x00"
SIGNED, UNSIGNED, NEGATIVE, TAG8_8SVB, TAG2_3S32, TAG8_4S16, NULL, TAG2_3SVARIABLE = 0, 1, 3, 6, 7, 8, 9, 10
_SIZES = {TAG8_8SVB: 8, TAG2_3S32: 3, TAG8_4S16: 4, TAG2_3SVARIABLE: 3}


@dataclass(frozen=True)
class Field:
    """A field of the main frames: its predictors and encodings in key frames and in the frames between."""

    name: str
    signed: bool = True
    key: tuple[int, int] = (0, SIGNED)
    between: tuple[int, int] = (1, SIGNED)


def unsigned(value: int) -> bytes:
    out, value = bytearray(), value & 0xFFFFFFFF
    while value > 127:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*out, value])


def signed(value: int) -> bytes:
    return unsigned((value << 1) ^ (value >> 31))


def eight(values: Sequence[int]) -> bytes:
    tags = sum(1 << place for place, value in enumerate(values) if value)
    return bytes([tags]) + b"".join(signed(value) for value in values if value)


def four(values: Sequence[int]) -> bytes:
    sizes = [next(n for n, bits in enumerate((0, 4, 8, 16)) if _fits(value, bits)) for value in values]
    bits = "".join(
        _bits(value, (0, 4, 8, 16)[size]) for value, size in zip(values, sizes, strict=True) if size
    )
    return bytes([sum(size << 2 * place for place, size in enumerate(sizes))]) + _packed(bits)


def three(values: Sequence[int], widths: Sequence[tuple[int, int, int]]) -> bytes:
    """Write three values behind a tag; `widths` are those of the short forms 0, 1 and 2."""
    for tag, sizes in enumerate(widths):
        if all(_fits(value, size) for value, size in zip(values, sizes, strict=True)):
            parts = [_bits(value, size) for value, size in zip(values, sizes, strict=True)]
            if sizes == (6, 6, 6):
                return _packed("10" + "00".join(parts))
            return _packed(f"{tag:02b}" + ("00" if sizes == (4, 4, 4) else "") + "".join(parts))
    lengths = [next(n for n in (1, 2, 3, 4) if _fits(value, 8 * n)) for value in values]
    head = 0xC0 | sum(n - 1 << 2 * place for place, n in enumerate(lengths))
    return bytes([head]) + b"".join(
        value.to_bytes(n, "little", signed=True) for value, n in zip(values, lengths, strict=True)
    )


EVEN = ((2, 2, 2), (4, 4, 4), (6, 6, 6))
UNEVEN = ((2, 2, 2), (5, 5, 4), (8, 7, 7))


def _fits(value: int, bits: int) -> bool:
    return value == 0 if bits == 0 else -(1 << bits - 1) <= value < 1 << bits - 1


def _word(value: int) -> int:
    """Return what is left of a number in 32 bits with a sign."""
    return (value + 2**31) % 2**32 - 2**31


def _bits(value: int, count: int) -> str:
    return format(value & ((1 << count) - 1), f"0{count}b")


def _packed(bits: str) -> bytes:
    bits += "0" * (-len(bits) % 8)
    return bytes(int(bits[place : place + 8], 2) for place in range(0, len(bits), 8))


def _group(encoding: int, group: Sequence[int], padded: Sequence[int]) -> bytes:
    """Encode fields that are written together; `padded` has as many as the encoding holds."""
    if encoding == TAG8_8SVB and len(group) > 1:
        return eight(group)
    if encoding in (TAG2_3S32, TAG2_3SVARIABLE):
        return three(padded, EVEN if encoding == TAG2_3S32 else UNEVEN)
    if encoding == TAG8_4S16:
        return four(padded)
    if encoding == NEGATIVE:
        return unsigned(-group[0] & 0x3FFF)
    if encoding == NULL:
        return b""
    return unsigned(group[0]) if encoding == UNSIGNED else signed(group[0])


def encoded(values: Sequence[int], encodings: Sequence[int]) -> bytes:
    """Encode what the predictors leave of the fields of a frame."""
    out, place = b"", 0
    while place < len(values):
        encoding, past = encodings[place], place + 1
        while past < len(values) and encodings[past] == encoding and past - place < _SIZES.get(encoding, 1):
            past += 1
        group = [int(value) for value in values[place:past]]
        padded = group + [0] * (_SIZES.get(encoding, 1) - len(group))
        out += _group(encoding, group, padded)
        place = past
    return out


def header(fields: Sequence[Field], facts: Mapping[str, object]) -> bytes:
    rows = {
        "I name": [field.name for field in fields],
        "I signed": [int(field.signed) for field in fields],
        "I predictor": [field.key[0] for field in fields],
        "I encoding": [field.key[1] for field in fields],
        "P predictor": [field.between[0] for field in fields],
        "P encoding": [field.between[1] for field in fields],
    }
    lines = [f"H Field {name}:{','.join(map(str, row))}" for name, row in rows.items()]
    lines += [f"H {name}:{value}" for name, value in facts.items()]
    return START + "\n".join(lines).encode() + b"\n"


def _predicted(
    predictor: int,
    place: int,
    row: np.ndarray,
    last: np.ndarray,
    before: np.ndarray,
    facts: Mapping[str, object],
    motor: int,
) -> int:
    """Return what a predictor says of a field of a row, by the two rows before, the header or the row itself."""
    fixed = {
        4: facts["minthrottle"],
        8: 1500,
        9: facts["vbatref"],
        11: str(facts["motorOutput"]).split(",")[0],
    }
    by_rows = {
        0: 0,
        1: last[place],
        2: 2 * last[place] - before[place],
        3: int((last[place] + before[place]) / 2),
        5: row[motor],
        6: row[place],
    }
    return int(fixed[predictor] if predictor in fixed else by_rows[predictor])


def frames(fields: Sequence[Field], rows: np.ndarray, facts: Mapping[str, object], every: int) -> list[bytes]:
    """Return the main frames of rows (samples, fields), of which each `every`th is a key frame."""
    motor = next((place for place, field in enumerate(fields) if field.name == "motor[0]"), 0)
    out, last, before = [], rows[0], rows[0]
    for number, row in enumerate(rows.astype(object)):
        key = number % every == 0
        choices = [field.key if key else field.between for field in fields]
        left = [
            _word(row[place] - _predicted(predictor, place, row, last, before, facts, motor))
            for place, (predictor, _) in enumerate(choices)
        ]
        out.append((b"I" if key else b"P") + encoded(left, [encoding for _, encoding in choices]))
        last, before = row, (row if key else last)
    return out
