"""Planners' workbooks: read with every doubt placed in its sheet and cell, and written as a
template to fill.
"""

from tandem.files.spreadsheet.draft import Draft, import_cell, read_workbook
from tandem.files.spreadsheet.findings import Note

__all__ = ["Draft", "Note", "import_cell", "read_workbook"]
