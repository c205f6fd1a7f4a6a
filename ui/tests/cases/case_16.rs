//! The inputs of tests/cases/16, each with what is wanted of it, and their neighbours.
