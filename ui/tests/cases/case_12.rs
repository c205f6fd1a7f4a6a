//! The input of tests/cases/12 is a window with slow frames: what is wanted of it, and its
//! neighbours, stand with the tests of the window, `ui/src/window/tests/slow_frames.rs`.
