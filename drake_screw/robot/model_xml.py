"""The XML of a model's file, read and written as Drake reads it: prefixes are part of names."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from xml.parsers import expat


def parse_model(text: str | bytes) -> ET.Element:
    """The root element; ``drake:capsule`` is named so, whether or not the prefix is declared.

    Comments are left out.

    Raises:
        xml.etree.ElementTree.ParseError: it is not XML.
    """
    builder = ET.TreeBuilder()
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise ET.ParseError(str(error)) from error
    return builder.close()


def model_xml(root: ET.Element) -> str:
    """The text of a root element."""
    return ET.tostring(root, encoding="unicode")
