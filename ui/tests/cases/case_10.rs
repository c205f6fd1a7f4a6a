//! The inputs of tests/cases/10, each with what is wanted of it, and their neighbours.
