//! Units at the doors. Inside the library everything is SI: m, rad, N, N·m.

/// Metres per millimetre.
pub const MM: f64 = 1e-3;

/// Square metres per square millimetre.
pub const MM2: f64 = 1e-6;

/// Millimetres to metres.
pub fn mm_to_m(mm: f64) -> f64 {
    mm * MM
}

/// Metres to millimetres.
pub fn m_to_mm(m: f64) -> f64 {
    m / MM
}

/// Degrees to radians.
pub fn deg_to_rad(deg: f64) -> f64 {
    deg.to_radians()
}

/// Radians to degrees.
pub fn rad_to_deg(rad: f64) -> f64 {
    rad.to_degrees()
}
