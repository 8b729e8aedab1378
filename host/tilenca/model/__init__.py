"""The trained model without PyTorch: its file, its integers, what it costs a tile, its C++."""
