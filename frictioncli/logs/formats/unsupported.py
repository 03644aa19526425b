"""Files that are not read: known formats without a reader, and files that are not logs."""

import re
import zipfile
from pathlib import Path

from frictioncli.logs.formats.encoding import detect_encoding
from frictioncli.logs.log_source import CsvHints, Refusal

_NOT_READ = "format_not_read"
_NOT_A_LOG = "not_a_log"
# beginning of the file, reason, description
_MAGIC: tuple[tuple[bytes, str, str], ...] = (
    (b"TDSm", _NOT_READ, "TDMS measurement; export the log as CSV"),
    (b"\xd0\xcf\x11\xe0", _NOT_READ, "old Excel workbook; save the log as CSV"),
    (b"\x89PNG", _NOT_A_LOG, "PNG picture"),
    (b"\xff\xd8\xff", _NOT_A_LOG, "JPEG picture"),
    (b"%PDF", _NOT_A_LOG, "PDF document"),
    (b"<?xml", _NOT_A_LOG, "XML document"),
    (b"<", _NOT_A_LOG, "XML or HTML document"),
    (b"&ACCESS", _NOT_A_LOG, "KRL program"),
    (b"DEFDAT", _NOT_A_LOG, "KRL data list"),
)


_RECORDS = re.compile(rb'"(\w{1,60})"\s{0,4}:\s{0,4}\[\s{0,9}\{')
_ZIP = b"PK\x03\x04"


def _zip_content(path: Path) -> str:
    """Return what a zip archive is: a workbook, or an archive whose files can be unpacked."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    except (OSError, zipfile.BadZipFile):
        return "damaged zip archive"
    if "xl/workbook.xml" in names:
        return "Excel workbook; save the log as CSV"
    return f"zip archive of {', '.join(names[:3])}{', ...' * (len(names) > 3)}; unpack it"


def _json_content(start: bytes) -> str:
    """Return what a JSON document may hold, and how it becomes a table."""
    records = _RECORDS.search(start)
    if start.startswith(b"[{"):
        rows = "its list of records"
    elif records is not None:
        rows = f"its list {records[1].decode('utf-8', 'replace')!r}"
    else:
        rows = "its rows"
    return (
        f"JSON document; write {rows} as a CSV table with a header line and a column for each"
        " quantity"
    )


def refuse_unsupported(path: Path, head: bytes, hints: CsvHints) -> Refusal | None:
    """Return why a file cannot be read as a log, or None when it may be a text log."""
    if not head:
        return Refusal("empty_file", "empty file; expected a header line and rows of numbers")
    if head.startswith(_ZIP):
        return Refusal(_NOT_READ, _zip_content(path))
    start = head.removeprefix(b"\xef\xbb\xbf").lstrip(b" \t\r\n")
    if start.startswith((b"{", b"[{")):
        return Refusal(_NOT_A_LOG, _json_content(start))
    for magic, reason, what in _MAGIC:
        if start.startswith(magic):
            return Refusal(reason, what)
    if start.startswith(b"#BEGINHEADER") or b"#BEGINMOTIONINFO" in head:
        return Refusal(_NOT_A_LOG, "KUKA motion information (_PROG), no samples")
    if hints.encoding is None and detect_encoding(head) is None:
        if path.suffix.lower() == ".r64":
            return Refusal(
                _NOT_READ,
                f"samples of a DIAdem recording; its header {path.stem}.dat is missing or cannot"
                " be read: give both",
            )
        return Refusal(_NOT_A_LOG, "binary file, not text")
    return None
