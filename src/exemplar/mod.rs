//! Exemplars: voxels plus their small weave pattern.
