//! The inputs of tests/cases/12, each with what is wanted of it, and their neighbours.
