//! Built-in cells and posture groups.
