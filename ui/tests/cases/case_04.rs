//! The inputs of tests/cases/04, each with what is wanted of it, and their neighbours.
