//! Tables: postures and displacements.
