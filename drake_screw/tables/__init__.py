"""Tables as people have them: columns of numbers or words, whatever they are separated by."""

from drake_screw.tables.table import Table
from drake_screw.tables.text import read_table

__all__ = ["Table", "read_table"]
