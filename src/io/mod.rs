//! Files: scenes in, light maps out.

pub mod exr;
pub mod gltf;
mod output;
pub mod preview;

pub use output::{check_writable, write_beside};

/// Luminance of a pixel's red, green and blue, by the weights of Rec. 709.
pub fn luminance([r, g, b, _]: [f32; 4]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}
