//! The inputs of tests/cases/05, each with what is wanted of it, and their neighbours.
