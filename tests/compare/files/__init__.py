"""Writers of small files, one module for each format: write(folder)."""
