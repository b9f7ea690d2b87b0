"""Flash, RAM and stack of a firmware image, from its ELF file alone."""

import struct
from dataclasses import dataclass
from pathlib import Path

from echofuse.errors import InputError

_ELF_HEADER = struct.Struct("<16sHHIIIIIHHHHHH")  # 32 bits, little-endian
_SECTION_HEADER = struct.Struct("<IIIIIIIIII")
_PROGBITS_FREE = 8  # SHT_NOBITS: takes memory, but no place in the file
_WRITE, _ALLOC = 1, 2


@dataclass(frozen=True)
class ImageSize:
    """What an image takes of its machine [byte]."""

    flash_bytes: int  # code, constants, and the initial values of variables
    ram_bytes: int  # variables and the stack
    stack_bytes: int  # of which kept for the stack: the section .stack


def image_size(path: Path) -> ImageSize:
    """Add up the sections of a 32-bit little-endian ELF file.

    Raises InputError for anything else.
    """
    data = path.read_bytes()
    if len(data) < _ELF_HEADER.size or data[:6] != b"\x7fELF\x01\x01":
        raise InputError(f"{path}: expected a 32-bit little-endian ELF file")
    header = _ELF_HEADER.unpack_from(data)
    table, entry_bytes, n_sections, names_index = header[6], header[11], header[12], header[13]
    sections = [_SECTION_HEADER.unpack_from(data, table + i * entry_bytes) for i in range(n_sections)]
    names = sections[names_index][4]
    flash = ram = stack = 0
    for name, kind, flags, _, _, size, *_ in sections:
        if not flags & _ALLOC:
            continue
        if kind != _PROGBITS_FREE:
            flash += size
        if flags & _WRITE:
            ram += size
        begin = names + name
        if data[begin : data.index(b"\0", begin)] == b".stack":
            stack += size
    return ImageSize(flash, ram, stack)
