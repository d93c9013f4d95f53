"""The published tables behind the catalogue, a file per family; each exports its methods as ENTRIES."""
