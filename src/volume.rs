//! Dense and sparse voxel grids, windows, bounds.
