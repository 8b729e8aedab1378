"""Work on the cores of this machine or of many, by Dask distributed."""
