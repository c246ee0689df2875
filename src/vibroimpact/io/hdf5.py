"""HDF5 files that a user gives: whether they are one, and damage that HDF5 itself does not see."""

import mmap
from pathlib import Path

from .whole_file import RecordError

SIGNATURE = b"\x89HDF\r\n\x1a\n"
PLACES = (0, 512, 1024, 2048)
# A global heap holds the texts of variable length: a head of 16 bytes with its size, and objects,
# each with a head of 16 bytes (number, count, size) and its content in steps of 8 bytes; number 0
# is free space, whose size includes the head. HDF5 File Format Specification 3.0, III.E.
HEAP, HEAD, STEP = b"GCOL\x01\x00\x00\x00", 16, 8


def is_hdf5(path: str | Path) -> bool:
    """Return whether a file begins as HDF5 does, after a user block or none."""
    with open(path, "rb") as file:
        head = file.read(PLACES[-1] + len(SIGNATURE))
    return any(head.startswith(SIGNATURE, place) for place in PLACES)


def inspect_hdf5(path: str | Path) -> None:
    """Raise RecordError if an HDF5 file refers to another file, which would be read instead, or
    if it is damaged in a way that HDF5 does not see: numbers of a type that numpy has not, or a
    list of texts without an end.
    """
    import h5py

    _refuse_endless_texts(path)

    def refuse(name, what):
        raise RecordError(
            f"{path}: '{name}' refers to {what}, another file: only files of the folder itself are"
            " read, store the numbers in this one"
        )

    def inspect_link(name, link):
        if isinstance(link, h5py.ExternalLink):
            refuse(name, f"'{link.filename}'")

    def inspect_item(name, item):
        if isinstance(item, h5py.Dataset) and item.external:
            refuse(name, f"'{item.external[0][0]}'")
        if isinstance(item, h5py.Dataset) and item.is_virtual:
            refuse(name, "virtual sources")
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu":
            if not item.id.get_type().equal(h5py.h5t.py_create(item.dtype)):
                raise RecordError(
                    f"{path}: '{name}' holds numbers of an unknown type: the file is damaged,"
                    " export it again"
                )

    with h5py.File(path, "r") as file:
        file.visititems_links(inspect_link)
        file.visititems(inspect_item)


def _refuse_endless_texts(path: str | Path) -> None:
    """Raise RecordError if an object of a global heap takes no space: HDF5 2.0.0 reads it again
    without end.
    """
    with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        heap = content.find(HEAP)
        while heap >= 0:
            end = heap + _number(content, heap + 8)
            place = heap + HEAD
            while place + HEAD <= min(end, len(content)):
                size = _number(content, place + 8)
                if content[place : place + 2] != b"\0\0":
                    size = HEAD + STEP * -(-size // STEP)
                if size % 2**64 == 0:
                    raise RecordError(
                        f"{path}: can not be read as HDF5 (a list of texts has no end, at byte"
                        f" {place}): the file is damaged, export it again"
                    )
                place += size
            heap = content.find(HEAP, heap + 1)


def _number(content: mmap.mmap, place: int) -> int:
    """Return the number of 8 bytes at a place."""
    return int.from_bytes(content[place : place + 8], "little")
