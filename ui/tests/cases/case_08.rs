//! The inputs of tests/cases/08, each with what is wanted of it, and their neighbours.
