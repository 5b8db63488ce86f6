//! What a cell and a table state of a set-up, as one list of quantities: what each is, its key, its numbers, how well
//! it is known, and how the readings change with it. The test of the set-up frees them one by one, the systematic
//! errors take each within its standard uncertainty, and `free` identifies those that are named.

pub(crate) mod answer;
pub(crate) mod facts;
pub(crate) mod stated;
pub(crate) mod value;
