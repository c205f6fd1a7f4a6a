//! The inputs of tests/cases/01, each with what is wanted of it, and their neighbours.
