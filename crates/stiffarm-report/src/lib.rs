//! Figures as data and their SVG renderer.
