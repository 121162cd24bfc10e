//! The scene as the command line asks for it.

use crate::arguments::{SceneArguments, SkyArgument};
use crate::paths::Named;
use lightoven::baker::Baker;
use lightoven::io::{exr, gltf};
use lightoven::scene::{Atlas, Scene, Sky};
use lightoven::{Error, ErrorKind, Features, Result};
use std::path::{Path, PathBuf};

/// Reads a glTF file and gives it the sky that was asked for.
pub(crate) fn scene(path: &Path, arguments: &SceneArguments) -> Result<Scene> {
    let mut scene = gltf::read(path, &gltf::ReadSettings { sidedness: arguments.sidedness() })?;
    match &arguments.sky {
        None => {}
        Some(SkyArgument::Constant(radiance)) => scene.set_sky(Sky::Constant(*radiance))?,
        Some(SkyArgument::File(path)) => {
            let sky = Sky::Map(exr::read_sky(path)?);
            scene.set_sky(sky).map_err(|error| {
                Error::new(error.kind(), format!("cannot use '{}' as the sky", path.display())).with_source(error)
            })?;
        }
    }
    Ok(scene)
}

/// The files that a scene is read from, for the check of paths.
pub(crate) fn files<'a>(path: &'a PathBuf, arguments: &'a SceneArguments) -> [Named<'a>; 2] {
    let sky = match &arguments.sky {
        Some(SkyArgument::File(path)) => Some(path),
        _ => None,
    };
    [("the scene", Some(path)), ("--sky", sky)]
}

/// What is wrong with a light map's layout.
pub(crate) fn layout_warning(atlas: &Atlas) -> Option<String> {
    let count = atlas.overlapping_texels;
    let text =
        "texels of the light map are covered more than once: charts overlap, and such a texel has the light of one";
    (count > 0).then(|| format!("{count} {text}"))
}

/// For who measures noise.
///
/// # Errors
/// `InvalidScene` where no ray can find light.
pub(crate) fn check_has_noise(baker: &Baker, scene: &Scene) -> Result<()> {
    if baker.features().contains(Features::GATHERING) {
        return Ok(());
    }
    let context = format!("'{}' has no light that rays could find: there is no noise to measure", scene.name());
    Err(Error::new(ErrorKind::InvalidScene, context))
}
