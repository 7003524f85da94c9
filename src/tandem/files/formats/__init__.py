"""Files that others publish, read as cells: one file a format, one line in `table.FORMATS`."""
