"""The text of a file whose encoding is not stated."""

from pathlib import Path

from .signals import ImportProblem

TWO_BYTES = (b"\xff\xfe", b"\xfe\xff")  # marks of UTF 16
READ_AS_WINDOWS = "is not UTF-8: read as Windows-1252 (Latin-1)"


def read_encoded(path: str | Path) -> tuple[str, str]:
    """Return (text, note) of a file in UTF-8, in UTF 16 with its mark, or else in Windows-1252.

    Instruments write µ and ² in the code page of their system. In those of Windows and in Latin-1
    both are the same bytes, which are not UTF-8; a wrong guess gives a unit or a name that is not
    known, which is refused. The note says that Windows-1252 was read. Raises ImportProblem for a
    binary file.
    """
    raw = Path(path).read_bytes()
    wide = raw.startswith(TWO_BYTES)
    encodings = ("utf_16",) if wide else ("utf-8-sig", "cp1252")
    if not wide and b"\0" in raw:
        raise ImportProblem(f"{path}: is a binary file: export it as text, in UTF-8")
    for encoding in encodings:
        try:
            return raw.decode(encoding), READ_AS_WINDOWS if encoding == "cp1252" else ""
        except UnicodeDecodeError as error:
            line = raw[: error.start].count(b"\n") + 1
    raise ImportProblem(
        f"{path}: line {line}: a character that is neither UTF-8 nor Windows-1252: save the file as"
        " UTF-8"
    )
