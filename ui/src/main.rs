//! The program `pickglass`.
fn main() {}
