//! The implicit cloth volume.
