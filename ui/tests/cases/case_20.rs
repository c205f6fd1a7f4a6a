//! The inputs of tests/cases/20, each with what is wanted of it, and their neighbours.
