//! The inputs of tests/cases/07, each with what is wanted of it, and their neighbours.
