//! The inputs of tests/cases/06, each with what is wanted of it, and their neighbours.
