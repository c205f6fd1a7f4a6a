//! The inputs of tests/cases/03, each with what is wanted of it, and their neighbours.
