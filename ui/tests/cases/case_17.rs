//! The inputs of tests/cases/17, each with what is wanted of it, and their neighbours.
