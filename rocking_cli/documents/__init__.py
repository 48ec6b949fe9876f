"""Documents that people write: YAML or JSON, numbers with units, and the place of every fault."""

from .composition import Place
from .document import Document, Value, parse_documents, read_documents

__all__ = ["Document", "Place", "Value", "parse_documents", "read_documents"]
