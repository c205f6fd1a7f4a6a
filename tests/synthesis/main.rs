//! Which block each crossing copies, and how their edges meet.

mod assign;
mod edges;
