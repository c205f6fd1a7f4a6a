//! The inputs of tests/cases/18, each with what is wanted of it, and their neighbours.
