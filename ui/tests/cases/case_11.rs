//! The inputs of tests/cases/11, each with what is wanted of it, and their neighbours.
