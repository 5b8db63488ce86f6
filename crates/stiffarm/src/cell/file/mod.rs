//! Reading and writing `cell.toml`.
