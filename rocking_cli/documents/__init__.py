"""Documents that people write: YAML or JSON, numbers with units, and the place of every fault."""
