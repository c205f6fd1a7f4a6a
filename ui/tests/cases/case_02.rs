//! The inputs of tests/cases/02, each with what is wanted of it, and their neighbours.
