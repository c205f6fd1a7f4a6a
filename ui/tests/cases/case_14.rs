//! The inputs of tests/cases/14, each with what is wanted of it, and their neighbours.
