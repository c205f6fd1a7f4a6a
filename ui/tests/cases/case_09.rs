//! The inputs of tests/cases/09, each with what is wanted of it, and their neighbours.
