//! The inputs of tests/cases/13, each with what is wanted of it, and their neighbours.
