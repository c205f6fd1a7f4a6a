//! The inputs of tests/cases/19, each with what is wanted of it, and their neighbours.
