//! stiffarm.
fn main() {}
