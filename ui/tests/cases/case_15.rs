//! The inputs of tests/cases/15, each with what is wanted of it, and their neighbours.
