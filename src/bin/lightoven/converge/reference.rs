//! What bakes are compared with: a file, or a longer bake.

use crate::noise::Reference;
use lightoven::io::exr;
use lightoven::{Error, ErrorKind, Result};
use serde::Serialize;
use std::path::Path;

/// Its light, before it is known which texels count.
pub(super) struct Light {
    /// Width and height in texels.
    pub(super) size: [u32; 2],
    /// `[texel]`, irradiance times whatever it was to be multiplied by, and coverage in A.
    pub(super) pixels: Vec<[f32; 4]>,
    pub(super) source: Source,
}

/// Where a reference is from. The names are stable: others are only added.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Source {
    /// `null` for one that was baked; the others are then those of its bake, and `null` for a file.
    pub(super) file: Option<String>,
    /// It was multiplied by this.
    pub(super) scale: f64,
    pub(super) sampling: Option<String>,
    pub(super) backend: Option<&'static str>,
    pub(super) seed: Option<u64>,
    /// Of baking.
    pub(super) seconds: Option<f64>,
    pub(super) samples_per_texel: Option<f64>,
    /// As that of a bake; `null` too where there are too few samples to tell.
    pub(super) estimated_error: Option<f32>,
    /// The square of it: what its own noise adds to each relMSE.
    pub(super) relmse: Option<f64>,
}

impl Light {
    /// Decoded as `lightoven compare` does. `size` is that of the light map of the scene of this path.
    pub(super) fn read(path: &Path, scale: f64, scene: &Path, size: [u32; 2]) -> Result<Self> {
        let (width, height, mut pixels) = exr::read_image(path)?;
        if [width, height] != size {
            let ([columns, rows], path, scene) = (size, path.display(), scene.display());
            return Err(Error::new(
                ErrorKind::InvalidScene,
                format!(
                    "'{path}' is {width} x {height} and the light map of '{scene}' {columns} x {rows}; allowed is one size"
                ),
            ));
        }
        for pixel in &mut pixels {
            pixel[..3].iter_mut().for_each(|c| *c = (f64::from(*c) * scale) as f32);
        }
        let source = Source {
            file: Some(path.to_string_lossy().into_owned()),
            scale,
            sampling: None,
            backend: None,
            seed: None,
            seconds: None,
            samples_per_texel: None,
            estimated_error: None,
            relmse: None,
        };
        Ok(Self { size, pixels, source })
    }

    /// Where it counts; `light_map` is one that is to be compared with it. `None` where no texel is covered in both and of
    /// more than 1 % of their mean luminance.
    pub(super) fn reference(&self, light_map: &[[f32; 4]]) -> Option<Reference> {
        let both = self.pixels.iter().zip(light_map).map(|([r, g, b, a], [.., other])| [*r, *g, *b, a.min(*other)]);
        Reference::new(&both.collect::<Vec<_>>())
    }
}

impl Source {
    /// For people.
    pub(super) fn text(&self) -> String {
        if let Some(file) = &self.file {
            let scale = if self.scale == 1.0 { String::new() } else { format!(", times {}", self.scale) };
            return format!("{file}{scale}; its own noise is not known");
        }
        let (seconds, samples) = (self.seconds.unwrap_or_default(), self.samples_per_texel.unwrap_or_default());
        let noise = match self.estimated_error.zip(self.relmse) {
            Some((error, adds)) => {
                format!("estimated error {:.2} %, which adds some {adds:.3e} to each relMSE", 100.0 * error)
            }
            None => "its error is not known: it has too few samples".into(),
        };
        format!("{seconds:.2} s of baking, {samples:.0} samples a texel, {noise}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightoven::baker::LightMap;
    use lightoven::io::exr::write_light_map;

    #[test]
    fn a_file_is_scaled_and_counts_where_both_are_covered() {
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("reference.exr");
        let pixels = vec![[1.0, 1.0, 1.0, 1.0], [2.0, 2.0, 2.0, 1.0], [4.0, 4.0, 4.0, 0.0]];
        write_light_map(&path, &LightMap { width: 3, height: 1, pixels }, &Default::default()).expect("is written");
        let light = Light::read(&path, 2.0, Path::new("scene.glb"), [3, 1]).expect("fits");
        let covered = [[0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]];
        let reference = light.reference(&covered).expect("one counts");
        assert_eq!(reference.texels(), 1);
        assert!((reference.counting()[0].1 - 4.0).abs() < 1e-6, "{:?}", reference.counting());
        assert!(light.reference(&[[0.0; 4]; 3]).is_none());
        let error = Light::read(&path, 1.0, Path::new("scene.glb"), [1, 3]).map(|_| ()).expect_err("must fail");
        for text in ["reference.exr' is 3 x 1", "'scene.glb' 1 x 3"] {
            assert!(error.to_string().contains(text), "{error}");
        }
    }
}
